"""What looks make of a belief: where things are, of what kind, and whether they exist."""

import math

import numpy as np
import pytest
from kit.beliefs import (
    CANS,
    GREEN,
    GREEN_RGB,
    NOISE,
    TABLE_TOP,
    Robot,
    depth_view,
    detection,
    pose_of,
    prior,
    sees_all,
    table_detection,
)
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.fluents import covariance_within
from skolem.estimation.se2 import between, compose, exp, inverse, log, symmetric
from skolem.traces.errors import InputError, InternalError
from skolem.traces.messages import (
    DepthView,
    PriorObject,
    TypeIs,
)

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
    robot.look([detection((0.9, 0.0, 0.0))], depth_view([(0.9, 0.0, 0.0)]))
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


def test_detection_is_believed_where_the_picture_shows_something_and_not_where_it_shows_the_table() -> None:
    shown, refuted = Robot(prior(cans={})), Robot(prior(cans={}))
    beyond_the_arms = (1.2, 0.0, 0.0)
    shown.look([detection(beyond_the_arms)], depth_view([beyond_the_arms]))
    refuted.look([detection(beyond_the_arms)], depth_view())
    assert shown.belief.prob_exists("_o1_") == pytest.approx(0.05 / (0.05 + 0.2 * EstimatorConfig().coincidence))
    assert refuted.belief.prob_exists("_o1_") < 0.01
    assert refuted.belief.anchors() == ("table1",)


def test_something_new_that_is_seen_again_is_an_object() -> None:
    robot = Robot(prior(cans={}))
    robot.look([detection((0.9, 0.1, 0.0))], depth_view([(0.9, 0.1, 0.0)]))
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


@pytest.mark.parametrize(("picture", "moved"), [(None, True), (depth_view([(0.86, 0.0, 0.0)]), False)])
def test_detection_over_what_the_picture_shows_bare_is_of_no_told_object(
    picture: DepthView | None, moved: bool
) -> None:
    robot = Robot(prior(cans={"can": (0.9, 0.0, 0.0)}, sd_m=0.03))
    robot.look([detection((0.9, 0.11, 0.0))], picture)
    assert (pose_of(robot, "can")[1] > 0.03) is moved
    assert (robot.belief.prob_exists("_o1_") > 0.0) is not moved
    assert robot.belief.anchors() == ("table1", "can")


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
    assert robot.belief.anchors() == ("table1", "can1", "can2", "can3", "_o1_")  # worth what it is believed to be
    assert pose_of(robot, "_o1_")[:2] == pytest.approx((0.75, 0.15), abs=0.01)
    for _ in range(4):
        sees_all(robot, moved)
    assert robot.belief.anchors() == ("table1", "can1", "can3", "_o1_")


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


def test_heading_of_a_box_believed_to_be_a_cylinder_says_nothing_of_where_the_base_is_turned() -> None:
    box, cylinder = (Robot(prior(base_sd=0.1, sd_m=0.01)) for _ in range(2))
    for robot, kind in ((box, "carton"), (cylinder, "soda")):
        robot.look([detection((*CANS["can2"][:2], 0.4), kind=kind)], depth_view([CANS["can2"]]))
    told, mistaken = (symmetric(r.belief.snapshot(1).base_covariance)[2, 2] for r in (cylinder, box))
    assert mistaken == pytest.approx(told, rel=0.02)


def test_belief_names_no_support_that_it_does_not_list() -> None:
    """A carton that was taken away carries nothing any more, though a can was told to stand on it."""
    carton = PriorObject(
        anchor="carton1",
        type={"carton": 1.0},
        world_T_object=(0.8, 0.4, TABLE_TOP, 0.0),
        sd_xy_m=0.01,
        sd_theta_rad=0.1,
        support="table1",
    )
    told = prior(cans={})
    can = carton.model_copy(update={"anchor": "can9", "type": {"soda": 1.0}, "support": "carton1"})
    can = can.model_copy(update={"world_T_object": (0.8, 0.4, TABLE_TOP + 0.14, 0.0)})
    robot = Robot(told.model_copy(update={"objects": (*told.objects, carton, can)}))
    assert robot.belief.snapshot(0).objects["can9"].support == "carton1"
    for _ in range(4):
        robot.look([], depth_view())
    seen = robot.belief.snapshot(4)
    assert "carton1" not in seen.anchors
    assert {item.support for item in seen.objects.values()} <= {None, *seen.anchors}
