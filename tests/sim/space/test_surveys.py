"""Looks at regions: taken where they show much, elsewhere otherwise, and at an end when all was seen."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from kit import believed_scenes as scenes

from skolem.reasoner.protocols import Geometry
from skolem.sim.planner.planner import PlanningWorld
from skolem.sim.space.surveys import survey, unseen_points
from skolem.sim.symbolic.geometry import SymbolicGeometry
from skolem.sim.symbolic.sight import BelievedSight, Thing
from skolem.traces.messages import Activity, Belief, LookAt, ObjectBelief, Pose2, RegionBelief, RobotState
from skolem.traces.messages.poses import compose2, compose4

LOOK = Activity("look_region", "_reg1_")
HEIGHT_MM = 240
GRID = tuple((x, y, z) for x in range(-360, 361, 90) for y in range(-560, 561, 80) for z in (30, 120, 210))


@pytest.fixture(scope="module")
def planner() -> Iterator[Geometry]:
    planner = PlanningWorld(scenes.TYPES, seed=0)
    yield planner
    planner.close()


@pytest.fixture
def symbolic() -> Geometry:
    return SymbolicGeometry(scenes.TYPES)


WORLDS = pytest.mark.parametrize("name", ["symbolic", pytest.param("planner", marks=pytest.mark.physics)])


def belief(
    objects: dict[str, ObjectBelief],
    unseen: tuple[tuple[int, int, int], ...],
    base: Pose2 = (0.0, 0.0, 0.0),
    version: int = 1,
    head: tuple[float, float] = (0.0, 0.0),
) -> Belief:
    """Return a belief with one region, on table1, of which so much is unseen."""
    robot = RobotState(torso=0.2, head=head, right_arm=scenes.CARRYING.right_arm, left_arm=scenes.CARRYING.left_arm)
    some = unseen[:: max(1, len(unseen) // 64)][:64]
    region = RegionBelief(support="table1", height_m=HEIGHT_MM / 1000, seen=0.0, hidden=1.0, unseen_mm=some)
    return scenes.belief(objects, base, version, robot).model_copy(update={"regions": {"_reg1_": region}})


def left_unseen(
    objects: dict[str, ObjectBelief], unseen: tuple[tuple[int, int, int], ...], base: Pose2, look: LookAt
) -> tuple[tuple[int, int, int], ...]:
    """Return what a picture does not show, by rays of a camera that knows the objects exactly."""
    things = [Thing(a, scenes.TYPES[next(iter(item.type))], item.world_T_object) for a, item in objects.items()]
    sight = BelievedSight(base, 0.2, things)
    sight.turn((look.pan, look.tilt))
    points = np.array(
        [compose4(scenes.TABLES["table1"], (x / 1e3, y / 1e3, 0.68 + z / 1e3, 0.0))[:3] for x, y, z in unseen]
    )
    eye, axes = sight.camera_pose()
    forward, left, up = ((points - eye) @ axes).T
    half = math.tan(math.radians(45.6) / 2.0)
    shown = (forward > 0.0) & (abs(up) < half * forward) & (abs(left) < half * 4 / 3 * forward)
    shown &= sight.unhidden(points) & (np.linalg.norm(points - eye, axis=1) < 2.4)
    return tuple(point for point, is_shown in zip(unseen, shown, strict=True) if not is_shown)


def searched(geometry: Geometry, objects: dict[str, ObjectBelief], base: Pose2) -> tuple[float, int, int]:
    """Look until no look is left; return the share seen, the looks and the drives."""
    unseen, looks, drives, head = GRID, 0, 0, (0.0, 0.0)
    for version in range(20):
        geometry.sync(belief(objects, unseen, base, version, head))
        look = geometry.ready(LOOK)
        if isinstance(look, LookAt):
            unseen, looks, head = left_unseen(objects, unseen, base, look), looks + 1, (look.pan, look.tilt)
            continue
        move = geometry.approach(LOOK)
        if move is None:
            return 1.0 - len(unseen) / len(GRID), looks, drives
        base, drives = compose2(base, move.start_T_waypoint[-1]), drives + 1
    raise AssertionError("the search has no end")


@WORLDS
def test_an_empty_table_in_front_is_searched_in_two_looks_at_most(name: str, request: pytest.FixtureRequest) -> None:
    share, looks, drives = searched(request.getfixturevalue(name), scenes.tables(), (0.0, 0.0, 0.0))
    assert share > 0.97
    assert (looks <= 2, drives) == (True, 0)


@WORLDS
def test_what_is_behind_things_is_searched_from_other_sides(name: str, request: pytest.FixtureRequest) -> None:
    wall = {
        f"b{k}": scenes.believed("bottle", scenes.on("table1", -0.1, -0.5 + 0.075 * k), 0.0, "table1")
        for k in range(14)
    }
    share, looks, drives = searched(request.getfixturevalue(name), scenes.tables() | wall, (0.0, 0.0, 0.0))
    assert share > 0.9
    assert looks >= 2
    assert drives >= 1


@WORLDS
def test_a_far_region_is_approached_first(name: str, request: pytest.FixtureRequest) -> None:
    geometry: Geometry = request.getfixturevalue(name)
    geometry.sync(belief(scenes.tables(), GRID, (-1.5, 0.0, math.pi)))
    assert geometry.ready(LOOK) is None
    share, _, drives = searched(geometry, scenes.tables(), (-1.5, 0.0, math.pi))
    assert (share > 0.97, drives) == (True, 1)


@WORLDS
def test_a_region_that_is_seen_or_unknown_is_not_looked_at(name: str, request: pytest.FixtureRequest) -> None:
    geometry: Geometry = request.getfixturevalue(name)
    geometry.sync(belief(scenes.tables(), ()))
    for activity in (LOOK, Activity("look_region", "_reg9_")):
        assert geometry.ready(activity) is None
        assert geometry.approach(activity) is None
        assert geometry.blockers(activity) == ()


@WORLDS
def test_a_look_that_showed_nothing_is_not_repeated_from_there(name: str, request: pytest.FixtureRequest) -> None:
    geometry: Geometry = request.getfixturevalue(name)
    geometry.sync(belief(scenes.tables(), GRID))
    look = geometry.ready(LOOK)
    assert isinstance(look, LookAt)
    geometry.sync(belief(scenes.tables(), GRID, version=2, head=(look.pan, look.tilt)))
    assert geometry.ready(LOOK) is None
    move = geometry.approach(LOOK)
    assert move is not None
    assert math.hypot(*move.start_T_waypoint[-1][:2]) > 0.45


def test_the_head_turns_to_where_most_is_unseen() -> None:
    """Of two heaps of points too far apart for one image, the larger is chosen."""
    sight = BelievedSight((0.0, 0.0, 0.0), 0.2, [])
    small = [(300, 1300, 100)] * 3
    large = [(300, -1300, 100)] * 5
    region = RegionBelief(support="t", height_m=0.2, seen=0.0, hidden=1.0, unseen_mm=tuple(small + large))
    points = unseen_points(region, (0.0, 0.0, 0.0, 0.0), 0.68)
    found = survey(sight, points)
    assert found is not None
    assert found.shown.tolist() == [False] * 3 + [True] * 5
    assert found.head[0] < -0.5
