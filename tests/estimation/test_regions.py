import math

import numpy as np
import pytest
from kit.searches import (
    BACK,
    BACKWARD,
    FRONT,
    GREEN_RGB,
    LEFT,
    MIDDLE,
    NOISE,
    REGION,
    RIGHT,
    ROBOT,
    TOP,
    TYPES,
    Searcher,
    detection,
    table_prior,
    thing,
)
from kit.tabletop import looking

from skolem.estimation.arm import base_T_tool
from skolem.estimation.belief import Belief
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import EVENT, Gone
from skolem.sim.symbolic.view import Solid, depth_view
from skolem.traces.errors import InputError, InternalError
from skolem.traces.messages import HsvVolume, Pose4, PriorRegion, RobotState, TypeIs, WeightInterval

GREEN = HsvVolume(hue=(0.25, 0.42), saturation=(0.3, 1.0), value=(0.2, 1.0))
CANS: list[tuple[str, Pose4]] = [("soda", (0.95, 0.2, TOP, 0.0)), ("bottle", (1.15, -0.25, TOP, 0.0))]
SCREEN: Pose4 = (1.1, 0.0, TOP, 0.0)


def behind_a_screen() -> Searcher:
    """The robot knows of the screen that stands across the middle of the table."""
    return Searcher(table_prior(objects=[thing("screen1", "screen", SCREEN)]), [("screen", SCREEN)])


# ---------------------------------------------------------------- seen and unseen


def test_region_is_unseen_before_the_first_look() -> None:
    belief = Belief(table_prior())
    assert belief.regions() == (REGION,)
    assert belief.region_support(REGION) == "table1"
    assert belief.prob_contents(REGION) == 0.0
    assert belief.prob_exists_in(REGION, 1.0) == pytest.approx(1.0 - math.exp(-0.5))
    assert belief.prob_exists_in(REGION, 0.3) == pytest.approx(1.0 - math.exp(-0.15))
    assert belief.prob_exists_in(REGION, 0.0) == 0.0


def test_table_with_things_on_it_is_known_after_looks_from_two_sides() -> None:
    robot = Searcher(table_prior(), CANS)
    robot.look(FRONT)
    once = robot.belief.prob_contents(REGION)
    robot.look(LEFT)
    assert 0.5 < once < robot.belief.prob_contents(REGION)
    assert robot.belief.prob_contents(REGION) > 0.98
    assert robot.belief.prob_exists_in(REGION, 1.0) < 0.01
    assert robot.belief.anchors() == ("table1", "_o1_", "_o2_")


def test_inside_of_known_things_does_not_count_as_unseen() -> None:
    met, unmet = Searcher(table_prior(), CANS), Searcher(table_prior(), CANS)
    for eye in (FRONT, LEFT, BACK, RIGHT):
        met.look(eye)
        unmet.look(eye, found=False)
    assert unmet.belief.prob_contents(REGION) < met.belief.prob_contents(REGION) == 1.0


def test_shadow_behind_a_thing_stays_unseen_until_it_is_looked_at_from_elsewhere() -> None:
    robot = behind_a_screen()
    for _ in range(3):
        robot.look(FRONT)
    seen, exists = robot.belief.prob_contents(REGION), robot.belief.prob_exists_in(REGION, 1.0)
    assert seen < 0.9
    assert 0.03 < exists < 0.4
    for x, y, z in robot.belief.snapshot(0).regions[REGION].unseen_mm:
        assert x > 0 or abs(y) > 240 or z > 200  # behind the screen or outside of the picture
    robot.look(BACK)
    assert robot.belief.prob_contents(REGION) > max(seen, 0.95)
    assert robot.belief.prob_exists_in(REGION, 1.0) < exists / 10.0


def test_looks_never_lower_what_is_known_nor_raise_what_may_be_hidden() -> None:
    robot = behind_a_screen()
    seen, exists = [0.0], [1.0]
    looks = ((FRONT, 0.4), (FRONT, -0.4), (RIGHT, 0.0), (LEFT, 0.0), (BACK, 0.0), (FRONT, 0.4))
    for eye, at in looks:
        robot.look(eye, (1.1, at, TOP))
        seen.append(robot.belief.prob_contents(REGION))
        exists.append(robot.belief.prob_exists_in(REGION, 0.5))
    assert seen == sorted(seen)
    assert exists == sorted(exists, reverse=True)
    assert seen[1] < seen[2] < seen[3] == seen[4]


def test_contents_are_unknown_while_a_thing_could_stand_anywhere_below_what_was_seen() -> None:
    robot = Searcher(table_prior())
    frame = looking((0.1, 0.0, TOP + 0.12), (1.1, 0.0, TOP + 0.12))
    view = depth_view(frame, [], frame)
    half = len(view.depth_mm) // 2
    wall_above_the_horizon = (4000,) * half + (0,) * half
    robot.report(view.model_copy(update={"depth_mm": wall_above_the_horizon}))
    believed = robot.belief.snapshot(0).regions[REGION]
    assert max(z for x, y, z in believed.unseen_mm if abs(x) < 100 and abs(y) < 100) < 150  # half of the air is known
    assert believed.hidden == 1.0
    assert robot.belief.prob_contents(REGION) == 0.0


@pytest.mark.parametrize("depth_mm", [0, 300])
def test_pixels_without_return_and_what_the_own_arm_covers_prove_nothing(depth_mm: int) -> None:
    robot = Searcher(table_prior())
    frame = looking(FRONT, MIDDLE)
    view = depth_view(frame, robot.solids, frame)
    robot.report(view.model_copy(update={"depth_mm": (depth_mm,) * len(view.depth_mm)}))
    assert robot.belief.prob_contents(REGION) == 0.0
    covered = [d if i % view.columns < view.columns // 2 else depth_mm for i, d in enumerate(view.depth_mm)]
    robot.report(view.model_copy(update={"depth_mm": tuple(covered)}))
    half = robot.belief.prob_contents(REGION)
    robot.report(view)
    assert 0.3 < half < 0.6 < robot.belief.prob_contents(REGION)


def test_look_past_the_region_shows_nothing_of_it() -> None:
    robot = Searcher(table_prior())
    robot.look(FRONT, (0.2, 3.0, TOP))
    assert robot.belief.prob_contents(REGION) == 0.0


def test_what_is_too_far_for_the_detector_stays_unseen() -> None:
    robot = Searcher(table_prior())
    robot.look((-2.0, 0.0, 1.5))
    assert robot.belief.prob_contents(REGION) == 0.0


def test_region_stands_on_its_support_wherever_that_is() -> None:
    table: Pose4 = (1.2, 0.3, 0.0, 0.7)
    robot = Searcher(table_prior(table), table=table)
    at = (1.2, 0.3, TOP)
    robot.look((0.3, -0.4, 1.5), at)
    robot.look((2.0, 1.1, 1.5), at)
    assert robot.belief.prob_contents(REGION) > 0.95


def test_known_thing_off_the_region_fills_nothing_in_it() -> None:
    aside = thing("screen1", "screen", (1.1, 1.5, 0.0, 0.0), support=None)
    alone, beside = Searcher(table_prior()), Searcher(table_prior(objects=[aside]))
    for robot in (alone, beside):
        robot.look(FRONT)
    assert alone.belief.prob_contents(REGION) == beside.belief.prob_contents(REGION)


def test_regions_are_searched_each_on_its_own() -> None:
    far = thing("table2", "table", (1.1, 3.0, 0.0, 0.0), support=None)
    regions = [
        PriorRegion(anchor="_reg1_", support="table1", height_m=0.3, expected_objects=0.5),
        PriorRegion(anchor="_reg2_", support="table2", height_m=0.3, expected_objects=0.2),
    ]
    robot = Searcher(table_prior(objects=[far], regions=regions))
    robot.look(FRONT)
    assert robot.belief.regions() == ("_reg1_", "_reg2_")
    assert robot.belief.region_support("_reg2_") == "table2"
    assert robot.belief.prob_contents("_reg1_") > 0.5
    assert robot.belief.prob_contents("_reg2_") == 0.0
    assert robot.belief.prob_exists_in("_reg2_", 1.0) == pytest.approx(1.0 - math.exp(-0.2))


def test_unknown_region_is_named_with_the_known_ones() -> None:
    with pytest.raises(InternalError, match="no region '_reg9_'; there are: _reg1_"):
        Belief(table_prior()).prob_contents("_reg9_")


# ---------------------------------------------------------------- free space and existence


def test_c21_space_seen_empty_lowers_exists_in_and_the_existence_of_what_was_believed_there() -> None:
    robot = Searcher(table_prior(objects=[thing("rumour", "soda", (1.1, 0.0, TOP, 0.0), sd_m=0.02)]))
    exists, hidden = [robot.belief.prob_exists("rumour")], [robot.belief.prob_exists_in(REGION, 0.5)]
    for eye in (FRONT, LEFT, RIGHT):
        robot.look(eye)
        exists.append(robot.belief.prob_exists("rumour"))
        hidden.append(robot.belief.prob_exists_in(REGION, 0.5))
    assert exists == sorted(exists, reverse=True)
    assert exists[-1] < 0.1
    assert hidden[-1] == 0.0 < hidden[0]
    while exists[-1] >= EstimatorConfig().listed:
        assert "rumour" in robot.belief.anchors()
        robot.look(FRONT)
        exists.append(robot.belief.prob_exists("rumour"))
    assert "rumour" not in robot.belief.anchors()


# ---------------------------------------------------------------- what the detector overlooks


def test_overlooked_thing_leaves_the_contents_unknown_until_it_is_reported() -> None:
    robot = Searcher(table_prior(), CANS[:1])
    robot.look(FRONT, found=False)
    other = EstimatorConfig().other_solids
    again = 0.5 * 0.1 / (0.5 * 0.1 + other)  # P(it is of a known type | overlooked once)
    assert robot.belief.prob_contents(REGION) < 1.0 - again
    assert robot.belief.prob_exists_in(REGION, 0.5) > 0.5 * again
    assert robot.belief.prob_exists_in(REGION, 0.0) == 0.0
    robot.look(FRONT)
    assert robot.belief.anchors() == ("table1", "_o1_")
    assert robot.belief.prob_contents(REGION) > 0.9
    assert robot.belief.prob_exists_in(REGION, 0.5) < 0.02


def test_thing_that_is_never_reported_is_none_of_those_looked_for() -> None:
    robot = Searcher(table_prior(), CANS[:1])
    contents = []
    for eye in (FRONT, LEFT, RIGHT, BACK):
        robot.look(eye, found=False)
        contents.append(robot.belief.prob_contents(REGION))
    assert contents == sorted(contents)
    assert contents[1] < 0.95 < contents[2]


def test_thing_that_was_taken_away_puzzles_no_more() -> None:
    robot = Searcher(table_prior(), CANS[:1])
    robot.look(FRONT, found=False)
    robot.solids.pop()
    robot.look(FRONT)
    assert robot.belief.prob_contents(REGION) > 0.9


@pytest.mark.parametrize(("told", "looks"), [(True, 0), (True, 1), (False, 1), (False, 2)])
def test_thing_that_was_there_for_sure_and_is_gone_may_be_wherever_nothing_was_before(told: bool, looks: int) -> None:
    other: Pose4 = (1.1, 3.0, 0.0, 0.0)
    regions = [
        PriorRegion(anchor=name, support=support, height_m=0.3, expected_objects=0.5)
        for name, support in (("_reg1_", "table1"), ("_reg2_", "table2"))
    ]
    known = [thing("table2", "table", other, support=None)]
    known += [thing("can1", "soda", CANS[0][1], sd_m=0.02)] if told else []
    name = "can1" if told else "_o1_"
    robot = Searcher(table_prior(objects=known, regions=regions), CANS[:1])
    robot.solids.append(Solid("table2", TYPES["table"], other))
    robot.look((0.1, 3.0, 1.5), (1.1, 3.0, TOP))
    empty = robot.belief.prob_contents("_reg2_")
    for _ in range(looks):
        robot.look(FRONT)
    surest = robot.belief.prob_exists(name)
    del robot.solids[1]
    while name in robot.belief.anchors():
        assert robot.belief.prob_contents("_reg2_") == empty > 0.5
        robot.look(FRONT)
    certain = surest >= EstimatorConfig().sure
    assert robot.belief.prob_contents("_reg2_") == (0.0 if certain else empty)
    assert robot.belief.prob_contents("_reg1_") > 0.5  # as the look shows that found it gone
    assert [event.anchor for event in robot.belief.events if isinstance(event, Gone)] == [name] * certain


@pytest.mark.parametrize("listed", [True, False])
def test_things_believed_to_be_there_puzzle_nobody(listed: bool) -> None:
    objects = [thing("can1", "soda", CANS[0][1], sd_m=0.02)] if listed else []
    robot = Searcher(table_prior(objects=objects), CANS[:1])
    robot.look(FRONT, found=False)
    assert (robot.belief.prob_contents(REGION) > 0.9) is listed


def test_own_arm_over_a_region_puzzles_nobody() -> None:
    ahead = RobotState(torso=0.1, right_arm=(0.3, *(0.0,) * 6), left_arm=BACKWARD)  # its hand is over the table
    hand = base_T_tool(ahead, "right")[:3, 3]
    arm = Solid("arm", TYPES["soda"], (float(hand[0]) - 0.05, float(hand[1]), float(hand[2]) - 0.05, 0.0))
    frame = looking(FRONT, MIDDLE)
    contents = []
    for state in (ahead, ROBOT):
        robot = Searcher(table_prior())
        robot.report(depth_view(frame, [*robot.solids, arm], frame), robot=state)
        contents.append(robot.belief.prob_contents(REGION))
    assert contents[0] > 0.85 > 0.6 > contents[1]


def test_known_thing_is_hardly_doubted_where_the_picture_shows_it() -> None:
    shown, gone = Searcher(table_prior(), CANS[:1]), Searcher(table_prior(), CANS[:1])
    for robot in (shown, gone):
        robot.look(FRONT)
    gone.solids.pop()
    met = shown.belief.prob_exists("_o1_")
    for robot in (shown, gone):
        robot.look(FRONT, found=False)
    doubted = shown.belief.prob_exists("_o1_")
    assert gone.belief.prob_exists("_o1_") < 0.95 < 0.98 < doubted <= met
    shown.look(FRONT, found=False)
    assert shown.belief.prob_exists("_o1_") < 0.95  # that something stands there was known already


def test_what_the_picture_shows_counts_anew_once_the_thing_was_reported_again() -> None:
    robot, doubted = Searcher(table_prior(), CANS[:1]), []
    for _ in range(3):
        for found in (True, True, False):
            robot.look(FRONT, found=found)
        doubted.append(robot.belief.prob_exists("_o1_"))
    assert doubted == pytest.approx([doubted[0]] * 3, abs=0.001)
    robot.look(FRONT, found=False)
    assert robot.belief.prob_exists("_o1_") > 0.5  # overlooked twice running, of eleven looks


# ---------------------------------------------------------------- objects nobody has met


def test_arbitrary_object_is_as_the_prior_says() -> None:
    belief = Belief(table_prior(types={"soda": 0.7, "bottle": 0.3}))
    assert belief.prob_property_of_new(TypeIs(type="soda")) == pytest.approx(0.7)
    assert belief.prob_property_of_new(TypeIs(type="table")) == 0.0
    assert belief.prob_property_of_new(WeightInterval(at_least_kg=0.3)) == pytest.approx(0.5)
    assert 0.05 < belief.prob_property_of_new(GREEN) < 0.25
    assert Belief(table_prior()).prob_property_of_new(TypeIs(type="soda")) == pytest.approx(0.5)


def test_new_anchor_starts_from_that_prior() -> None:
    robot = Searcher(table_prior(types={"soda": 0.25, "bottle": 0.75}), CANS[:1])
    robot.look(FRONT)
    right, wrong = NOISE.type_right, 1.0 - NOISE.type_right
    soda = 0.25 * right / (0.25 * right + 0.75 * wrong)
    assert robot.belief.prob_property("_o1_", TypeIs(type="soda")) == pytest.approx(soda)
    heavy = WeightInterval(at_least_kg=0.4)
    assert robot.belief.prob_property("_o1_", heavy) == robot.belief.prob_property_of_new(heavy)
    met = robot.belief.snapshot(1).objects["_o1_"]
    assert met.log_weight == pytest.approx((math.log(0.3), 0.36))
    assert met.colour_seen
    assert robot.belief.prob_property("_o1_", GREEN) > 0.9


def test_detection_in_unseen_space_is_believed_and_one_in_space_seen_empty_is_not() -> None:
    robot = Searcher(table_prior(), CANS[:1])
    robot.look(FRONT)
    unmet = 0.5 / (0.6 * 1.0) + 0.05  # per square metre of table, and anywhere
    false = NOISE.false_per_look * EstimatorConfig().coincidence  # the picture shows something there
    assert robot.belief.prob_exists("_o1_") == pytest.approx(min(unmet / (unmet + false), 0.99), rel=1e-6)
    assert robot.belief.anchors() == ("table1", "_o1_")
    frame = looking(FRONT, MIDDLE)
    ghost = detection(Solid("ghost", TYPES["soda"], (1.0, -0.1, TOP, 0.0)))
    robot.report(depth_view(frame, robot.solids, frame), [detection(robot.solids[1]), ghost])
    false = NOISE.false_per_look * EstimatorConfig().refuted  # the picture shows the table there
    assert robot.belief.prob_exists("_o2_") == pytest.approx(0.05 / (0.05 + false))
    assert robot.belief.anchors() == ("table1", "_o1_")


def test_c22_what_is_found_becomes_an_anchor_at_once() -> None:
    robot = Searcher(table_prior(), CANS)
    assert robot.belief.anchors() == ("table1",)
    robot.look(FRONT)
    assert robot.belief.anchors() == ("table1", "_o1_", "_o2_")
    assert min(robot.belief.prob_on(name, "table1") for name in ("_o1_", "_o2_")) > 0.8
    assert robot.belief.prob_property("_o1_", GREEN) > 0.9
    assert robot.belief.snapshot(1).objects["_o1_"].colour.mean[0] == pytest.approx(1 / 3, abs=0.01)
    assert GREEN_RGB[1] > GREEN_RGB[0]


# ---------------------------------------------------------------- the snapshot and the log


def test_snapshot_tells_what_is_seen_hidden_and_where() -> None:
    robot = behind_a_screen()
    robot.look(FRONT)
    region = robot.belief.snapshot(1).regions[REGION]
    assert (region.support, region.height_m) == ("table1", 0.3)
    assert region.seen == robot.belief.prob_contents(REGION)
    assert -math.expm1(-0.5 * region.hidden) == pytest.approx(robot.belief.prob_exists_in(REGION, 1.0))
    points = np.array(region.unseen_mm)
    assert len(points) == 64
    assert len(np.unique(points, axis=0)) == 64
    assert (np.abs(points) <= (300, 500, 300)).all()
    assert (points[:, 2] > 0).all()


def test_wholly_seen_region_has_no_unseen_points() -> None:
    robot = Searcher(table_prior())
    for eye in (FRONT, LEFT, BACK, RIGHT):
        robot.look(eye)
    region = robot.belief.snapshot(4).regions[REGION]
    assert (region.seen, region.hidden, region.unseen_mm) == (1.0, 0.0, ())


def test_belief_rebuilt_from_its_events_has_seen_the_same() -> None:
    robot = behind_a_screen()
    robot.solids.append(Solid("can", TYPES["soda"], (0.95, 0.2, TOP, 0.0)))
    for eye in (FRONT, LEFT, RIGHT):
        robot.look(eye)
    text = [EVENT.dump_json(event) for event in robot.belief.events]
    again = Belief.from_events(EVENT.validate_json(line) for line in text)
    assert again.snapshot(3).canonical() == robot.belief.snapshot(3).canonical()
    assert again.prob_exists_in(REGION, 0.4) == robot.belief.prob_exists_in(REGION, 0.4)


# ---------------------------------------------------------------- what is refused


def test_every_fault_of_regions_is_reported_at_once() -> None:
    good = table_prior()
    region = good.regions[0]
    wrong = [
        region,
        region.model_copy(update={"anchor": "table1"}),
        region.model_copy(update={"anchor": "_reg2_", "support": "nowhere"}),
        region.model_copy(update={"anchor": "_reg3_", "support": "can"}),
        region.model_copy(update={"anchor": "_reg4_", "height_m": 0.0, "expected_objects": -1.0}),
    ]
    can = thing("can", "soda", (1.1, 0.0, TOP, 0.0))
    prior = good.model_copy(
        update={"objects": (*good.objects, can), "regions": (region, *wrong), "type": {"table": 0.0, "ghost": 0.0}}
    )
    with pytest.raises(InputError) as caught:
        Belief(prior)
    assert sorted(fault.at for fault in caught.value.faults) == [
        "regions.1.anchor",
        "regions.2.anchor",
        "regions.3.support",
        "regions.4.support",
        "regions.5.expected_objects",
        "regions.5.height_m",
        "type",
        "type",
        "type",
    ]
