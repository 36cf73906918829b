import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kit.places import TESTS
from kit.tabletop import BLUE, EXACT, GREEN, RED, TABLE_M, TYPES, can, near_table, pick_at, put_back
from scipy.spatial.transform import Rotation

from skolem.sim.physics.pybullet import PyBulletWorld
from skolem.sim.physics.world import RECORD_TICKS
from skolem.sim.space.pinhole import pixel_rays
from skolem.sim.truth.bodies import TrueBody
from skolem.tools.loop.displaced import displaced
from skolem.traces.messages import (
    Action,
    ActionResult,
    Command,
    LookAt,
    MoveBase,
    NoiseModel,
    Observation,
    Pick,
    Place,
    Pose2,
    Pose4,
    TrueObject,
    Weigh,
)
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import compose2, compose4, inverse4, raised

pytestmark = pytest.mark.physics

CONSTRAINT_SLACK = 1e-4  # m or rad, between a held thing in the physics and where the grasp has it
SOLVER_M = 0.001  # how far a thing may move in a grasp or a release that meets it exactly
START: Pose2 = (0.0, 0.0, 0.0)
CAN: Pose4 = (0.6, -0.2, TABLE_M, 0.0)
DOWN = LookAt(pan=-0.3, tilt=0.9)
Make = Callable[..., "Session"]


class Session:
    """A world and the number of the next step."""

    def __init__(self, things: list[TrueBody], **options: Any) -> None:
        defaults = {"world_T_base": START, "torso": 0.2, "noise": EXACT, "seed": 0}
        self.world = PyBulletWorld(TYPES, things, **{**defaults, **options})
        self.step = 0

    def do(self, command: Command) -> tuple[ActionResult, Observation]:
        result, observation = self.world.execute(Action(step=self.step, op="test", args=(), command=command))
        assert result.step == observation.step == self.step
        self.step += 1
        return result, observation

    def thing(self, name: str = "can1") -> TrueObject:
        return next(thing for thing in self.world.state(self.step).objects if thing.id == name)

    def pick(self, base_T_object: Pose4 = CAN) -> Pick:
        return pick_at(self.world.robot_state(), base_T_object)


@pytest.fixture
def make() -> Iterator[Make]:
    """Return a function that builds a world, closed after the test."""
    made: list[Session] = []

    def build(things: list[TrueBody] | None = None, **options: Any) -> Session:
        made.append(Session(near_table(can()) if things is None else things, **options))
        return made[-1]

    yield build
    for session in made:
        session.world.close()


# ---------------------------------------------------------------- picking


def test_a_pick_lifts_the_can_and_reports_where_the_hand_closed(make: Make) -> None:
    session = make()
    pick = session.pick()
    result, observation = session.do(pick)
    held = session.thing()
    assert (result.status, observation.kind, held.in_hand, held.on) == ("done", "none", "right", None)
    assert held.world_T_object[2] == pytest.approx(TABLE_M + 0.12, abs=0.005)
    assert result.gripper_gap_m == pytest.approx(0.066, abs=0.002)
    assert result.base_T_tool is not None
    assert compose4(result.base_T_tool, pick.tool_T_object)[:3] == pytest.approx(CAN[:3], abs=0.003)


def test_the_encoders_say_that_the_arm_is_at_the_end_of_its_path(make: Make) -> None:
    session = make()
    pick = session.pick().model_copy(update={"carry": (CARRY["right"],)})
    result, _ = session.do(pick)
    assert result.robot.right_arm == pytest.approx(CARRY["right"])
    assert result.robot.left_arm == pytest.approx(CARRY["left"], abs=1e-3)


def test_a_can_off_to_one_side_is_centred_by_the_fingers(make: Make) -> None:
    session = make(near_table(can(y=-0.208)))
    session.do(session.pick())
    assert session.thing().in_hand == "right"
    assert session.thing().world_T_object[1] == pytest.approx(-0.2, abs=SOLVER_M)


@pytest.mark.parametrize("gone", [(0.9, 0.3), (0.6, -0.30)], ids=["far", "beside"])
def test_a_pick_of_nothing_fails_and_the_arm_goes_back(make: Make, gone: tuple[float, float]) -> None:
    session = make(near_table(can(*gone)))
    before = session.thing().world_T_object
    result, _ = session.do(session.pick())
    assert result.status == "failed"
    assert result.gripper_gap_m is not None
    assert result.gripper_gap_m < 0.01
    assert result.robot.right_arm == pytest.approx(CARRY["right"], abs=1e-6)
    assert session.thing().in_hand is None
    assert session.thing().world_T_object[:3] == pytest.approx(before[:3], abs=SOLVER_M)


def test_a_can_in_the_way_of_a_finger_is_pushed_and_not_grasped(make: Make) -> None:
    session = make(near_table(can(y=-0.245)))
    before = session.world.state(0)
    result, _ = session.do(session.pick())
    assert result.status == "failed"
    (pushed,) = displaced(before, session.world.state(1))
    assert (pushed.id, pushed.distance_m > 0.01) == (session.thing().id, True)


def test_an_arm_that_meets_something_unforeseen_goes_back(make: Make) -> None:
    wall = TrueBody("wall", "bottle", (0.42, -0.35, 0.8, 0.0), RED, 0.5)
    session = make(near_table(can()))
    pick, start = session.pick(), session.world.robot_state().right_arm
    midway = np.add(start, pick.approach[0]) / 2.0
    blocked = make([*near_table(can()), wall])
    blocked.world.disturb("wall", _where_the_hand_is(make, midway.tolist()))
    result, _ = blocked.do(pick)
    assert (result.status, result.robot.right_arm, result.base_T_tool) == ("failed", start, None)


def test_what_is_in_the_way_of_the_carried_arm_is_pushed_aside(make: Make) -> None:
    session = make([*near_table(can()), TrueBody("bottle1", "bottle", (1.1, 0.4, TABLE_M, 0.0), RED, 0.2)])
    session.do(session.pick())
    lifted = session.world.robot_state().right_arm
    midway = np.add(lifted, CARRY["right"]) / 2.0
    in_the_way = _where_the_hand_is(make, midway.tolist())
    session.world.disturb("bottle1", in_the_way)
    carry = Pick(hand="left", approach=(), reach=(), lift=(), carry=(), tool_T_object=(0.0, 0.0, 0.0, 0.0))
    assert session.do(carry)[0].status == "failed"
    place = Place(hand="right", approach=(), lower=(), retreat=(), carry=(CARRY["right"],))
    result, _ = session.do(place)
    assert result.robot.right_arm == pytest.approx(CARRY["right"], abs=0.02)
    assert math.dist(session.thing("bottle1").world_T_object[:3], in_the_way[:3]) > 0.05


def test_the_physics_leaves_base_torso_and_the_other_arm_alone(make: Make) -> None:
    session = make()
    before = session.world.robot_state()
    session.do(session.pick())
    after = session.world.robot_state()
    assert session.world.state(1).world_T_base == pytest.approx(START, abs=1e-6)
    assert after.torso == pytest.approx(before.torso, abs=1e-6)
    assert after.left_arm == pytest.approx(before.left_arm, abs=1e-6)


def _where_the_hand_is(make: Make, joints: list[float]) -> Pose4:
    """Return a place for a bottle in the middle of the right hand of an arm configuration."""
    probe = make()
    a, b, c, d, e, f, g = joints
    still = Place(hand="right", approach=(), lower=(), retreat=(), carry=())
    path = Pick(
        hand="right", approach=((a, b, c, d, e, f, g),), reach=(), lift=(), carry=(), tool_T_object=(0.0, 0.0, 0.0, 0.0)
    )
    assert probe.do(still)[0].status == "failed"
    result, _ = probe.do(path)
    assert result.base_T_tool is not None
    x, y, z, theta = result.base_T_tool
    return (x, y, z - 0.1, theta)


# ---------------------------------------------------------------- placing


def test_a_can_put_down_stands_where_it_stood(make: Make) -> None:
    session = make()
    pick = session.pick()
    session.do(pick)
    result, _ = session.do(put_back(pick))
    placed = session.thing()
    assert (result.status, placed.in_hand, placed.on) == ("done", None, "table1")
    assert placed.world_T_object[:3] == pytest.approx(CAN[:3], abs=2.0 * SOLVER_M)
    assert result.gripper_gap_m == pytest.approx(0.083, abs=0.003)
    assert result.base_T_tool is not None


def test_lowering_ends_where_the_can_meets_the_table(make: Make) -> None:
    session = make()
    pick = session.pick()
    session.do(pick)
    too_deep = pick_at(session.world.robot_state(), (0.6, -0.2, TABLE_M - 0.04, 0.0)).reach[-1]
    place = put_back(pick)
    result, _ = session.do(place.model_copy(update={"lower": (*place.lower, too_deep)}))
    assert result.base_T_tool is not None
    assert result.base_T_tool[2] == pytest.approx(TABLE_M + 0.065, abs=0.005)
    assert session.thing().on == "table1"


def test_a_can_let_go_above_the_table_falls_onto_it(make: Make) -> None:
    session = make()
    pick = session.pick()
    session.do(pick)
    session.do(Place(hand="right", approach=(), lower=(), retreat=(), carry=()))
    assert session.thing().in_hand is None
    assert session.thing().world_T_object[2] < TABLE_M + 0.03


def test_a_can_can_be_picked_again_after_it_was_put_down(make: Make) -> None:
    session = make()
    pick = session.pick()
    session.do(pick)
    session.do(put_back(pick).model_copy(update={"carry": (CARRY["right"],)}))
    assert session.do(session.pick())[0].status == "done"


# ---------------------------------------------------------------- weighing


@pytest.mark.parametrize("kg", [0.1, 0.35, 0.8])
def test_the_wrist_feels_the_weight_of_what_is_held(make: Make, kg: float) -> None:
    session = make(near_table(TrueBody("can1", "soda", CAN, GREEN, kg)))
    session.do(session.pick())
    _, observation = session.do(Weigh(hand="right"))
    assert observation.wrench is not None
    assert observation.wrench.force_newton == pytest.approx((0.0, 0.0, -9.81 * kg), abs=0.02)


def test_an_empty_hand_weighs_nothing(make: Make) -> None:
    _, observation = make().do(Weigh(hand="right"))
    assert observation.wrench is not None
    assert observation.wrench.force_newton == pytest.approx((0.0, 0.0, 0.0), abs=0.02)


def test_the_reading_carries_noise_and_the_bias_of_the_run(make: Make) -> None:
    session = make(noise=EXACT.model_copy(update={"wrist_sd_newton": 0.01, "wrist_drift_newton": 1.0}))
    wrenches = [session.do(Weigh(hand="right"))[1].wrench for _ in range(2)]
    first, second = (np.array(wrench.force_newton) for wrench in wrenches if wrench is not None)
    assert 0.0 < np.abs(first - second).max() < 0.1
    assert np.abs(first).max() > 0.2


def test_only_the_right_wrist_has_a_sensor(make: Make) -> None:
    result, observation = make().do(Weigh(hand="left"))
    assert (result.status, observation.kind, observation.wrench) == ("failed", "none", None)


# ---------------------------------------------------------------- what cannot be done


def test_a_full_hand_picks_nothing_and_keeps_what_it_holds(make: Make) -> None:
    session = make(near_table(can(), can(0.6, 0.1, "can2")))
    pick = session.pick()
    session.do(pick)
    assert session.do(pick)[0].status == "failed"
    assert session.thing().in_hand == "right"


def test_an_empty_hand_places_nothing(make: Make) -> None:
    result, _ = make().do(Place(hand="left", approach=(), lower=(), retreat=(), carry=()))
    assert (result.status, result.base_T_tool is None) == ("failed", False)


# ---------------------------------------------------------------- driving


def test_a_drive_ends_where_it_was_told_if_wheels_are_exact(make: Make) -> None:
    session = make(world_T_base=(-0.5, 0.2, 0.3))
    waypoints = ((0.1, 0.0, 0.2), (0.1, -0.3, -0.4))
    result, _ = session.do(MoveBase(start_T_waypoint=waypoints))
    assert result.status == "done"
    assert result.odometry == pytest.approx(waypoints[-1])
    assert session.world.state(1).world_T_base == pytest.approx(compose2((-0.5, 0.2, 0.3), waypoints[-1]))


def test_wheels_report_the_command_and_the_truth_is_off(make: Make) -> None:
    noise = EXACT.model_copy(update={"odometry_sd_m": 0.03, "odometry_sd_rad": 0.03})
    session = make(world_T_base=(-1.0, 0.0, 0.0), noise=noise)
    result, _ = session.do(MoveBase(start_T_waypoint=((0.5, 0.0, 0.0),)))
    assert result.odometry == pytest.approx((0.5, 0.0, 0.0))
    assert 0.002 < math.dist(session.world.state(1).world_T_base, (-0.5, 0.0, 0.0)) < 0.15


def test_a_drive_stops_before_a_table_and_says_how_far_it_came(make: Make) -> None:
    session = make(world_T_base=(-0.6, 0.0, 0.0))
    result, _ = session.do(MoveBase(start_T_waypoint=((1.5, 0.0, 0.0),)))
    truly_at = session.world.state(1).world_T_base
    assert result.status == "stopped_early"
    assert result.odometry == pytest.approx((truly_at[0] + 0.6, 0.0, 0.0))
    assert 0.1 < truly_at[0] + 0.6 < 1.4
    back, _ = session.do(MoveBase(start_T_waypoint=((-0.3, 0.0, 0.0),)))
    assert back.status == "done"


def test_what_is_held_goes_along_with_the_base(make: Make) -> None:
    session = make()
    session.do(session.pick())
    before = session.thing().world_T_object
    base_T_object = compose4(inverse4(raised(session.world.state(1).world_T_base)), before)
    session.do(MoveBase(start_T_waypoint=((-0.3, 0.0, 0.0), (-0.3, 0.0, 0.4), (-0.3, 0.0, 0.8))))
    after = compose4(inverse4(raised(session.world.state(2).world_T_base)), session.thing().world_T_object)
    assert after == pytest.approx(base_T_object, abs=CONSTRAINT_SLACK)


def test_a_drive_along_no_waypoint_goes_nowhere(make: Make) -> None:
    result, _ = make(noise=EXACT.model_copy(update={"odometry_sd_m": 1.0})).do(MoveBase(start_T_waypoint=()))
    assert (result.status, result.odometry) == ("done", START)


# ---------------------------------------------------------------- looking


def test_a_look_reports_what_stands_there(make: Make) -> None:
    session = make(near_table(can(0.8, -0.2), TrueBody("box1", "carton", (0.8, 0.1, TABLE_M, 0.5), BLUE, 0.4)))
    result, observation = session.do(LookAt(pan=0.0, tilt=0.8))
    box, soda, table = observation.detections  # in the order of their types
    assert (result.status, observation.kind) == ("done", "look")
    assert soda.base_T_object == pytest.approx((0.8, -0.2, TABLE_M, 0.0), abs=0.005)
    assert box.base_T_object == pytest.approx((0.8, 0.1, TABLE_M, 0.5), abs=0.03)
    assert table.base_T_object == pytest.approx((0.85, 0.0, 0.0, 0.0), abs=0.01)
    assert soda.rgb[1] > 3.0 * soda.rgb[0]


def test_detections_are_seen_from_the_base_wherever_it_stands(make: Make) -> None:
    base: Pose2 = (-0.2, 0.1, -0.2)
    session = make(near_table(can(0.8, -0.2)), world_T_base=base)
    soda, table = (compose4(raised(base), d.base_T_object) for d in session.do(LookAt(pan=0.0, tilt=0.8))[1].detections)
    assert soda[:3] == pytest.approx((0.8, -0.2, TABLE_M), abs=0.005)
    assert table == pytest.approx((0.85, 0.0, 0.0, 0.0), abs=0.01)


def test_the_view_puts_its_readings_on_table_and_floor(make: Make) -> None:
    view = make(near_table()).do(LookAt(pan=0.0, tilt=0.8))[1].view
    assert view is not None
    depth = np.reshape(view.depth_mm, (view.rows, view.columns, 1)) / 1000.0
    axes = Rotation.from_quat(view.base_T_camera[3:]).as_matrix()
    points = (pixel_rays(view.columns, view.rows) * depth) @ axes.T + view.base_T_camera[:3]
    seen = points[depth[..., 0] > 0.0]
    level = (np.abs(seen[:, 2]) < 0.005) | (np.abs(seen[:, 2] - TABLE_M) < 0.005)
    assert level.mean() > 0.85  # the rest: the table's edge and legs, and what is far away


def test_neither_the_arm_nor_what_it_holds_is_reported_and_they_are_no_edges_of_the_table(make: Make) -> None:
    session = make()
    session.do(session.pick())
    _, observation = session.do(DOWN)
    assert observation.view is not None
    (table,) = observation.detections
    assert table.base_T_object == pytest.approx((0.85, 0.0, 0.0, 0.0), abs=0.01)


def test_equal_steps_see_equally_and_other_steps_do_not(make: Make) -> None:
    noise = EXACT.model_copy(update={"extrinsics_sd_m": 0.01})
    first, second = (make(near_table(can(0.8, -0.2)), noise=noise) for _ in range(2))
    one, two = ([session.do(LookAt(pan=0.0, tilt=0.8))[1] for _ in range(2)] for session in (first, second))
    assert one == two
    assert one[0].detections != one[1].detections


# ---------------------------------------------------------------- recording, truth, determinism


def recorded(make: Make, images: bool) -> tuple[Session, list[tuple[str, Any]]]:
    messages: list[tuple[str, Any]] = []
    session = make(recorder=lambda topic, message: messages.append((topic, message)), images=images)
    session.do(MoveBase(start_T_waypoint=((-0.4, 0.0, 0.0),)))
    session.do(DOWN)
    return session, messages


def test_joints_and_frames_are_recorded_ten_times_a_second(make: Make) -> None:
    session, messages = recorded(make, images=False)
    ticks = [round(240 * (m.timestamp.seconds + 1e-9 * m.timestamp.nanos)) for t, m in messages if "joint" in t]
    assert ticks == list(range(0, session.world.tick + 1, RECORD_TICKS))
    assert {topic for topic, _ in messages} == {"/robot/joint_states", "/tf"}
    frames = {frame.child_frame_id for frame in messages[-1][1].transforms}
    assert frames == {"base_footprint", "camera", "truth/can1", "truth/table1"}


def test_pictures_are_recorded_only_when_asked_for(make: Make) -> None:
    _, messages = recorded(make, images=True)
    pictures = [(topic, message) for topic, message in messages if topic.startswith("/camera/")]
    assert [topic for topic, _ in pictures] == ["/camera/rgb", "/camera/depth", "/camera/info"]
    assert pictures[0][1].data.startswith(b"\x89PNG")


def test_the_clock_moves_with_the_motion(make: Make) -> None:
    session = make()
    session.do(MoveBase(start_T_waypoint=((-0.4, 0.0, 0.0),)))
    assert session.world.tick == pytest.approx(240, abs=12)  # 0.4 m at 0.4 m/s


def test_a_disturbed_thing_stands_where_it_was_put(make: Make) -> None:
    session = make()
    session.world.disturb("can1", (0.9, 0.3, TABLE_M, 0.0))
    assert session.thing().world_T_object == pytest.approx((0.9, 0.3, TABLE_M, 0.0))
    assert session.thing().on == "table1"


def test_a_disturbance_takes_a_thing_out_of_the_hand(make: Make) -> None:
    session = make()
    session.do(session.pick())
    held, _ = session.do(MoveBase(start_T_waypoint=((-0.05, 0.0, 0.0),)))
    assert max(held.gaps_m.values()) > 0.06
    session.world.disturb("can1", (0.9, 0.3, TABLE_M, 0.0))
    empty, _ = session.do(MoveBase(start_T_waypoint=((-0.15, 0.0, 0.0),)))
    assert min(empty.gaps_m.values()) < 0.005
    assert session.thing().world_T_object == pytest.approx((0.9, 0.3, TABLE_M, 0.0), abs=0.005)
    assert (session.thing().on, session.thing().in_hand) == ("table1", None)


def script(noise: NoiseModel = EXACT) -> str:
    """Run a pick, a look, a weighing and a drive; return the hash of the world and of all that was reported."""
    session = Session(near_table(can(), can(0.7, 0.2, "can2")), noise=noise)
    pick = session.pick()
    reports = [session.do(c) for c in (pick, DOWN, Weigh(hand="right"), MoveBase(start_T_waypoint=((-0.2, 0.1, 0.2),)))]
    text = "".join(message.canonical().decode() for report in reports for message in report)
    digest = session.world.state(session.step).sha256
    session.world.close()
    return digest + text


def test_two_processes_live_through_the_same() -> None:
    code = "import test_pybullet_world as t; import sys; sys.stdout.write(t.script())"
    here = Path(__file__).parent
    runs = [
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            check=True,
            cwd=here,
            env=os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(TESTS)},
        ).stdout
        for seed in ("1", "2")
    ]
    assert runs[0] == runs[1]
    assert len(runs[0]) > 64
