"""E1: the PR2: a base, two arms and a head."""

from collections.abc import Iterator

import pytest

from skolem.sim.robot import bodies
from skolem.sim.robot.pr2 import ARM, BASE, HEAD, PR2, TORSO
from skolem.traces.messages import HANDS

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def robot() -> Iterator[PR2]:
    client = bodies.connect()
    yield PR2(client)
    bodies.disconnect(client)


def test_the_model_has_twenty_degrees_of_freedom_by_name(robot: PR2) -> None:
    """ "The robot has a base, two arms and head, with total of 20 DOF." """
    names = {*BASE, TORSO, *HEAD, *ARM["right"], *ARM["left"]}
    assert len(names) == 20
    assert [len(names) for names in (BASE, HEAD, ARM["right"], ARM["left"])] == [3, 2, 7, 7]
    assert {robot.joint[name] for name in names} <= set(robot.movable)


def test_each_of_them_moves_what_it_is_of(robot: PR2) -> None:
    """ "A base, two arms and head": every joint moves the frame at the end of its chain, and no other chain's."""
    ends = {"base": BASE, "right": ARM["right"], "left": ARM["left"], "head": HEAD}
    frames = {"right": "r_gripper_tool_frame", "left": "l_gripper_tool_frame", "head": "head_mount_kinect_ir_link"}
    for part, names in ends.items():
        for name in names:
            before = {end: robot.link_pose(frame) for end, frame in frames.items()}
            (old,) = robot.joints([name])
            robot.set_joints({name: old + 0.1})
            moved = {end for end, frame in frames.items() if robot.link_pose(frame) != before[end]}
            robot.set_joints({name: old})
            assert moved == (set(frames) if part == "base" else {part}), name


def test_both_hands_are_among_the_arms() -> None:
    """ "Two arms"."""
    assert set(ARM) == set(HANDS) == {"right", "left"}
