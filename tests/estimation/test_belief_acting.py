"""What driving, picking, placing and weighing make of a belief."""

import math

import numpy as np
import pytest
from kit.beliefs import CANS, EXACT, GRASP, HEAVY, TABLE_TOP, TOOL, Robot, depth_view, detection, prior, sees_all
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.fluents import covariance_within
from skolem.estimation.se2 import between, compose, symmetric
from skolem.traces.messages import Hand, Pose2, Relation


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


@pytest.mark.parametrize("after", [100, 1], ids=["the whole past", "a past that is summed up"])
def test_where_an_object_was_before_its_first_pick_is_remembered(after: int) -> None:
    robot = Robot(prior(), EstimatorConfig(consolidate_after=after, remembers=True))
    sees_all(robot)
    on, near = robot.belief.prob_on("can2", "table1"), robot.belief.prob_near("can2", "can1", 0.6)
    assert robot.belief.prob_was_on("can2", "table1") == on
    assert robot.belief.prob_was_near("can2", "can1", 0.6) == near
    robot.pick("can2", TOOL, GRASP)
    robot.drive((0.5, 0.5, 0.5))
    assert robot.belief.prob_on("can2", "table1") == robot.belief.prob_near("can2", "can1", 0.6) == 0.0
    assert robot.belief.prob_was_on("can2", "table1") == pytest.approx(on, abs=0.02)
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0))
    robot.drive((0.1, 0.0, 0.0))
    assert robot.belief.prob_was_on("can2", "table1") == pytest.approx(on, abs=0.02)
    assert robot.belief.prob_was_near("can2", "can1", 0.6) == pytest.approx(near, abs=0.02)
    on_table = Relation(kind="on", anchors=("can2", "table1"))
    by_can1 = Relation(kind="near", anchors=("can2", "can1"), distance_m=0.6)
    kinds = [each.model_copy(update={"earlier": then}) for each in (on_table, by_can1) for then in (False, True)]
    draws = Generator(PCG64(SeedSequence([5]))).random((4000, robot.belief.relations(kinds).dimension))
    shares = robot.belief.relations(kinds).truth(draws).mean(axis=0)
    believed = [
        robot.belief.prob_on("can2", "table1"),
        robot.belief.prob_was_on("can2", "table1"),
        robot.belief.prob_near("can2", "can1", 0.6),
        robot.belief.prob_was_near("can2", "can1", 0.6),
    ]
    assert shares == pytest.approx(believed, abs=0.03)


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


def test_object_that_a_failed_place_dropped_is_near_there_and_on_nothing_until_it_is_seen() -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0), status="failed", gaps_m={"right": 0.066, "left": 0.086})
    assert robot.belief.held("right") is None
    assert 0.1 > np.sqrt(np.diag(robot.belief.gaussian("pose", "can2").covariance))[:2].min() > 0.04
    assert robot.belief.prob_on("can2", "table1") == 0.0
    robot.look([detection((0.85, 0.15, 0.0))], depth_view([(0.85, 0.15, 0.0)]))
    assert robot.belief.support("can2") == "table1"
    assert robot.belief.prob_on("can2", "table1") > 0.9


@pytest.mark.parametrize("off_m", [0.12, -0.1], ids=["stopped above", "nothing below"])
def test_object_released_far_above_or_below_the_top_is_not_believed_on_it_until_it_is_seen(off_m: float) -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (0.8, 0.1, 0.75 + off_m, 0.0), gaps_m={"right": 0.066, "left": 0.086})
    assert robot.belief.held("right") is None
    assert robot.belief.prob_on("can2", "table1") == 0.0
    assert 0.1 > np.sqrt(np.diag(robot.belief.gaussian("pose", "can2").covariance))[:2].min() > 0.04
    robot.look([detection((0.85, 0.15, 0.0))], depth_view([(0.85, 0.15, 0.0)]))
    assert robot.belief.prob_on("can2", "table1") > 0.9


@pytest.mark.parametrize("gaps_m", [{}, {"right": 0.0, "left": 0.086}])
def test_failed_place_shows_that_the_hand_was_empty_and_the_object_is_elsewhere(gaps_m: dict[Hand, float]) -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0), status="failed", gaps_m=gaps_m)
    assert robot.belief.held("right") is None
    assert robot.belief.prob_on("can2", "table1") < 0.9
    assert robot.belief.prob_exists("can2") == pytest.approx(0.99)
    assert np.sqrt(np.diag(robot.belief.gaussian("pose", "can2").covariance))[:2].max() > 0.2


def test_fingers_that_met_on_a_drive_have_lost_what_they_held() -> None:
    kept, lost = Robot(prior()), Robot(prior())
    for robot, gap in ((kept, 0.066), (lost, 0.0)):
        sees_all(robot)
        robot.pick("can2", TOOL, GRASP)
        robot.drive((0.0, 0.5, 0.0), gaps_m={"right": gap, "left": 0.086})
    assert kept.belief.held("right") == "can2"
    assert lost.belief.held("right") is None
    assert np.sqrt(np.diag(lost.belief.gaussian("pose", "can2").covariance))[:2].max() > 0.2


def test_object_lost_from_the_hand_is_known_again_once_it_is_seen() -> None:
    robot = Robot(prior())
    sees_all(robot)
    robot.pick("can2", TOOL, GRASP)
    robot.place("can2", "table1", (0.8, 0.1, 0.75, 0.0), status="failed")
    others = [CANS["can1"], CANS["can3"]]
    for _ in range(2):
        robot.look([detection(p) for p in (*others, (1.15, 0.0, 0.0))], depth_view([*others, (1.15, 0.0, 0.0)]))
    assert robot.belief.snapshot(9).objects["can2"].world_T_object[:2] == pytest.approx((1.15, 0.0), abs=0.02)
    assert robot.belief.prob_on("can2", "table1") > 0.9
    assert robot.belief.anchors() == ("table1", *CANS)


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
