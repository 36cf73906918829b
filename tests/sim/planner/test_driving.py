import math
from collections.abc import Iterator
from itertools import pairwise

import pytest
from kit import believed_scenes as scenes

from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.driving import SHARPEST_TURN_RAD, drive
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import compose2

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def world() -> Iterator[BelievedWorld]:
    world = BelievedWorld(scenes.TYPES)
    yield world
    world.close()


def test_a_drive_around_a_table_touches_nothing_and_ends_at_the_goal(world: BelievedWorld) -> None:
    start, goal = (0.4, 0.0, 0.0), (2.3, 0.0, math.pi)
    world.update(scenes.belief(scenes.sodas(), start))
    path = drive(world, start, goal, seed=1)
    assert path is not None
    assert compose2(start, path[-1]) == pytest.approx((2.3, 0.0, -math.pi))
    assert len(path) > 3
    for a, b in pairwise(path):
        for k in range(41):
            between = tuple(a[i] + (turn(a, b) if i == 2 else b[i] - a[i]) * k / 40 for i in range(3))
            world.set_base(compose2(start, (between[0], between[1], between[2])))
            assert world.free()
            assert world.clear(0.02)


def turn(a: Pose2, b: Pose2) -> float:
    return (b[2] - a[2] + math.pi) % (2.0 * math.pi) - math.pi


def test_turns_between_waypoints_are_small_enough_to_be_the_shorter_ones(world: BelievedWorld) -> None:
    start: Pose2 = (0.0, 0.0, 2.0)
    world.update(scenes.belief({}, start))
    path = drive(world, start, (1.0, 1.0, -1.2), seed=1)
    assert path is not None
    assert all(abs(turn(a, b)) <= SHARPEST_TURN_RAD + 1e-9 for a, b in pairwise(path))
    assert path[0] == pytest.approx((0.0, 0.0, 0.0))


def test_a_start_close_to_a_table_still_leads_away(world: BelievedWorld) -> None:
    start: Pose2 = (0.58, 0.0, 0.0)
    world.update(scenes.belief(scenes.tables(), start))
    assert not world.clear(0.02)
    assert drive(world, start, (0.0, 0.0, 0.0), seed=1) is not None


def test_a_goal_inside_a_table_is_not_reached_and_the_robot_stays(world: BelievedWorld) -> None:
    world.update(scenes.belief(scenes.tables()))
    assert drive(world, (0.0, 0.0, 0.0), (1.3, 0.0, 0.0), seed=1) is None
    assert world.robot.base() == (0.0, 0.0, 0.0)


def test_a_robot_that_believes_it_stands_in_a_table_by_a_little_steps_out_of_it_first(world: BelievedWorld) -> None:
    start = (0.59, 0.0, 0.0)
    world.update(scenes.belief(scenes.tables(), start))
    assert not world.free()
    path = drive(world, start, (-0.5, 0.5, 1.0), 1)
    assert path is not None
    assert path[0] == pytest.approx((0.0, 0.0, 0.0))
    assert path[1][0] < -0.003
