"""What stands in the way in the believed world, and where it can be put so that it does not."""

import math
from collections.abc import Iterator

import pytest
from kit import believed_scenes as scenes

from skolem.sim.planner.planner import PlanningWorld
from skolem.traces.messages import Activity, Hand, MoveBase, ObjectBelief, ObjectType, Pick, Place, Pose2
from skolem.traces.messages.poses import compose2, compose4, raised

pytestmark = pytest.mark.physics

PICK = Activity("pick", "it", "right")
TARGET = scenes.believed("soda", scenes.on("table1", -0.18, 0.0), 0.005, "table1")


@pytest.fixture(scope="module")
def planner() -> Iterator[PlanningWorld]:
    planner = PlanningWorld(scenes.TYPES, seed=0)
    yield planner
    planner.close()


def ring(kind: str, radius: float, count: int) -> dict[str, ObjectBelief]:
    """Return the tables and things all around the target; `n0` is the one beyond it, the rest follow to the left."""
    angles = [2.0 * math.pi * k / count for k in range(count)]
    spots = [scenes.on("table1", -0.18 + radius * math.cos(a), radius * math.sin(a)) for a in angles]
    around = {f"n{k}": scenes.believed(kind, spot, 0.005, "table1") for k, spot in enumerate(spots)}
    return scenes.tables() | {"it": TARGET} | around


RING = ring("bottle", 0.13, 8)


def blocking(planner: PlanningWorld, activity: Activity) -> tuple[str, ...]:
    """Return the blockers of an activity that is possible without them."""
    found = planner.blockers(activity)
    assert found is not None
    return found


def test_what_can_be_picked_has_no_blockers(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(scenes.tables() | {"it": TARGET, "aside": ring("soda", 0.25, 4)["n1"]}))
    assert blocking(planner, PICK) == ()


def test_blockers_are_all_and_only_what_must_go(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(RING))
    assert planner.approach(PICK) is None
    blockers = blocking(planner, PICK)
    assert 1 <= len(blockers) <= 3
    assert blockers == tuple(sorted(blockers))
    left = {anchor: item for anchor, item in RING.items() if anchor not in blockers}
    planner.sync(scenes.belief(left, version=2))
    assert planner.approach(PICK) is not None
    for one in blockers:
        planner.sync(scenes.belief(left | {one: RING[one]}, version=3))
        assert blocking(planner, PICK) in ((), (one,))


def test_what_nothing_can_help_has_no_blockers(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(scenes.tables() | {"it": scenes.believed("soda", (1.3, 0.0, 0.68, 0.0))}))
    assert planner.approach(PICK) is None
    assert blocking(planner, PICK) == ()
    assert blocking(planner, Activity("pick", "_o99_", "right")) == ()


def test_a_hand_that_holds_a_blocker_counts_as_empty(planner: PlanningWorld) -> None:
    planner.sync(scenes.belief(RING))
    first, *others = blocking(planner, PICK)
    held = RING | {first: scenes.in_hand(RING[first])}
    planner.sync(scenes.belief(held, version=2))
    assert planner.ready(PICK) is None
    assert first not in blocking(planner, PICK)
    assert set(blocking(planner, PICK)) <= set(others)


def picked(planner: PlanningWorld, objects: dict[str, ObjectBelief], anchor: str) -> tuple[Pick, Pose2]:
    activity, base = Activity("pick", anchor, "right"), (0.0, 0.0, 0.0)
    planner.sync(scenes.belief(objects, base, version=11))
    move = planner.approach(activity)
    assert isinstance(move, MoveBase)
    base = compose2(base, move.start_T_waypoint[-1])
    planner.sync(scenes.belief(objects, base, version=12))
    pick = planner.ready(activity)
    assert isinstance(pick, Pick)
    return pick, base


def released(planner: PlanningWorld, place: Place, pick: Pick, hand: Hand = "right") -> ObjectBelief:
    """Return where a placement leaves the object that a pick took."""
    world = planner._world
    world.reset()
    world.set_arm(hand, place.lower[-1])
    x, y, _, theta = compose4(world.robot.world_T_tool(hand), pick.tool_T_object)
    return scenes.believed("bottle", (x, y, 0.68, theta), 0.02, "table1")


def test_what_is_put_aside_is_in_the_way_no_more(planner: PlanningWorld) -> None:
    wall = {
        f"w{k}": scenes.believed("bottle", scenes.on("table1", -0.3, 0.1 * k), 0.005, "table1") for k in range(-3, 4)
    }
    objects = scenes.tables() | {"it": TARGET} | wall
    planner.sync(scenes.belief(objects))
    blockers = blocking(planner, PICK)
    assert blockers
    for version, anchor in enumerate(blockers):
        pick, base = picked(planner, objects, anchor)
        objects |= {anchor: scenes.in_hand(objects[anchor], "right", pick.tool_T_object)}
        planner.sync(scenes.belief(objects, base, version=20 + version))
        put = Activity("place", anchor, "right", "table1", PICK)
        move = planner.approach(put)
        assert move is not None
        base = compose2(base, move.start_T_waypoint[-1])
        planner.sync(scenes.belief(objects, base, version=30 + version))
        place = planner.ready(put)
        assert isinstance(place, Place)
        objects |= {anchor: released(planner, place, pick)}
        planner.sync(scenes.belief(objects, base, version=40 + version))
        assert anchor not in blocking(planner, PICK)
    assert blocking(planner, PICK) == ()


# ---------------------------------------------------------------- room


def full(kind: str) -> dict[str, ObjectBelief]:
    """Return the tables, the first full of things of a type, and an object on another one."""
    spots = [(-0.3 + 0.12 * i, -0.52 + 0.13 * j) for i in range(6) for j in range(9)]
    crowd = {f"n{k}": scenes.believed(kind, scenes.on("table1", *at), 0.0, "table1") for k, at in enumerate(spots)}
    return scenes.tables() | {"it": scenes.believed("soda", scenes.on("table2", -0.2, 0.0), 0.0, "table2")} | crowd


ROOM = Activity("place", "it", None, "table1")


def test_a_full_table_names_what_takes_the_room_before_anything_is_picked_up(planner: PlanningWorld) -> None:
    objects = full("soda")
    planner.sync(scenes.belief(objects))
    blockers = blocking(planner, ROOM)
    assert 1 <= len(blockers) <= 2
    assert blocking(planner, Activity("place", "it", None, "table3")) == ()
    planner.sync(scenes.belief({a: item for a, item in objects.items() if a not in blockers}, version=2))
    assert blocking(planner, ROOM) == ()


def test_a_table_full_of_what_no_hand_lifts_has_no_room() -> None:
    crate = ObjectType(shape="box", size_m=(0.25, 0.35, 0.3), graspable=False)
    planner = PlanningWorld(scenes.TYPES | {"crate": crate}, seed=0)
    spots = [(-0.15 + 0.3 * i, -0.4 + 0.4 * j) for i in range(2) for j in range(3)]
    crates = {f"n{k}": scenes.believed("crate", scenes.on("table1", *at), 0.0, "table1") for k, at in enumerate(spots)}
    thing = {"it": scenes.believed("soda", scenes.on("table2", -0.2, 0.0), 0.0, "table2")}
    planner.sync(scenes.belief(scenes.tables() | thing | crates))
    assert planner.blockers(ROOM) is None
    assert planner.blockers(Activity("place", "it", None, "it")) is None
    assert planner.blockers(Activity("place", "it", None, "table3")) == ()
    planner.close()


# ---------------------------------------------------------------- looks


def hidden_can(around: bool) -> dict[str, ObjectBelief]:
    """Return a can with bottles before it, or all around it."""
    can = scenes.believed("soda", scenes.on("table1", 0.0, 0.0), 0.002, "table1")
    angles = [math.pi + 0.45 * k for k in (range(14) if around else (-1, 0, 1))]
    spots = [scenes.on("table1", 0.085 * math.cos(a) * 1.7, 0.085 * math.sin(a) * 1.7) for a in angles]
    bottles = {f"b{k}": scenes.believed("bottle", spot, 0.002, "table1") for k, spot in enumerate(spots)}
    return scenes.tables() | {"it": can} | bottles


def test_a_can_behind_bottles_is_looked_at_from_another_side(planner: PlanningWorld) -> None:
    look = Activity("look", "it")
    planner.sync(scenes.belief(hidden_can(around=False), (0.3, 0.0, 0.0)))
    assert planner.ready(look) is None
    assert blocking(planner, look) == ()
    move = planner.approach(look)
    assert move is not None
    base = compose2((0.3, 0.0, 0.0), move.start_T_waypoint[-1])
    planner.sync(scenes.belief(hidden_can(around=False), base, version=2))
    assert planner.ready(look) is not None


def test_cans_of_equal_height_in_a_row_are_seen_well_enough(planner: PlanningWorld) -> None:
    row = {f"c{k}": scenes.believed("soda", scenes.on("table1", -0.25 + 0.14 * k, 0.0), 0.005) for k in range(4)}
    planner.sync(scenes.belief(scenes.tables() | row, (0.2, 0.0, 0.0)))
    assert all(planner.ready(Activity("look", anchor)) is not None for anchor in row)


def test_what_may_be_hidden_is_looked_at_from_where_it_cannot_be(planner: PlanningWorld) -> None:
    """A can believed just beside a bottle, by 2 cm in doubt, may as well stand behind it."""
    bottle = {"bottle": scenes.believed("bottle", scenes.on("table1", -0.15, 0.0), 0.002, "table1")}
    for sd_m, sure in ((0.002, True), (0.025, False)):
        can = scenes.believed("soda", scenes.on("table1", -0.02, 0.065), sd_m, "table1")
        planner.sync(scenes.belief(scenes.tables() | bottle | {"it": can}, (0.3, 0.0, 0.0)))
        assert (planner.ready(Activity("look", "it")) is not None) is sure
        assert planner.approach(Activity("look", "it")) is not None


# ---------------------------------------------------------------- the same answer every time


def test_blockers_do_not_depend_on_what_was_asked_before(planner: PlanningWorld) -> None:
    look, left = Activity("look", "it"), Activity("pick", "it", "left")
    planner.sync(scenes.belief(RING, version=5))
    first = [blocking(planner, activity) for activity in (PICK, look, left)]
    planner.sync(scenes.belief(hidden_can(around=True), raised((0.1, 0.1, 0.0))[:3], version=6))
    blocking(planner, look)
    planner.sync(scenes.belief(RING, version=5))
    assert [blocking(planner, activity) for activity in (left, look, PICK)][::-1] == first
