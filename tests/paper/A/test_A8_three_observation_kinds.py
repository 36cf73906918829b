"""A8: detections tell type and pose, pixels the colour, the wrist the weight."""

import numpy as np
import pytest
from kit.papers import Handler, at_five_percent, can, seen_as

from skolem.traces.messages import ObjectBelief, TypeIs

SENSED = ("type", "world_T_object", "covariance", "colour", "log_weight")


def believed(robot: Handler) -> ObjectBelief:
    """Return what is believed of the can."""
    return robot.belief.snapshot(0).objects["can1"]


def test_a_detection_tells_type_and_pose_and_its_pixels_the_colour() -> None:
    """ "Object detections from a 3D sensor for type and pose, RGB pixel values for color." """
    robot = Handler(at_five_percent([can()]))
    before = believed(robot)
    robot.see(seen_as((1.02, -0.01, 0.7, 0.0), rgb=(0.08, 0.64, 0.08)))
    after = believed(robot)
    assert after.world_T_object[:2] == pytest.approx((1.02, -0.01), abs=0.005)
    assert after.covariance[0] < before.covariance[0]
    assert robot.belief.prob_property("can1", TypeIs(type="soda")) > 0.98
    assert after.colour.mean[0] == pytest.approx(1.0 / 3.0, abs=0.01)
    assert (after.log_weight, after.weighed) == (before.log_weight, False)


def test_the_wrist_tells_the_weight_and_nothing_else() -> None:
    """ "Force-torque measurements from the wrist for weight." """
    robot = Handler(at_five_percent([can()]))
    robot.pick("can1")
    before = believed(robot)
    robot.weigh(0.25)
    after = believed(robot)
    changed = {name for name in SENSED if getattr(before, name) != getattr(after, name)}
    assert changed == {"log_weight"}
    assert np.exp(after.log_weight[0]) == pytest.approx(0.25, abs=0.01)


def test_a_drive_shows_nothing_of_what_objects_are_like() -> None:
    """ "A belief-update step based on observations": without one, type, colour and weight stay as they are."""
    robot = Handler(at_five_percent([can()], odometry_sd_m=0.1))
    before = believed(robot)
    robot.drive((0.2, 0.1, 0.3))
    after = believed(robot)
    assert [getattr(after, name) for name in ("type", "colour", "log_weight")] == [
        getattr(before, name) for name in ("type", "colour", "log_weight")
    ]
