import math
import subprocess
import sys
from collections.abc import Iterable, Sequence

import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import EVENT
from skolem.estimation.fluents import covariance_within
from skolem.estimation.se2 import adjoint, between, compose, exp, inverse, log, relative_jacobian, symmetric, upper
from skolem.traces.errors import InputError, InternalError
from skolem.traces.messages import (
    Action,
    ActionResult,
    Command,
    DepthView,
    Detection,
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
    TypeIs,
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


def prior(cans: dict[str, Pose2] = CANS, noise: NoiseModel = NOISE, sd_m: float = 0.05, base_sd: float = 0.01) -> Prior:
    """One table in front of the robot and cans on it."""
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
    """What a camera at 1.4 m, pitched down, sees of an endless table top and of cans on it (base frame)."""
    rows, columns, fovy = 30, 40, 0.796
    f = rows / 2 / math.tan(fovy / 2)
    c, s = math.cos(PITCH), math.sin(PITCH)
    row, column = np.divmod(np.arange(rows * columns), columns)
    left, up = -(column - columns / 2) / f, -(row + 1 - rows / 2) / f
    ray = np.stack([c + s * up, left, c * up - s], axis=-1)  # base frame, of unit depth
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
    """A detection with the covariance that the noise model gives it there; a cylinder's heading is reported as 0."""
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
    """Feeds a belief with actions and observations, counting steps."""

    def __init__(self, told: Prior, config: EstimatorConfig | None = None) -> None:
        self.belief = Belief(told, config)
        self.joints = told.robot
        self.step = 0

    def _do(self, command: Command, args: tuple[str, ...] = (), odometry: Pose2 | None = None, **seen: object) -> None:
        result = {k: seen.pop(k) for k in ("status", "base_T_tool", "gripper_gap_m") if k in seen}
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

    def drive(self, odometry: Pose2) -> None:
        self._do(MoveBase(start_T_waypoint=(odometry,)), odometry=odometry)

    def pick(self, anchor: str, base_T_tool: Pose4, tool_T_object: Pose4, gap: float = 0.066) -> None:
        command = Pick(hand="right", approach=(), reach=(), lift=(), carry=(STRETCHED,), tool_T_object=tool_T_object)
        status = "done" if gap > 0.0 else "failed"
        self._do(command, (anchor,), status=status, base_T_tool=base_T_tool, gripper_gap_m=gap)

    def place(self, anchor: str, support: str, base_T_tool: Pose4 | None, status: str = "done") -> None:
        command = Place(hand="right", approach=(), lower=(), retreat=(), carry=(STRETCHED,))
        self._do(command, (anchor, support), status=status, base_T_tool=base_T_tool, gripper_gap_m=0.08)

    def weigh(self, newton: float) -> None:
        wrench = Wrench(hand="right", force_newton=(0.0, 0.0, -newton), samples=48)
        self._do(Weigh(hand="right"), kind="weigh", wrench=wrench)


def sees_all(robot: Robot, cans: dict[str, Pose2] = CANS, noise: NoiseModel = NOISE, times: int = 1) -> None:
    for _ in range(times):
        robot.look([detection(pose, noise=noise) for pose in cans.values()], depth_view(cans.values()))


def pose_of(robot: Robot, anchor: str) -> Pose2:
    x, y, _, theta = robot.belief.snapshot(0).objects[anchor].world_T_object
    return (x, y, theta)


# ---------------------------------------------------------------- what it starts with


def test_prior_is_believed_as_told() -> None:
    belief = Belief(prior())
    assert belief.anchors() == ("table1", "can1", "can2", "can3")
    assert belief.version == 1
    assert belief.prob_exists("can1") == 0.99
    assert belief.prob_exists("nobody") == 0.0
    assert belief.prob_property("can1", TypeIs(type="soda")) == pytest.approx(0.8)
    assert belief.graspable("can1")
    assert not belief.graspable("table1")
    assert (belief.prob_detected("can1"), belief.prob_detected("table1")) == (0.9, 0.9)
    assert (belief.support("can1"), belief.support("table1")) == ("table1", None)
    assert belief.prob_type_right() == 0.95
    assert belief.held("right") is None
    told = belief.snapshot(0).objects["can3"]
    assert told.world_T_object == pytest.approx((0.9, 0.3, TABLE_TOP, 0.0))
    assert np.sqrt(np.diag(symmetric(told.covariance))) == pytest.approx((0.05, 0.05, 1.8))


def test_every_fault_of_a_prior_is_reported_at_once() -> None:
    good = prior()
    wrong = good.objects[1].model_copy(update={"anchor": "base", "type": {"ghost": 1.0}, "support": "nowhere"})
    with pytest.raises(InputError) as caught:
        Belief(good.model_copy(update={"objects": (*good.objects, wrong, good.objects[1])}))
    assert sorted(fault.at for fault in caught.value.faults) == [
        "objects.4.anchor",
        "objects.4.support",
        "objects.4.type",
        "objects.5.anchor",
    ]


def test_unknown_anchor_is_named_with_the_known_ones() -> None:
    with pytest.raises(InternalError, match="no anchor 'can9'; there are: table1, can1"):
        Belief(prior()).gaussian("pose", "can9")


# ---------------------------------------------------------------- looking


def test_a_look_localises_a_table_whichever_way_round_it_is_seen() -> None:
    for turn in (0.0, math.pi):
        robot = Robot(prior())
        robot.drive((0.3, 0.0, 0.0))
        before = robot.belief.gaussian("pose", "table1")
        robot.look([table_detection((0.69, 0.01, 0.01 + turn))])
        after = robot.belief.gaussian("pose", "table1")
        assert covariance_within(after.covariance, before.covariance)
        assert np.sqrt(np.diag(after.covariance)).max() < 0.012
        assert after.mean == pytest.approx((0.69, 0.01, 0.01), abs=0.01)
        assert robot.belief.anchors() == ("table1", "can1", "can2", "can3")


def test_edges_along_one_axis_leave_the_other_as_unknown_as_it_was() -> None:
    robot = Robot(prior(base_sd=0.0))
    robot.drive((0.3, 0.0, 0.0))
    before = np.sqrt(np.diag(robot.belief.gaussian("pose", "table1").covariance))
    robot.look([table_detection((0.7, 0.3, 0.0), (0.005, 0.5, 0.01))])
    after = np.sqrt(np.diag(robot.belief.gaussian("pose", "table1").covariance))
    assert after[0] < 0.7 * before[0]
    assert after[1] == pytest.approx(before[1], rel=0.1)


def test_a_table_that_is_not_reported_is_not_doubted() -> None:
    robot = Robot(prior())
    for _ in range(5):
        sees_all(robot)
    assert robot.belief.prob_exists("table1") == 0.99


def test_a_table_is_never_taken_for_a_thing_nor_a_thing_for_a_table() -> None:
    robot = Robot(prior({"can1": (1.0, 0.0, 0.0)}))
    robot.look([table_detection((1.0, 0.0, 0.0)), detection((1.0, 0.0, 0.0))])
    assert robot.belief.prob_property("can1", TypeIs(type="soda")) > 0.9
    assert robot.belief.prob_property("table1", TypeIs(type="table")) == 1.0
    assert robot.belief.anchors() == ("table1", "can1")


def test_a_table_clearly_beside_the_known_ones_is_a_new_one() -> None:
    robot = Robot(prior())
    robot.look([table_detection((0.2, 1.6, 0.3)), table_detection((1.0, 0.0, 0.0))])
    assert robot.belief.anchors() == ("table1", "can1", "can2", "can3", "_o1_")
    assert not robot.belief.graspable("_o1_")
    assert robot.belief.prob_property("_o1_", TypeIs(type="table")) == 1.0
    assert robot.belief.snapshot(0).objects["_o1_"].world_T_object == pytest.approx((0.2, 1.6, 0.0, 0.3), abs=0.02)


@pytest.mark.parametrize(
    "sds", [(0.005, 0.005, 0.01), (0.5, 0.005, 0.01)], ids=["overlapping", "perhaps_the_known_one"]
)
def test_a_table_where_no_other_can_stand_is_not_believed(sds: tuple[float, float, float]) -> None:
    robot = Robot(prior())
    robot.look([table_detection((0.8 if sds[0] < 0.1 else 1.0, 0.6, 0.8), sds)])
    assert robot.belief.anchors() == ("table1", "can1", "can2", "can3")


def test_a_table_that_can_be_no_other_tells_a_robot_that_slipped_where_it_is() -> None:
    robot = Robot(prior(base_sd=0.03))
    gate, slip = EstimatorConfig().gate, (0.0, 0.15, 0.10)
    table = robot.belief.gaussian("pose", "table1")
    seen = compose(inverse(slip), (float(table.mean[0]), float(table.mean[1]), float(table.mean[2])))
    innovation = log(between((1.0, 0.0, 0.0), seen))
    assert gate < innovation @ np.linalg.solve(table.covariance, innovation)
    robot.look([table_detection(seen)])
    assert robot.belief.gaussian("pose", "table1").mean == pytest.approx(seen, abs=0.02)
    assert robot.belief.anchors() == ("table1", "can1", "can2", "can3")


def test_one_look_is_expected_to_place_a_table_to_about_a_centimetre() -> None:
    expected = np.sqrt(np.diag(Belief(prior()).observation_covariance("pose", "table1")))
    assert (expected > 0.01).sum() == 3
    assert (expected < 0.015).all()


def test_look_sharpens_pose_type_and_colour() -> None:
    robot = Robot(prior())
    before = robot.belief.gaussian("pose", "can2")
    robot.look([detection(CANS["can2"], rgb=GREEN_RGB)], depth_view(CANS.values()))
    after = robot.belief.gaussian("pose", "can2")
    assert covariance_within(after.covariance[:2, :2], before.covariance[:2, :2])
    assert np.sqrt(np.diag(after.covariance))[:2].max() < 0.01
    assert robot.belief.prob_property("can2", TypeIs(type="soda")) == pytest.approx(0.987, abs=5e-4)
    assert robot.belief.prob_property("can2", GREEN) > 0.99
    assert robot.belief.snapshot(1).objects["can2"].colour_seen
    assert not robot.belief.snapshot(1).objects["can1"].colour_seen


def test_detection_of_another_type_lowers_the_type() -> None:
    robot = Robot(prior())
    robot.look([detection(CANS["can2"], kind="carton")], depth_view(CANS.values()))
    assert robot.belief.prob_property("can2", TypeIs(type="soda")) == pytest.approx(
        0.8 * 0.05 / (0.8 * 0.05 + 0.2 * 0.95)
    )


def test_looks_leave_the_error_of_the_camera_common_to_all_they_see() -> None:
    robot = Robot(prior())
    sees_all(robot)
    belief = robot.belief.snapshot(1)
    size = 3 * len(belief.keys)
    joint = np.zeros((size, size))
    joint[np.triu_indices(size)] = belief.joint_covariance
    joint += np.triu(joint, 1).T
    cans = [belief.keys.index(name) for name in ("can1", "can2")]
    block = joint[np.ix_([3 * cans[0], 3 * cans[1]], [3 * cans[0], 3 * cans[1]])]
    assert block[0, 1] / math.sqrt(block[0, 0] * block[1, 1]) > 0.5


def test_observation_covariance_is_what_a_look_from_the_typical_distance_leaves() -> None:
    robot = Robot(prior(cans={"can": (0.9, 0.0, 0.0)}, sd_m=1.0, base_sd=1e-4))
    expected = robot.belief.observation_covariance("pose", "can")
    robot.look([detection((0.9, 0.0, 0.0))], depth_view())
    got = robot.belief.gaussian("pose", "can").covariance
    assert np.sqrt(np.diag(got))[:2] == pytest.approx(np.sqrt(np.diag(expected))[:2], rel=0.15)
    assert np.linalg.eigvalsh(expected)[0] > 0.0
    assert covariance_within(expected[:2, :2], np.diag([0.012, 0.012]) ** 2)


def test_box_seen_half_a_turn_away_is_not_turned() -> None:
    told = prior(cans={"box": (0.9, 0.0, 1.4)})
    item = told.objects[1].model_copy(update={"type": {"carton": 1.0}, "sd_theta_rad": 0.1})
    robot = Robot(told.model_copy(update={"objects": (told.objects[0], item)}))
    robot.look([detection((0.9, 0.0, 1.45 - math.pi), kind="carton")], depth_view())
    assert robot.belief.anchors() == ("table1", "box")
    assert 1.4 < pose_of(robot, "box")[2] < 1.46


def test_two_hundred_looks_at_five_objects_leave_five_anchors() -> None:
    cans = {f"can{i}": (0.8 + 0.1 * (i % 2), -0.4 + 0.2 * i, 0.0) for i in range(5)}
    robot = Robot(prior(cans=cans))
    view = depth_view(cans.values())
    draws = Generator(PCG64(SeedSequence([1])))
    for _ in range(200):
        camera = exp(draws.normal(size=3) * (0.005, 0.005, 0.005))
        found = [c for c in cans.values() if draws.random() < NOISE.found]
        robot.look(
            [detection(compose(compose(camera, c), exp(draws.normal(size=3) * (0.002, 0.002, 0.0)))) for c in found],
            view,
        )
    assert robot.belief.anchors() == ("table1", *cans)
    assert min(robot.belief.prob_exists(name) for name in cans) > 0.9


# ---------------------------------------------------------------- existence


def test_one_detection_of_something_new_is_not_yet_an_object() -> None:
    robot = Robot(prior(cans={}))
    robot.look([detection((0.9, 0.1, 0.0))], depth_view([(0.9, 0.1, 0.0)]))
    assert robot.belief.anchors() == ("table1",)
    assert robot.belief.prob_exists("_o1_") == pytest.approx(0.2)
    robot.look([detection((0.905, 0.1, 0.0))], depth_view([(0.9, 0.1, 0.0)]))
    assert robot.belief.anchors() == ("table1", "_o1_")
    assert robot.belief.prob_on("_o1_", "table1") > 0.95
    assert robot.belief.snapshot(2).objects["_o1_"].support == "table1"


def test_false_detections_vanish_and_their_names_are_not_used_again() -> None:
    robot = Robot(prior(cans={}))
    for y in (0.1, 0.3, -0.2):
        robot.look([detection((0.9, y, 0.0))], depth_view())
    robot.look([], depth_view())
    assert robot.belief.anchors() == ("table1",)
    assert [robot.belief.prob_exists(f"_o{i}_") < 0.06 for i in (1, 2, 3)] == [True] * 3
    assert robot.belief.prob_exists("_o4_") == 0.0


def test_names_of_told_objects_are_not_given_again() -> None:
    robot = Robot(prior(cans={"_o4_": (0.9, -0.2, 0.0)}))
    robot.look([detection((0.9, 0.3, 0.0))], depth_view())
    assert robot.belief.prob_exists("_o5_") > 0.0


def test_object_moved_behind_the_robots_back_is_lost_there_and_found_elsewhere() -> None:
    robot = Robot(prior())
    sees_all(robot)
    moved = {**CANS, "can2": (0.75, 0.15, 0.0)}
    misses = 0
    while robot.belief.prob_exists("can2") >= 0.5:
        sees_all(robot, moved)
        misses += 1
    assert misses in (2, 3)
    assert robot.belief.anchors() == ("table1", "can1", "can3", "_o1_")
    assert pose_of(robot, "_o1_")[:2] == pytest.approx((0.75, 0.15), abs=0.01)


def test_hidden_object_keeps_its_existence() -> None:
    robot = Robot(prior())
    sees_all(robot)
    in_front = (0.7, 0.0, 0.0)
    for _ in range(5):
        seen = [detection(CANS["can1"]), detection(CANS["can3"]), detection(in_front)]
        robot.look(seen, depth_view([in_front], height=0.3))
    assert robot.belief.prob_exists("can2") == pytest.approx(0.99)
    assert robot.belief.prob_exists("_o1_") > 0.9


def test_look_elsewhere_is_no_evidence() -> None:
    robot = Robot(prior())
    robot.drive((0.0, 0.0, 2.0))
    robot.look([], depth_view())
    assert robot.belief.prob_exists("can2") == 0.99


# ---------------------------------------------------------------- moving, picking, placing, weighing


def test_driving_widens_and_looking_at_one_object_sharpens_another() -> None:
    robot = Robot(prior(sd_m=0.01))
    sees_all(robot)
    still = robot.belief.gaussian("pose", "can3").covariance[:2, :2]
    robot.drive((0.0, 0.5, 0.0))
    drifted = robot.belief.gaussian("pose", "can3").covariance[:2, :2]
    assert not covariance_within(drifted, still)
    robot.look([detection((0.9, -0.8, 0.0))], depth_view())
    assert robot.belief.prob_exists("_o1_") == 0.0
    sharper = robot.belief.gaussian("pose", "can3").covariance[:2, :2]
    assert np.trace(sharper) < 0.8 * np.trace(drifted)


def test_wheels_that_did_not_turn_add_no_uncertainty() -> None:
    robot = Robot(prior())
    robot.drive((0.0, 0.0, 0.0))
    assert symmetric(robot.belief.snapshot(1).base_covariance) == pytest.approx(np.diag([1e-4] * 3))


def test_noiseless_run_has_no_error() -> None:
    base: Pose2 = (0.0, 0.0, 0.0)
    robot = Robot(prior(noise=EXACT, sd_m=0.03))
    for motion in ((0.1, 0.05, 0.1), (-0.2, 0.1, -0.3), (0.1, -0.1, 0.2)):
        base = compose(base, motion)
        robot.drive(motion)
        robot.look([detection(between(base, can), noise=EXACT) for can in CANS.values()], None)
    for name, truth in CANS.items():
        relative = robot.belief.gaussian("pose", name).mean
        assert relative[:2] == pytest.approx(between(base, truth)[:2], abs=1e-6)
    assert robot.belief.anchors() == ("table1", *CANS)


TOOL: Pose4 = (0.93, -0.02, 0.75, 0.0)  # near can2
GRASP: Pose4 = (0.02, 0.02, -0.05, 0.0)


def test_picked_object_travels_with_the_hand_and_is_known_well_relative_to_the_base() -> None:
    robot = Robot(prior())
    sees_all(robot)
    assert robot.belief.prob_on("can2", "table1") > 0.9
    robot.pick("can2", TOOL, GRASP)
    assert robot.belief.held("right") == "can2"
    assert robot.belief.prob_on("can2", "table1") == 0.0
    robot.drive((0.5, 0.5, 0.5))
    held, free = (robot.belief.gaussian("pose", name).covariance for name in ("can2", "can1"))
    assert np.sqrt(np.diag(held))[:2].max() < 0.01 < np.sqrt(np.diag(free))[:2].max()
    believed = robot.belief.snapshot(9).objects["can2"]
    # both arms stretched: the hand is 0.951 m ahead of the base, at the shoulder's height
    assert believed.world_T_object == pytest.approx(
        (*compose((0.5, 0.5, 0.5), (0.971, -0.168, 0.0))[:2], 0.790675 - 0.05, 0.5), abs=0.02
    )
    assert believed.in_hand == "right"
    assert believed.tool_T_object == pytest.approx(GRASP, abs=0.02)
    assert believed.support is None


def test_placed_object_is_where_the_hand_left_it() -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0))
    believed = robot.belief.snapshot(3).objects["can2"]
    assert believed.world_T_object[:3] == pytest.approx((0.82, 0.12, TABLE_TOP), abs=0.01)
    assert believed.support == "table1"
    assert believed.in_hand is None
    assert robot.belief.held("right") is None
    assert robot.belief.prob_on("can2", "table1") > 0.9
    placed = np.sqrt(np.diag(robot.belief.gaussian("pose", "can2").covariance))[:2]
    assert 0.005 < placed.min()
    assert placed.max() < 0.012


def test_object_placed_at_the_edge_is_half_on() -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (1.0 - 0.35 + 0.033 - 0.02, 0.0, 0.75, 0.0))
    assert robot.belief.prob_on("can2", "table1") == pytest.approx(0.5, abs=0.2)


def test_place_that_did_not_open_the_fingers_leaves_the_object_held() -> None:
    robot = Robot(prior())
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", None, status="failed")
    assert robot.belief.held("right") == "can2"


def test_place_that_dropped_the_object_leaves_it_vaguely_there() -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0), status="failed")
    assert robot.belief.held("right") is None
    assert np.sqrt(np.diag(robot.belief.gaussian("pose", "can2").covariance))[:2].min() > 0.04


def test_failed_pick_leaves_the_object_known_less_well() -> None:
    robot = Robot(prior())
    sees_all(robot, times=2)
    before = robot.belief.gaussian("pose", "can2")
    robot.pick("can2", TOOL, GRASP, gap=0.0)
    after = robot.belief.gaussian("pose", "can2")
    assert robot.belief.held("right") is None
    assert after.mean == pytest.approx(before.mean)
    assert np.sqrt(np.diag(after.covariance - before.covariance)) == pytest.approx((0.03, 0.03, 0.3), rel=1e-6)
    assert 0.5 < after.probability < before.probability


def test_weight_of_the_papers_example_objects() -> None:
    light, heavy = Robot(prior()), Robot(prior())
    for robot, newton in ((light, 0.981), (heavy, 4.905)):
        robot.pick("can2", TOOL, GRASP)
        robot.weigh(newton)
    assert light.belief.prob_property("can2", HEAVY) < 1e-3
    assert heavy.belief.prob_property("can2", HEAVY) > 0.9
    assert heavy.belief.gaussian("weight", "can2").mean == pytest.approx([math.log(0.5)], abs=0.1)
    assert heavy.belief.snapshot(2).objects["can2"].weighed
    assert 0.5 < heavy.belief.prob_favourable("can1", HEAVY, 0.9) < 1.0


# ---------------------------------------------------------------- the log and the snapshot


def eventful() -> Robot:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.weigh(4.9)
    robot.drive((-0.1, 0.2, 0.3))
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0))
    robot.look([detection((0.81, 0.12, 0.0)), detection((0.7, -0.3, 0.0))], depth_view())
    robot.pick("can1", TOOL, GRASP, gap=0.0)
    return robot


def test_belief_rebuilt_from_its_events_is_the_same_to_the_last_bit() -> None:
    belief = eventful().belief
    text = [EVENT.dump_json(event) for event in belief.events]
    again = Belief.from_events(EVENT.validate_json(line) for line in text)
    assert again.version == belief.version
    assert again.snapshot(8).canonical() == belief.snapshot(8).canonical()


def test_snapshot_is_the_same_in_another_process() -> None:
    code = (
        "import importlib.util as u, sys, hashlib; s = u.spec_from_file_location('t', sys.argv[1]);"
        "m = u.module_from_spec(s); sys.modules['t'] = m; s.loader.exec_module(m);"
        "print(hashlib.sha256(m.eventful().belief.snapshot(8).canonical()).hexdigest())"
    )
    digests = {
        subprocess.run(
            [sys.executable, "-c", code, __file__], env={"PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2")
    }
    assert len(digests) == 1


def test_order_in_which_the_detector_reports_decides_nothing() -> None:
    snapshots = []
    for turn in (1, -1):
        robot = Robot(prior())
        robot.look([detection(pose) for pose in ((0.7, 0.2, 0.0), *CANS.values(), (0.7, -0.2, 0.0))][::turn], None)
        snapshots.append(robot.belief.snapshot(1).canonical())
    assert snapshots[0] == snapshots[1]


def test_whether_two_things_are_near_does_not_depend_on_how_they_are_turned() -> None:
    robot = Robot(prior())
    sees_all(robot, times=4)
    apart = math.dist(CANS["can1"][:2], CANS["can2"][:2])
    assert math.sqrt(robot.belief.gaussian("pose", "can1").covariance[2, 2]) > 0.5
    for one, other in (("can1", "can2"), ("can2", "can1")):
        assert robot.belief.prob_near(one, other, apart + 0.03) > 0.99
        assert robot.belief.prob_near(one, other, apart - 0.03) < 0.01


def test_joint_covariance_of_the_snapshot_gives_the_relative_pose() -> None:
    robot = eventful()
    belief = robot.belief.snapshot(8)
    size = 3 * len(belief.keys)
    joint = np.zeros((size, size))
    joint[np.triu_indices(size)] = belief.joint_covariance
    joint += np.triu(joint, 1).T
    assert belief.keys == ("base", *belief.anchors)
    assert joint[:3, :3] == pytest.approx(symmetric(belief.base_covariance))
    for name in ("can2", "can3"):
        at = 3 * belief.keys.index(name)
        index = [0, 1, 2, at, at + 1, at + 2]
        jacobian = relative_jacobian(between(belief.world_T_base, pose_of(robot, name)))
        expected = robot.belief.gaussian("pose", name).covariance
        assert jacobian @ joint[np.ix_(index, index)] @ jacobian.T == pytest.approx(expected, rel=1e-6, abs=1e-12)


def test_misfitting_event_changes_nothing() -> None:
    robot = eventful()
    before, version = robot.belief.snapshot(8), robot.belief.version
    placed = next(event for event in robot.belief.events if event.kind == "placed")
    with pytest.raises(InternalError, match="'placed' does not fit"):
        robot.belief.apply(placed)
    assert robot.belief.version == version
    assert robot.belief.snapshot(8) == before


# ---------------------------------------------------------------- consistency


def run_truth(seed: int) -> list[float]:
    """Return squared normalised errors of cans relative to the base; the noise is what the belief assumes."""
    draws = Generator(PCG64(SeedSequence([seed])))
    told = prior(sd_m=0.03)
    base = compose(told.world_T_base, exp(draws.normal(size=3) * 0.01))
    truth = {name: (x + draws.normal() * 0.03, y + draws.normal() * 0.03, 0.0) for name, (x, y, _) in CANS.items()}
    robot, errors = Robot(told), []
    for step in range(8):
        if step % 2:
            motion = tuple(float(v) for v in draws.uniform(-0.1, 0.1, 3))
            sd_m, sd_rad = 0.005 + 0.02 * math.hypot(*motion[:2]), 0.01 + 0.02 * abs(motion[2])
            base = compose(
                compose(base, (motion[0], motion[1], motion[2])), exp(draws.normal(size=3) * (sd_m, sd_m, sd_rad))
            )
            robot.drive((motion[0], motion[1], motion[2]))
        plane = math.hypot(NOISE.extrinsics_sd_m, NOISE.extrinsics_sd_rad * (CAMERA[2] - TABLE_TOP))
        shift = exp(draws.normal(size=3) * (plane, plane, NOISE.extrinsics_sd_rad))
        at_camera: Pose2 = (CAMERA[0], CAMERA[1], 0.0)
        error = compose(compose(at_camera, shift), inverse(at_camera))
        seen = [
            compose(compose(error, between(base, can)), exp(draws.normal(size=3) * (FIT_SD, FIT_SD, 0.0)))
            for can in truth.values()
        ]
        robot.look([detection(pose) for pose in seen], None)
        for name, can in truth.items():
            belief = robot.belief.gaussian("pose", name)
            x, y, theta = belief.mean.tolist()
            off = log(between((x, y, theta), (*between(base, can)[:2], theta)))[:2]
            errors.append(float(off @ np.linalg.solve(belief.covariance[:2, :2], off)))
    assert robot.belief.anchors() == ("table1", *CANS)
    return errors


def test_errors_are_as_large_as_the_belief_says() -> None:
    nees = np.mean([error for seed in range(20) for error in run_truth(seed)])
    assert 1.3 < nees < 2.7  # 2 for a planar position; 480 correlated samples
