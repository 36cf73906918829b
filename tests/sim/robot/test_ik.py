from collections.abc import Iterator

import numpy as np
import pytest

from skolem.sim.robot import bodies, ik
from skolem.sim.robot.bullet import p
from skolem.sim.robot.pr2 import ARM, PR2, TORSO
from skolem.sim.robot.rotations import rotation
from skolem.traces.messages import HANDS, Hand

TORSO_M = 0.15
NEAR_SINGULAR = 5e-3  # rad: how far a solution beside a straight elbow or wrist may be from the one sought


@pytest.fixture(scope="module")
def robot() -> Iterator[PR2]:
    client = bodies.connect(gravity=False)
    robot = PR2(client)
    robot.set_joints({TORSO: TORSO_M})
    yield robot
    bodies.disconnect(client)


def tool(robot: PR2, hand: Hand, joints: ik.Floats) -> tuple[ik.Floats, ik.Floats]:
    robot.set_arm(hand, joints)
    position, turn = robot.tool_pose(hand)
    return np.array(position), np.reshape(p.getMatrixFromQuaternion(turn), (3, 3))


@pytest.mark.physics
@pytest.mark.parametrize("hand", HANDS)
def test_limits_are_those_of_the_model(robot: PR2, hand: Hand) -> None:
    assert ik.limits(hand) == pytest.approx(np.array([robot.limits[name] for name in ARM[hand]]), abs=1e-9)


@pytest.mark.physics
@pytest.mark.parametrize("hand", HANDS)
def test_every_configuration_is_found_again_from_its_tool_pose(robot: PR2, hand: Hand) -> None:
    rng, limits = np.random.default_rng(0), ik.limits(hand)
    for _ in range(60):
        joints = rng.uniform(limits[:, 0], limits[:, 1])
        position, turn = tool(robot, hand, joints)
        found = ik.nearest_turn(ik.all_solutions(hand, TORSO_M, position, turn, joints[:1]), joints[None])
        assert np.abs(found - joints).max(axis=1).min() < NEAR_SINGULAR


@pytest.mark.physics
@pytest.mark.parametrize("hand", HANDS)
def test_every_solution_puts_the_tool_there(robot: PR2, hand: Hand) -> None:
    rng, limits, checked = np.random.default_rng(1), ik.limits(hand), 0
    for _ in range(30):
        position, turn = tool(robot, hand, rng.uniform(limits[:, 0], limits[:, 1]))
        for joints in ik.all_solutions(hand, TORSO_M, position, turn, ik.pan_grid(hand, 16)):
            there, as_turned = tool(robot, hand, joints)
            assert there == pytest.approx(position, abs=1e-6)
            assert as_turned == pytest.approx(turn, abs=1e-6)
            checked += 1
    assert checked > 60


def test_solutions_stay_within_the_limits() -> None:
    limits = ik.limits("right")
    found = ik.all_solutions("right", 0.2, np.array([0.65, -0.2, 0.75]), rotation(0.3), ik.pan_grid("right", 64))
    assert len(found) > 10
    assert (found >= limits[:, 0]).all()
    assert (found <= limits[:, 1]).all()


def test_what_is_out_of_reach_has_no_solution() -> None:
    assert len(ik.all_solutions("left", 0.2, np.array([2.0, 0.0, 0.7]), rotation(0.0), ik.pan_grid("left", 64))) == 0


def test_the_left_arm_is_the_mirror_image_of_the_right() -> None:
    mirror = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    pan = np.array([-0.3])
    right = ik.all_solutions("right", 0.2, np.array([0.65, -0.2, 0.75]), rotation(0.3), pan)
    left = ik.all_solutions("left", 0.2, np.array([0.65, 0.2, 0.75]), rotation(-0.3), -pan)
    assert len(right) > 0
    assert np.sort(left, axis=0) == pytest.approx(np.sort(right * mirror, axis=0), abs=1e-9)


def test_many_questions_at_once_have_the_answers_of_each_alone() -> None:
    positions = np.array([[0.6, -0.3, 0.75], [0.7, -0.1, 0.8], [3.0, 0.0, 0.0]])
    turns = np.stack([rotation(0.1)] * 3)
    together = ik.solve("right", 0.2, positions, turns, np.full(3, -0.4))
    for row in range(3):
        alone = ik.all_solutions("right", 0.2, positions[row], turns[row], np.array([-0.4]))
        assert np.array_equal(together.joints[together.row == row], alone)


def test_a_straight_line_is_followed_without_a_jump() -> None:
    start = ik.all_solutions("right", 0.2, np.array([0.55, -0.3, 0.8]), rotation(0.2), np.array([-0.5]))[0]
    line = np.array([0.55, -0.3, 0.8]) + np.linspace(0.02, 0.1, 5)[:, None] * np.array([1.0, 0.0, 0.0])
    path = ik.follow("right", 0.2, start, line, rotation(0.2))
    assert path is not None
    assert np.abs(np.diff(np.vstack([[start], path]), axis=0)).max() <= ik.STEP_LIMIT_RAD


def test_a_line_that_leaves_the_reach_is_not_followed() -> None:
    start = ik.all_solutions("right", 0.2, np.array([0.55, -0.3, 0.8]), rotation(0.0), np.array([-0.5]))[0]
    line = np.array([0.55, -0.3, 0.8]) + np.linspace(0.02, 0.8, 40)[:, None] * np.array([1.0, 0.0, 0.0])
    assert ik.follow("right", 0.2, start, line, rotation(0.0)) is None


def test_nearest_turn_moves_continuous_joints_alone() -> None:
    joints, reference = np.full((1, 7), 3.0), np.full((1, 7), -3.0)
    turned = ik.nearest_turn(joints, reference)[0]
    assert turned[[4, 6]] == pytest.approx(3.0 - 2.0 * np.pi)
    assert (turned[[0, 1, 2, 3, 5]] == 3.0).all()
