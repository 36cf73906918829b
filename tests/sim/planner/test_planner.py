import dataclasses
import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from kit import believed_scenes as scenes

from skolem.sim.planner import trials
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.planner import PlanningWorld
from skolem.sim.space import grasps
from skolem.sim.space.activities import is_other_side
from skolem.traces.messages import (
    Activity,
    Belief,
    Command,
    Hand,
    Joints7,
    LookAt,
    MoveBase,
    ObjectBelief,
    ObjectType,
    Pick,
    Place,
    Pose2,
    Weigh,
)
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import compose2, compose4, flat, inverse2, inverse4

pytestmark = pytest.mark.physics

FINE_STEP = 0.02  # rad or m: paths were checked at 0.05


@pytest.fixture(scope="module")
def planner() -> Iterator[PlanningWorld]:
    planner = PlanningWorld(scenes.TYPES, seed=0)
    yield planner
    planner.close()


@pytest.fixture(scope="module")
def checker() -> Iterator[BelievedWorld]:
    checker = BelievedWorld(scenes.TYPES)
    yield checker
    checker.close()


def driven(start: Pose2, move: Command | None) -> Pose2:
    assert isinstance(move, MoveBase)
    return compose2(start, move.start_T_waypoint[-1])


def fine(path: tuple[Joints7, ...]) -> Iterator[np.ndarray[tuple[int], np.dtype[np.float64]]]:
    for a, b in pairwise(np.array(path)):
        count = max(1, math.ceil(float(np.linalg.norm(b - a)) / FINE_STEP))
        yield from (a + (b - a) * k / count for k in range(count + 1))


def assert_free(checker: BelievedWorld, hand: Hand, path: tuple[Joints7, ...], touching: frozenset[int]) -> None:
    for joints in fine(path):
        checker.set_arm(hand, joints)
        assert checker.free(touching)


def picked(planner: PlanningWorld, objects: dict[str, ObjectBelief], anchor: str, hand: Hand) -> tuple[Pick, Pose2]:
    """Drive to an object if need be and return the pick and the base pose it is from."""
    planner.sync(scenes.belief(objects))
    base = driven((0.0, 0.0, 0.0), planner.approach(Activity("pick", anchor, hand)))
    planner.sync(scenes.belief(objects, base, version=2))
    pick = planner.ready(Activity("pick", anchor, hand))
    assert isinstance(pick, Pick)
    return pick, base


# ---------------------------------------------------------------- picking and placing


@pytest.mark.parametrize("anchor", ["soda1", "soda2", "soda3"])
def test_a_soda_from_any_table_is_picked_and_put_on_the_first(
    planner: PlanningWorld, checker: BelievedWorld, anchor: str
) -> None:
    objects = scenes.sodas()
    pick, base = picked(planner, objects, anchor, "right")
    assert isinstance(planner.ready(Activity("look", anchor)), LookAt)
    check_pick(checker, scenes.belief(objects, base, version=2), pick, anchor)
    objects |= {anchor: scenes.in_hand(objects[anchor], "right", pick.tool_T_object)}
    planner.sync(scenes.belief(objects, base, version=3))
    assert isinstance(planner.ready(Activity("weigh", anchor, "right")), Weigh)
    doing = Activity("place", anchor, "right", "table1")
    base = driven(base, planner.approach(doing))
    belief = scenes.belief(objects, base, version=4)
    planner.sync(belief)
    place = planner.ready(doing)
    assert isinstance(place, Place)
    check_place(checker, belief, place, anchor)


def check_pick(checker: BelievedWorld, belief: Belief, pick: Pick, anchor: str) -> None:
    """Follow the pick in a world of its own, in finer steps than it was planned with."""
    checker.update(belief)
    item = checker.standing[anchor]
    table = checker.table_below(item)
    assert table is not None
    assert pick.approach[0] == pytest.approx(CARRY[pick.hand])
    assert (pick.approach[-1], pick.reach[-1], pick.lift[-1]) == (pick.reach[0], pick.lift[0], pick.carry[0])
    assert_free(checker, pick.hand, pick.approach, frozenset())
    assert_free(checker, pick.hand, pick.reach, frozenset([item.body]))
    at = checker.robot.world_T_tool(pick.hand)
    assert compose4(at, pick.tool_T_object)[:3] == pytest.approx(item.world_T_object[:3], abs=1e-4)
    with checker.picked(pick.hand, anchor, pick.tool_T_object):
        assert_free(checker, pick.hand, pick.lift, frozenset([table.body]))
        assert checker.robot.world_T_tool(pick.hand)[2] - at[2] == pytest.approx(0.10, abs=1e-4)
        assert_free(checker, pick.hand, pick.carry, frozenset())
        assert_is_carry(checker, pick.hand)


def check_place(checker: BelievedWorld, belief: Belief, place: Place, anchor: str) -> None:
    """Follow the placement likewise, and find the object wholly on the table."""
    checker.update(belief)
    assert_free(checker, place.hand, place.approach, frozenset())
    assert_free(checker, place.hand, place.lower, frozenset())
    held = checker.carried[place.hand]
    world_T_object = compose4(checker.robot.world_T_tool(place.hand), held.tool_T_object)
    x, y, z, _ = compose4(inverse4(checker.standing["table1"].world_T_object), world_T_object)
    assert z - 0.68 == pytest.approx(grasps.RELEASE_M, abs=1e-4)
    assert max(abs(x) - 0.4, abs(y) - 0.6) <= -grasps.EDGE_M + 1e-4
    with checker.placed(place.hand, world_T_object) as body:
        assert_free(checker, place.hand, place.retreat, frozenset([body]))
        assert_free(checker, place.hand, place.carry, frozenset())
        assert_is_carry(checker, place.hand)


def assert_is_carry(checker: BelievedWorld, hand: Hand) -> None:
    turn = np.subtract(checker.robot.arm(hand), CARRY[hand])
    assert (turn + math.pi) % (2.0 * math.pi) - math.pi == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("kind", ["bottle", "carton"])
@pytest.mark.parametrize("hand", ["right", "left"])
def test_bottles_and_cartons_are_picked_with_either_hand(planner: PlanningWorld, kind: str, hand: Hand) -> None:
    objects = scenes.tables() | {"it": scenes.believed(kind, scenes.on("table1", -0.25, 0.0, 1.2))}
    pick, base = picked(planner, objects, "it", hand)
    belief = scenes.belief(objects | {"it": scenes.in_hand(objects["it"], hand, pick.tool_T_object)}, base, version=3)
    planner.sync(belief)
    assert planner.approach(Activity("place", "it", hand, "table3")) is not None


def test_a_base_that_stops_a_little_beside_the_plan_can_still_do_it(planner: PlanningWorld) -> None:
    rng, done, tried = np.random.default_rng(0), 0, 0
    for anchor in ("soda1", "soda2", "soda3"):
        objects = scenes.sodas()
        planner.sync(scenes.belief(objects))
        stance = driven((0.0, 0.0, 0.0), planner.approach(Activity("pick", anchor, "right")))
        for _ in range(8):
            dx, dy, turn = rng.normal(0.0, (0.03, 0.03, 0.03))
            planner.sync(scenes.belief(objects, compose2(stance, (dx, dy, turn)), version=2))
            tried += 1
            done += planner.ready(Activity("pick", anchor, "right")) is not None
    assert done >= tried - 1


def test_doubt_about_a_neighbour_s_place_does_not_forbid_what_its_size_allows(planner: PlanningWorld) -> None:
    middle = scenes.on("table1", -0.25, 0.0)
    around = {
        f"n{k}": scenes.believed("bottle", scenes.on("table1", -0.25, y), 0.05) for k, y in enumerate((-0.15, 0.15))
    }
    objects = scenes.tables() | {"it": scenes.believed("soda", middle, 0.05)} | around
    pick, _ = picked(planner, objects, "it", "right")
    assert len(pick.reach) > 4


# ---------------------------------------------------------------- what is refused


def test_a_soda_beyond_the_arm_is_looked_at_but_not_picked(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(scenes.sodas()))
    assert planner.ready(Activity("pick", "soda1", "right")) is None
    look = planner.ready(Activity("look", "soda1"))
    assert isinstance(look, LookAt)
    assert look.tilt > 0.3


def test_a_full_hand_picks_nothing_and_an_empty_one_places_nothing(planner: PlanningWorld) -> None:
    objects = scenes.sodas()
    objects["soda2"] = scenes.in_hand(objects["soda2"])
    planner.sync(scenes.belief(objects, (0.35, 0.0, 0.0)))
    assert planner.ready(Activity("pick", "soda1", "right")) is None
    assert planner.approach(Activity("pick", "soda1", "right")) is None
    assert planner.ready(Activity("place", "soda1", "right", "table1")) is None
    assert planner.ready(Activity("place", "soda2", "left", "table1")) is None
    assert planner.ready(Activity("pick", "soda2", "left")) is None


def test_only_the_right_hand_weighs_and_only_what_it_holds(planner: PlanningWorld) -> None:
    objects = scenes.sodas()
    objects["soda1"] = scenes.in_hand(objects["soda1"], "left")
    objects["soda2"] = scenes.in_hand(objects["soda2"], "right")
    planner.sync(scenes.belief(objects))
    assert planner.ready(Activity("weigh", "soda2", "right")) == Weigh(hand="right")
    assert planner.ready(Activity("weigh", "soda1", "left")) is None
    assert planner.ready(Activity("weigh", "soda1", "right")) is None


def test_tables_and_unknown_things_are_not_picked(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(scenes.sodas()))
    for anchor in ("table1", "_o99_"):
        assert planner.ready(Activity("pick", anchor, "right")) is None
        assert planner.approach(Activity("pick", anchor, "right")) is None
    assert planner.ready(Activity("look", "_o99_")) is None


def test_a_table_without_room_takes_nothing(planner: PlanningWorld) -> None:
    grid = [(x, y) for x in (-0.3, -0.15, 0.0, 0.15, 0.3) for y in np.linspace(-0.5, 0.5, 8)]
    full = {f"s{i}": scenes.believed("soda", scenes.on("table1", x, y), 0.0) for i, (x, y) in enumerate(grid)}
    objects = {"table1": scenes.tables()["table1"], **full, "it": scenes.in_hand(scenes.sodas()["soda1"])}
    planner.sync(scenes.belief(objects))
    assert planner.ready(Activity("place", "it", "right", "table1")) is None
    assert planner.approach(Activity("place", "it", "right", "table1")) is None


def test_a_low_can_gets_onto_an_empty_table() -> None:
    can = ObjectType(shape="cylinder", size_m=(0.07, 0.07, 0.09), graspable=True)
    planner = PlanningWorld(scenes.TYPES | {"can": can}, seed=0)
    place = Activity("place", "it", "left", "table2")
    held = scenes.in_hand(scenes.believed("can", scenes.on("table1", -0.25, 0.0)), "left", (-0.005, 0.0, -0.054, 0.3))
    objects = scenes.tables() | {"it": held}
    planner.sync(scenes.belief(objects))
    base = driven((0.0, 0.0, 0.0), planner.approach(place))
    planner.sync(scenes.belief(objects, base, version=2))
    assert isinstance(planner.ready(place), Place)
    planner.close()


def test_a_search_of_stances_that_found_none_is_widened(
    planner: PlanningWorld, monkeypatch: pytest.MonkeyPatch
) -> None:
    pick = Activity("pick", "soda2", "right")
    likeliest, wider = trials.EFFORTS
    nothing = dataclasses.replace(likeliest, sketched=0)
    for efforts, is_found in (((nothing,), False), ((nothing, wider), True)):
        monkeypatch.setattr(trials, "EFFORTS", efforts)
        planner.sync(scenes.belief(scenes.sodas(), version=50 + is_found))
        assert (planner.approach(pick) is not None) == is_found


def test_a_search_that_was_given_up_tells_how_many_stances_it_tried_and_one_that_shows_something_tells_none(
    planner: PlanningWorld, monkeypatch: pytest.MonkeyPatch
) -> None:
    pick = Activity("pick", "soda2", "right")
    monkeypatch.setattr(trials, "EFFORTS", (dataclasses.replace(trials.EFFORTS[0], sketched=3),))
    for sketches, tried in ((True, 0), (False, 2 * 3)):  # with objects widened by their doubt, and without
        monkeypatch.setattr(trials.Trials, "_sketch", lambda *_, sketches=sketches: sketches)
        planner.sync(scenes.belief(scenes.sodas(), version=60 + sketches))
        assert (planner.approach(pick) is not None) == sketches
        assert planner.tried(pick) == tried
    far_from_the_edge = scenes.tables() | {"soda2": scenes.believed("soda", (0.0, 0.0, 3.0, 0.0), 0.0)}
    planner.sync(scenes.belief(far_from_the_edge, version=70))
    assert planner.approach(pick) is None
    assert planner.tried(pick) == 0


# ---------------------------------------------------------------- driving


def test_a_drive_leads_around_the_table_to_a_soda_at_its_far_edge(
    planner: PlanningWorld, checker: BelievedWorld
) -> None:
    objects = scenes.tables() | {"soda1": scenes.believed("soda", scenes.on("table1", 0.25, 0.0))}
    belief = scenes.belief(objects)
    planner.sync(belief)
    assert planner.ready(Activity("look", "soda1")) is not None
    move = planner.approach(Activity("pick", "soda1", "right"))
    goal = driven((0.0, 0.0, 0.0), move)
    assert isinstance(move, MoveBase)
    assert move.start_T_waypoint[0] == pytest.approx((0.0, 0.0, 0.0))
    assert goal[0] > 0.9 or abs(goal[1]) > 0.6
    checker.update(belief)
    for a, b in pairwise(move.start_T_waypoint):
        turn = (b[2] - a[2] + math.pi) % (2.0 * math.pi) - math.pi
        assert abs(turn) <= 0.51
        count = max(1, math.ceil(math.hypot(b[0] - a[0], b[1] - a[1], turn) / FINE_STEP))
        for k in range(count + 1):
            s = k / count
            checker.set_base((a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, a[2] + turn * s))
            assert checker.free()
            assert checker.clear(0.02)


def test_the_drive_is_told_in_the_frame_of_its_start(planner: PlanningWorld) -> None:
    start: Pose2 = (0.2, 0.3, 2.5)
    planner.sync(scenes.belief(scenes.sodas(), start))
    move = planner.approach(Activity("pick", "soda1", "right"))
    assert isinstance(move, MoveBase)
    assert move.start_T_waypoint[0] == pytest.approx((0.0, 0.0, 0.0))
    base_T_soda = compose2(inverse2(driven(start, move)), flat(scenes.sodas()["soda1"].world_T_object))
    assert 0.35 < base_T_soda[0] < 0.95


def test_a_drive_to_look_ends_where_the_look_is_ready(planner: PlanningWorld) -> None:
    start: Pose2 = (-1.5, 0.0, math.pi)
    planner.sync(scenes.belief(scenes.sodas(), start))
    assert planner.ready(Activity("look", "soda1")) is None
    goal = driven(start, planner.approach(Activity("look", "soda1")))
    planner.sync(scenes.belief(scenes.sodas(), goal, version=2))
    assert planner.ready(Activity("look", "soda1")) is not None


def test_what_was_looked_at_from_here_in_vain_is_looked_at_from_another_side(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(scenes.sodas(), (-1.5, 0.0, math.pi)))
    here = driven((-1.5, 0.0, math.pi), planner.approach(Activity("look", "soda1")))
    planner.sync(scenes.belief(scenes.sodas(), here, version=2))
    assert planner.ready(Activity("look", "soda1")) is not None
    assert planner.ready(Activity("look", "soda1", elsewhere=True)) is None
    there = driven(here, planner.approach(Activity("look", "soda1", elsewhere=True)))
    assert is_other_side(there, here, scenes.sodas()["soda1"].world_T_object)
    planner.sync(scenes.belief(scenes.sodas(), there, version=3))
    assert planner.ready(Activity("look", "soda1")) is not None


def test_a_thing_that_can_only_be_picked_where_it_is_on_average_is_looked_at_from_there(planner: PlanningWorld) -> None:
    objects = scenes.tables() | {
        "it": scenes.believed("soda", (0.09, 1.34, 0.68, 0.0), 0.03, "table3"),
        "beside": scenes.believed("carton", (-0.02, 1.25, 0.68, 1.51), 0.03, "table3"),
    }
    planner.sync(scenes.belief(objects))
    goal = driven((0.0, 0.0, 0.0), planner.approach(Activity("pick", "it", "left")))
    planner.sync(scenes.belief(objects, goal, version=2))
    assert planner.ready(Activity("pick", "it", "left")) is not None
    assert planner.ready(Activity("look", "it")) is not None


# ---------------------------------------------------------------- the same answer every time


def questions() -> list[tuple[str, Activity]]:
    doings = [Activity("look", "soda1"), Activity("pick", "soda2", "left"), Activity("pick", "soda3", "right")]
    return [(ask, doing) for ask in ("ready", "approach") for doing in doings]


def answers(planner: PlanningWorld, belief: Belief, order: list[tuple[str, Activity]]) -> list[Command | None]:
    planner.sync(belief)
    found: dict[tuple[str, Activity], Command | None] = {
        (ask, doing): getattr(planner, ask)(doing) for ask, doing in order
    }
    return [found[question] for question in questions()]


def test_answers_do_not_depend_on_the_order_of_questions_or_on_the_past(planner: PlanningWorld) -> None:
    belief = scenes.belief(scenes.sodas(), version=7)
    before = answers(planner, belief, questions())
    planner.sync(scenes.belief(scenes.sodas(sd_m=0.001), (0.1, 0.1, 0.1), version=8))
    planner.approach(Activity("pick", "soda1", "right"))
    assert answers(planner, belief, questions()[::-1]) == before
    fresh = PlanningWorld(scenes.TYPES, seed=0)
    assert answers(fresh, belief, questions()[::-1]) == before
    fresh.close()
    assert sum(answer is not None for answer in before) >= 4


def test_an_answer_is_kept_until_the_belief_changes(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(scenes.sodas()))
    first = planner.approach(Activity("pick", "soda1", "right"))
    planner.sync(scenes.belief(scenes.sodas()))
    assert planner.approach(Activity("pick", "soda1", "right")) is first
    planner.sync(scenes.belief(scenes.tables(), version=2))
    assert planner.approach(Activity("pick", "soda1", "right")) is None


def test_the_identity_of_the_robot_is_told(planner: PlanningWorld) -> None:
    assert len(planner.robot_sha256) == 64
