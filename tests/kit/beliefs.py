"""A robot before a table of cans: its prior, its observations, and its belief."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.se2 import adjoint, upper
from skolem.traces.messages import (
    Action,
    ActionResult,
    Command,
    DepthView,
    Detection,
    Hand,
    HsvBelief,
    HsvVolume,
    LookAt,
    MoveBase,
    NoiseModel,
    ObjectType,
    Observation,
    Pick,
    Place,
    Pose2,
    Pose4,
    Prior,
    PriorObject,
    RobotState,
    Weigh,
    WeightInterval,
    Wrench,
)

TABLE_TOP = 0.7
TYPES = {
    "soda": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True),
    "carton": ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True),
    "table": ObjectType(shape="table", size_m=(0.7, 1.2, TABLE_TOP), graspable=False),
}
NOISE = NoiseModel(
    depth_sd_scale=1.0,
    extrinsics_sd_m=0.005,
    extrinsics_sd_rad=0.005,
    found=0.9,
    false_per_look=0.2,
    type_right=0.95,
    colour_gain=0.83,
    colour_sd_rgb=0.02,
    odometry_sd_m=0.005,
    odometry_sd_per_m=0.02,
    odometry_sd_rad=0.01,
    odometry_sd_per_rad=0.02,
    wrist_sd_newton=0.3,
    wrist_drift_newton=0.3,
    grasp_sd_m=0.002,
    grasp_sd_rad=0.02,
    place_sd_m=0.005,
    place_sd_rad=0.02,
)
EXACT = NOISE.model_copy(
    update={name: 0.0 for name in NoiseModel.model_fields if "_sd" in name or name in ("false_per_look",)}
)
STRETCHED = (0.0,) * 7
ROBOT = RobotState(right_arm=STRETCHED, left_arm=STRETCHED)
GREEN = HsvVolume(hue=(0.25, 0.42), saturation=(0.3, 1.0), value=(0.2, 1.0))
HEAVY = WeightInterval(at_least_kg=0.4)
GREEN_RGB, RED_RGB = (0.08, 0.6, 0.08), (0.6, 0.08, 0.08)
CANS = {"can1": (0.9, -0.3, 0.0), "can2": (0.95, 0.0, 0.0), "can3": (0.9, 0.3, 0.0)}
CAMERA = (-0.1, 0.0, 1.4)
PITCH = 0.6
FIT_SD = 0.002
TOOL: Pose4 = (0.93, -0.02, 0.75, 0.0)  # near can2
GRASP: Pose4 = (0.02, 0.02, -0.05, 0.0)


def prior(cans: dict[str, Pose2] = CANS, noise: NoiseModel = NOISE, sd_m: float = 0.05, base_sd: float = 0.01) -> Prior:
    """Return the prior of a table in front of the robot and cans on it."""
    table = PriorObject(
        anchor="table1", type={"table": 1.0}, world_T_object=(1.0, 0.0, 0.0, 0.0), sd_xy_m=0.01, sd_theta_rad=0.005
    )
    objects = [
        PriorObject(
            anchor=name,
            type={"soda": 0.8, "carton": 0.2},
            world_T_object=(x, y, TABLE_TOP, theta),
            sd_xy_m=sd_m,
            sd_theta_rad=1.8,
            support="table1",
        )
        for name, (x, y, theta) in cans.items()
    ]
    return Prior(
        world_T_base=(0.0, 0.0, 0.0),
        base_sd_xy_m=base_sd,
        base_sd_theta_rad=base_sd,
        robot=ROBOT,
        objects=(table, *objects),
        types=TYPES,
        colour=HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1)),
        log_weight=(math.log(0.3), 0.36),
        noise=noise,
    )


def depth_view(cylinders: Iterable[Pose2] = (), height: float = 0.115) -> DepthView:
    """Return the depth image, by a camera at 1.4 m that looks down, of an endless table top with cans (base frame)."""
    rows, columns, fovy = 30, 40, 0.796
    f = rows / 2 / math.tan(fovy / 2)
    c, s = math.cos(PITCH), math.sin(PITCH)
    row, column = np.divmod(np.arange(rows * columns), columns)
    left, up = -(column - columns / 2) / f, -(row + 1 - rows / 2) / f
    ray = np.stack([c + s * up, left, c * up - s], axis=-1)  # base frame, at depth 1 m
    depth = np.where(ray[:, 2] < -1e-6, (TABLE_TOP - CAMERA[2]) / np.minimum(ray[:, 2], -1e-6), 9.0)
    for x, y, _ in cylinders:
        a = ray[:, 0] ** 2 + ray[:, 1] ** 2
        b = (x - CAMERA[0]) * ray[:, 0] + (y - CAMERA[1]) * ray[:, 1]
        gap = b**2 - a * ((x - CAMERA[0]) ** 2 + (y - CAMERA[1]) ** 2 - 0.033**2)
        hit = (b - np.sqrt(np.maximum(gap, 0.0))) / a
        z = CAMERA[2] + hit * ray[:, 2]
        on_side = (gap > 0) & (z > TABLE_TOP) & (z < TABLE_TOP + height)
        depth = np.where(on_side, np.minimum(depth, hit), depth)
    depth[depth > 4.5] = 0.0
    return DepthView(
        base_T_camera=(*CAMERA, 0.0, math.sin(PITCH / 2), 0.0, math.cos(PITCH / 2)),
        fovy_rad=fovy,
        columns=columns,
        rows=rows,
        depth_mm=tuple(round(1000 * d) for d in depth),
    )


def detection(
    base_T_object: Pose2,
    kind: str = "soda",
    rgb: tuple[float, float, float] = RED_RGB,
    noise: NoiseModel = NOISE,
    z: float = TABLE_TOP,
) -> Detection:
    """Return a detection with the covariance of the noise model at its place; a cylinder's heading is 0."""
    x, y, theta = base_T_object
    theta = 0.0 if kind == "soda" else theta
    lever = np.array([x - CAMERA[0], y - CAMERA[1], z - CAMERA[2]])
    turn = np.array([[0.0, lever[2], -lever[1]], [-lever[2], 0.0, lever[0]], [0.0, 0.0, 1.0]])
    heading = 1.8 if kind == "soda" else 0.03
    axes = np.diag([FIT_SD**2, FIT_SD**2, heading**2]) + noise.extrinsics_sd_rad**2 * turn @ turn.T
    axes += noise.extrinsics_sd_m**2 * np.diag([1.0, 1.0, 0.0])
    frame = adjoint((0.0, 0.0, -theta))
    return Detection(
        base_T_object=(x, y, z, theta),
        covariance=upper(frame @ axes @ frame.T),
        type_log_likelihood={name: (-0.5 if name == kind else -40.0) for name in ("soda", "carton")},
        rgb=rgb,
        points=200,
    )


def table_detection(base_T_table: Pose2, sds: tuple[float, float, float] = (0.005, 0.005, 0.01)) -> Detection:
    return Detection(
        base_T_object=(base_T_table[0], base_T_table[1], 0.01, base_T_table[2]),
        covariance=upper(np.diag(np.square(sds)) + NOISE.extrinsics_sd_m**2 * np.eye(3)),
        type_log_likelihood={"table": -0.1},
        rgb=(0.5, 0.4, 0.3),
        points=9000,
    )


class Robot:
    """A belief that takes in actions and observations, with a count of the steps."""

    def __init__(self, start: Prior, config: EstimatorConfig | None = None) -> None:
        self.belief = Belief(start, config)
        self.joints = start.robot
        self.step = 0

    def _do(self, command: Command, args: tuple[str, ...] = (), odometry: Pose2 | None = None, **seen: object) -> None:
        result = {k: seen.pop(k) for k in ("status", "base_T_tool", "gripper_gap_m", "gaps_m") if k in seen}
        self.belief.update(
            Action(step=self.step, op=command.kind, args=args, command=command),
            ActionResult.model_validate(
                {"step": self.step, "status": "done", "robot": self.joints, "odometry": odometry} | result
            ),
            Observation.model_validate({"step": self.step, "kind": "none"} | seen),
        )
        self.step += 1

    def look(self, detections: Sequence[Detection], view: DepthView | None = None) -> None:
        self._do(LookAt(pan=0.0, tilt=PITCH), kind="look", detections=tuple(detections), view=view)

    def drive(self, odometry: Pose2, gaps_m: dict[Hand, float] | None = None) -> None:
        self._do(MoveBase(start_T_waypoint=(odometry,)), odometry=odometry, gaps_m=gaps_m or {})

    def pick(self, anchor: str, base_T_tool: Pose4, tool_T_object: Pose4, gap: float = 0.066) -> None:
        command = Pick(hand="right", approach=(), reach=(), lift=(), carry=(STRETCHED,), tool_T_object=tool_T_object)
        status = "done" if gap > 0.0 else "failed"
        self._do(command, (anchor,), status=status, base_T_tool=base_T_tool, gripper_gap_m=gap)

    def place(
        self,
        anchor: str,
        support: str,
        base_T_tool: Pose4 | None,
        status: str = "done",
        gaps_m: dict[Hand, float] | None = None,
    ) -> None:
        command = Place(hand="right", approach=(), lower=(), retreat=(), carry=(STRETCHED,))
        opened = {"gripper_gap_m": 0.08, "gaps_m": gaps_m or {}}
        self._do(command, (anchor, support), None, status=status, base_T_tool=base_T_tool, **opened)

    def weigh(self, newton: float) -> None:
        wrench = Wrench(hand="right", force_newton=(0.0, 0.0, -newton), samples=48)
        self._do(Weigh(hand="right"), kind="weigh", wrench=wrench)


def sees_all(robot: Robot, cans: dict[str, Pose2] = CANS, noise: NoiseModel = NOISE, times: int = 1) -> None:
    for _ in range(times):
        robot.look([detection(pose, noise=noise) for pose in cans.values()], depth_view(cans.values()))


def pose_of(robot: Robot, anchor: str) -> Pose2:
    x, y, _, theta = robot.belief.snapshot(0).objects[anchor].world_T_object
    return (x, y, theta)
