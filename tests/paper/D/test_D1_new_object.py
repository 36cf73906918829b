"""D1: a detection whose pose is sufficiently different from all known objects adds a new one."""

import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, green, seen_as

from skolem.traces.messages import Pose4

FAR: Pose4 = (1.1, 0.3, 0.7, 0.0)  # 32 cm from the can that is known
BESIDE: Pose4 = (1.005, 0.005, 0.7, 0.0)  # within what its pose is known to


def test_a_green_can_far_from_all_anchors_gets_a_fresh_one_with_the_weight_prior() -> None:
    """ "The pose of this new object is sufficiently different from objects it already knows about"."""
    robot = Handler(at_five_percent([can()]))
    before = robot.belief.snapshot(0)
    for _ in range(2):
        robot.see(seen_as(STANDS), seen_as(FAR))
    assert robot.belief.anchors() == (*before.anchors, "_o1_")
    new = robot.belief.snapshot(0).objects["_o1_"]
    assert new.world_T_object[:2] == pytest.approx(FAR[:2], abs=0.005)
    assert (new.log_weight, new.weighed) == (before.objects["can1"].log_weight, False)
    assert robot.belief.prob_property("_o1_", green()) > 0.9


def test_a_can_where_one_is_known_is_that_one() -> None:
    """ "... that the state estimator adds a new object": only if it is sufficiently different."""
    robot = Handler(at_five_percent([can()]))
    for _ in range(2):
        robot.see(seen_as(BESIDE))
    assert robot.belief.anchors() == ("table1", "can1")
