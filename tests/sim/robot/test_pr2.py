from collections.abc import Iterator

import numpy as np
import pytest

from skolem.sim.robot import bodies
from skolem.sim.robot.bullet import p
from skolem.sim.robot.pr2 import ARM, BASE, HEAD, PR2, TORSO
from skolem.traces.messages import HANDS, Hand, RobotState
from skolem.traces.messages.arm import CARRY

pytestmark = pytest.mark.physics

DOF20 = (*BASE, TORSO, *HEAD, *ARM["right"], *ARM["left"])
PENETRATION_M = -1e-4


@pytest.fixture(scope="module")
def loaded() -> Iterator[PR2]:
    client = bodies.connect(gravity=False)
    yield PR2(client, self_collision=True)
    bodies.disconnect(client)


@pytest.fixture
def robot(loaded: PR2) -> PR2:
    loaded.set_joints(dict.fromkeys(DOF20, 0.0))
    return loaded


def collides_with_itself(robot: PR2) -> bool:
    p.performCollisionDetection(physicsClientId=robot.client)
    contacts = p.getContactPoints(bodyA=robot.id, bodyB=robot.id, physicsClientId=robot.client)
    return any(contact[8] < PENETRATION_M for contact in contacts)


def test_frames_are_where_the_published_robot_has_them(robot: PR2) -> None:
    frames = {
        "base_link": (0.0, 0.0, 0.051),
        "head_mount_kinect_ir_link": (-0.146, 0.013, 1.464),
        "r_wrist_roll_link": (0.771, -0.188, 0.791),
        "r_gripper_tool_frame": (0.951, -0.188, 0.791),
    }
    for name, position in frames.items():
        assert robot.link_pose(name)[0] == pytest.approx(position, abs=6e-4)


def test_no_link_has_pybullets_default_mass(robot: PR2) -> None:
    masses = [p.getDynamicsInfo(robot.id, i, physicsClientId=robot.client)[0] for i in range(-1, len(robot.joint))]
    assert sum(masses) == pytest.approx(257.17, abs=0.01)


def test_there_are_twenty_degrees_of_freedom_with_finite_limits(robot: PR2) -> None:
    assert len(DOF20) == len(set(DOF20)) == 20
    assert all(robot.limits[name][0] < robot.limits[name][1] for name in DOF20)


def test_state_and_base_come_back_as_set(robot: PR2) -> None:
    state = RobotState(torso=0.1, head=(0.4, 0.5), right_arm=CARRY["right"], left_arm=(0.5,) * 3 + (-0.5,) * 4)
    robot.set_state(state)
    robot.set_base((1.0, -2.0, 3.0))
    assert robot.state() == state
    assert robot.base() == pytest.approx((1.0, -2.0, 3.0))


def test_the_camera_looks_through_the_point_it_is_turned_to(robot: PR2) -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        robot.set_joints(dict(zip((*BASE, TORSO), (*rng.uniform(-1.0, 1.0, 3), rng.uniform(0.0, 0.3)), strict=True)))
        bearing, distance = robot.base()[2] + rng.uniform(-2.5, 2.5), rng.uniform(0.6, 3.0)
        x, y, _ = robot.base()
        point = (x + distance * np.cos(bearing), y + distance * np.sin(bearing), rng.uniform(0.3, 1.2))
        robot.set_joints(dict(zip(HEAD, robot.look_at(point), strict=True)))
        eye, rotation = robot.camera_pose()
        ahead, left, up = rotation.T @ (np.array(point) - eye)
        assert np.hypot(left, up) < 1e-6 * ahead


def test_a_point_beyond_the_neck_gives_values_at_the_limits(robot: PR2) -> None:
    _, tilt = robot.look_at((-0.1, 0.0, 0.0))
    assert robot.limits[HEAD[1]][0] <= tilt <= robot.limits[HEAD[1]][1]


@pytest.mark.parametrize("hand", HANDS)
def test_the_carry_pose_is_free_and_level(robot: PR2, hand: Hand) -> None:
    robot.set_state(RobotState(torso=0.2, right_arm=CARRY["right"], left_arm=CARRY["left"]))
    assert not collides_with_itself(robot)
    rotation = np.reshape(p.getMatrixFromQuaternion(robot.tool_pose(hand)[1]), (3, 3))
    assert rotation == pytest.approx(np.eye(3), abs=1e-4)


def test_the_gripper_closes_and_opens_to_the_width_of_a_can(robot: PR2) -> None:
    robot.set_gripper("left", 0.0)
    assert robot.gripper_gap("left") < 0.0
    robot.set_gripper("left", 0.5)
    assert 0.080 < robot.gripper_gap("left") < 0.090


def test_one_collision_check_agrees_with_closest_points_of_every_pair(robot: PR2) -> None:
    rng, names, colliding = np.random.default_rng(1), (*ARM["right"], *ARM["left"]), 0
    low, high = np.array([robot.limits[name] for name in names]).T
    pairs = robot.checked_pairs()
    assert len(pairs) == 239
    for _ in range(40):
        robot.set_joints(dict(zip(names, rng.uniform(low, high), strict=True)))
        expected = any(
            point[8] < PENETRATION_M
            for i, j in pairs
            for point in p.getClosestPoints(
                robot.id, robot.id, 0.0, linkIndexA=i, linkIndexB=j, physicsClientId=robot.client
            )
        )
        assert collides_with_itself(robot) == expected
        colliding += expected
    assert 5 < colliding < 35
