"""Types, noise models, a camera over a table and a grasp, shared by the tests of sensing and of the simulated world."""

import colorsys
import math

import numpy as np
from numpy.typing import NDArray

from skolem.sim.detector.cloud import Cloud, cloud_from_depth
from skolem.sim.physics import camera
from skolem.sim.robot import bodies, ik
from skolem.sim.robot.rotations import rotation
from skolem.sim.space.pinhole import Frame
from skolem.sim.truth.bodies import TrueBody
from skolem.sim.truth.noise import Extrinsics, Purpose, extrinsic_error, noisy_depth, stream
from skolem.traces.messages import Hand, Joints7, NoiseModel, ObjectType, Pick, Place, Pose4, RobotState
from skolem.traces.messages.poses import compose4, inverse4

TABLE_M = 0.68
TYPES = {
    "bottle": ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.20), graspable=True),
    "carton": ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True),
    "low_table": ObjectType(shape="table", size_m=(0.5, 0.5, 0.45), graspable=False),
    "soda": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True),
    "table": ObjectType(shape="table", size_m=(0.7, 1.1, TABLE_M), graspable=False),
}
EXACT = NoiseModel(
    depth_sd_scale=0.0,
    extrinsics_sd_m=0.0,
    extrinsics_sd_rad=0.0,
    found=1.0,
    false_per_look=0.0,
    type_right=1.0,
    colour_gain=0.8,
    colour_sd_rgb=0.0,
    odometry_sd_m=0.0,
    odometry_sd_per_m=0.0,
    odometry_sd_rad=0.0,
    odometry_sd_per_rad=0.0,
    wrist_sd_newton=0.0,
    wrist_drift_newton=0.0,
    grasp_sd_m=0.0,
    grasp_sd_rad=0.0,
    place_sd_m=0.0,
    place_sd_rad=0.0,
)
CLEAR = EXACT.model_copy(update={"depth_sd_scale": 1.0})
SHAKY = CLEAR.model_copy(update={"extrinsics_sd_m": 0.01, "extrinsics_sd_rad": 0.0175})
RED, GREEN, BLUE = (0.99, 0.9, 0.8), (0.33, 0.9, 0.8), (0.63, 0.9, 0.8)
Placed = tuple[str, Pose4, tuple[float, float, float]]  # type, world_T_object, hsv


def looking(eye: tuple[float, float, float], at: tuple[float, float, float]) -> Frame:
    """Return a level camera frame at `eye` that looks at a point (metres)."""
    forward = np.subtract(at, eye) / math.dist(at, eye)
    left = np.cross([0.0, 0.0, 1.0], forward)
    left /= np.linalg.norm(left)
    return Frame(np.array(eye), np.column_stack([forward, left, np.cross(forward, left)]))


HEAD = looking((0.0, 0.0, 1.45), (1.1, 0.0, 0.7))
TABLE: Placed = ("table", (1.1, 0.0, 0.0, 0.0), (0.08, 0.46, 0.65))


def picture(things: list[Placed], frame: Frame = HEAD) -> camera.Image:
    """Return a rendering of objects on a floor, without a robot."""
    client = bodies.connect()
    bodies.floor(client)
    for name, world_T_object, hsv in things:
        bodies.object_body(client, TYPES[name], world_T_object, (*colorsys.hsv_to_rgb(*hsv), 1.0), 0.0)
    image = camera.render(client, frame)
    bodies.disconnect(client)
    return image


def seen_cloud(things: list[Placed], noise: NoiseModel, step: int = 0, frame: Frame = HEAD) -> Cloud:
    """Return the noisy cloud of objects on a floor; the base frame is the world frame."""
    image = picture(things, frame)
    depth = noisy_depth(image.depth, noise.depth_sd_scale, stream(0, step, Purpose.DEPTH))
    error = extrinsic_error(noise, stream(0, step, Purpose.EXTRINSICS))
    return cloud_from_depth(depth, camera.exposed(image.rgb, noise.colour_gain), frame, error)


NO_ERROR = Extrinsics(np.eye(3), np.zeros(3))


def near_table(*things: TrueBody) -> list[TrueBody]:
    """Return the table in front of the robot and some objects."""
    return [TrueBody("table1", "table", (0.85, 0.0, 0.0, 0.0), (0.08, 0.46, 0.65), 20.0), *things]


def can(x: float = 0.6, y: float = -0.2, name: str = "can1") -> TrueBody:
    """Return a green can of 350 g on the table in front of the robot."""
    return TrueBody(name, "soda", (x, y, TABLE_M, 0.0), GREEN, 0.35)


def pick_at(robot: RobotState, base_T_object: Pose4, above_m: float = 0.065, hand: Hand = "right") -> Pick:
    """Return a pick with a level grasp along x, from 12 cm before an object to 12 cm above its place."""
    start = np.array(robot.right_arm if hand == "right" else robot.left_arm)
    base_T_tool = (base_T_object[0], base_T_object[1], base_T_object[2] + above_m, 0.0)
    at, level = np.array(base_T_tool[:3]), rotation(0.0)
    reach = np.array([np.add(at, (0.02 * k - 0.12, 0.0, 0.0)) for k in range(1, 7)])
    lift = np.array([np.add(at, (0.0, 0.0, 0.02 * k)) for k in range(1, 7)])
    pregrasps = ik.all_solutions(hand, robot.torso, at - [0.12, 0.0, 0.0], level, ik.pan_grid(hand, 48))
    pregrasps = ik.nearest_turn(pregrasps, start)
    for pregrasp in sorted(pregrasps, key=lambda joints: float(np.abs(joints - start).sum())):
        path = ik.follow(hand, robot.torso, pregrasp, np.concatenate([reach, lift]), level)
        if path is not None:
            return Pick(
                hand=hand,
                approach=_joints(pregrasp[None]),
                reach=_joints(path[:6]),
                lift=_joints(path[6:]),
                carry=(),
                tool_T_object=compose4(inverse4(base_T_tool), base_T_object),
            )
    raise AssertionError(f"the test's grasp at {base_T_object} is out of reach")


def put_back(pick: Pick) -> Place:
    """Return the place that reverses a pick, from the end of its lift."""
    return Place(
        hand=pick.hand,
        approach=(),
        lower=(*reversed(pick.lift[:-1]), pick.reach[-1]),
        retreat=(*reversed(pick.reach[:-1]), pick.approach[-1]),
        carry=(),
    )


def _joints(path: NDArray[np.float64]) -> tuple[Joints7, ...]:
    return tuple((a, b, c, d, e, f, g) for a, b, c, d, e, f, g in path.tolist())
