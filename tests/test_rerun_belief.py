"""The drawn belief: labels that can be read, and ellipsoids that cover two standard deviations."""

import math

import numpy as np
import pytest

from skolem.traces.messages import Belief, Denotation, HsvBelief, ObjectBelief, ObjectType, RobotState
from skolem.traces.rerun_belief import SIGMAS, label, label_heights, likely_type, spread

CAN = ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.12), graspable=True)
TABLE = ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False)
TYPES = {"can": CAN, "bottle": CAN, "table": TABLE}


def known(x: float = 1.0, **changes: object) -> ObjectBelief:
    before = ObjectBelief(
        exists=0.99,
        type={"bottle": 0.13, "can": 0.87},
        world_T_object=(x, 0.0, 0.68, 0.5),
        covariance=(4e-4, 1e-4, 0.0, 1e-4, 0.0, 0.01),
        colour=HsvBelief(mean=(0.33, 0.9, 0.8), variance=(0.001, 0.01, 0.01)),
        log_weight=(-1.2, 0.36),
    )
    return before.model_copy(update=changes)


def belief(**objects: ObjectBelief) -> Belief:
    return Belief(
        step=0,
        version=0,
        world_T_base=(0.0, 0.0, 0.0),
        base_covariance=(0.0,) * 6,
        robot=RobotState(right_arm=(0.0,) * 7, left_arm=(0.0,) * 7),
        anchors=tuple(objects),
        objects=objects,
        keys=(),
        joint_covariance=(),
    )


def test_a_label_says_type_colour_and_whether_it_is_what_is_meant() -> None:
    meant = Denotation(step=0, probability={"e1": {"o2": 0.4142}})
    assert label("o2", known(colour_seen=True), CAN, meant) == "o2: can .87, green, Den .41"


def test_a_label_does_not_tell_a_colour_nobody_has_seen_or_a_value_nobody_recorded() -> None:
    assert label("o2", known(), CAN, None) == "o2: can .87"


def test_furniture_is_labelled_with_its_name_alone() -> None:
    assert label("desk", known(type={"table": 1.0}), TABLE, None) == "desk"


def test_of_equally_likely_types_the_first_by_name_is_drawn() -> None:
    assert likely_type(known(type={"can": 0.5, "bottle": 0.5})) == "bottle"


def test_labels_of_neighbours_stand_at_different_heights() -> None:
    heights = label_heights(belief(o1=known(1.0), o2=known(1.1), o3=known(3.0)), TYPES)
    assert heights["o2"] - heights["o1"] > 0.05
    assert heights["o3"] == pytest.approx(heights["o1"])


def test_the_ellipsoid_has_the_axes_of_the_covariance_turned_with_the_object() -> None:
    one = known()
    drawn = spread(one.world_T_object, one.covariance, 0.0, (255, 255, 255, 255))
    a, b, _, c, _, _ = one.covariance
    variances, axes = np.linalg.eigh(np.array([[a, b], [b, c]]))
    (half_sizes,) = drawn.half_sizes.as_arrow_array().to_pylist()  # type: ignore[union-attr]
    (quaternion,) = drawn.quaternions.as_arrow_array().to_pylist()  # type: ignore[union-attr]
    assert half_sizes[:2] == pytest.approx(SIGMAS * np.sqrt(variances[::-1]), rel=1e-5)
    longest = one.world_T_object[3] + math.atan2(axes[1, 1], axes[0, 1])
    turn = 2.0 * math.atan2(quaternion[2], quaternion[3])
    assert math.sin(turn - longest) == pytest.approx(0.0, abs=1e-6)
