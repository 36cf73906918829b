from collections.abc import Iterator

import pytest
from kit import believed_scenes as scenes

from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.robot import bodies
from skolem.sim.robot.bullet import p
from skolem.traces.messages import Belief

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def loaded() -> Iterator[BelievedWorld]:
    world = BelievedWorld(scenes.TYPES)
    yield world
    world.close()


@pytest.fixture
def world(loaded: BelievedWorld) -> BelievedWorld:
    loaded.update(scenes.belief(scenes.sodas()))
    return loaded


def test_everything_believed_is_where_it_is_believed_to_be(world: BelievedWorld) -> None:
    assert list(world.standing) == list(scenes.sodas())
    for anchor, item in world.standing.items():
        there = scenes.sodas()[anchor].world_T_object
        assert bodies.pose(world.client, item.body, item.type) == pytest.approx(there, abs=1e-9)
    assert world.free()


def test_what_hardly_exists_is_no_obstacle(world: BelievedWorld) -> None:
    objects = scenes.sodas()
    objects["soda1"] = objects["soda1"].model_copy(update={"exists": 0.4})
    world.update(scenes.belief(objects))
    assert "soda1" not in world.standing


def test_things_are_wider_by_their_doubt_and_tables_are_not(world: BelievedWorld) -> None:
    world.update(scenes.belief(scenes.sodas(sd_m=0.01)))
    assert world.standing["soda1"].spread_m == pytest.approx(0.02)
    assert world.standing["table1"].spread_m == 0.0
    with world.narrowed():
        assert world.standing["soda1"].spread_m == 0.0
    assert world.standing["soda1"].spread_m == pytest.approx(0.02)


def test_spread_has_a_limit(world: BelievedWorld) -> None:
    world.update(scenes.belief(scenes.sodas(sd_m=0.3)))
    assert world.standing["soda1"].spread_m == pytest.approx(0.05)


def test_a_body_is_reposed_not_made_anew(world: BelievedWorld) -> None:
    before = world.standing["soda1"].body
    moved = scenes.sodas() | {"soda1": scenes.believed("soda", scenes.on("table1", -0.2, 0.3))}
    world.update(scenes.belief(moved, version=2))
    assert world.standing["soda1"].body == before
    item = world.standing["soda1"]
    assert bodies.pose(world.client, item.body, item.type) == pytest.approx(scenes.on("table1", -0.2, 0.3), abs=1e-9)


def test_the_robot_inside_a_table_is_not_free_and_beside_it_not_clear(world: BelievedWorld) -> None:
    world.reset((1.0, 0.0, 0.0))
    assert not world.free()
    world.reset((0.56, 0.0, 0.0))
    assert world.free()
    assert not world.clear(0.06)
    assert world.clear(0.02)


def test_a_held_thing_moves_with_the_hand_and_may_touch_the_gripper_only(world: BelievedWorld) -> None:
    objects = scenes.sodas()
    objects["soda1"] = scenes.in_hand(objects["soda1"])
    world.update(scenes.belief(objects))
    held = world.carried["right"]
    assert "soda1" not in world.standing
    assert world.free()
    (x, y, z), _ = bodies.full_pose(world.client, held.body)
    assert (x, y, z) == pytest.approx((0.445, -0.5, 1.0 - 0.069 + 0.0575), abs=1e-3)
    world.reset((0.9, 0.5, 0.0))
    with world.placed("right", scenes.on("table2", 0.0, 0.0)):
        assert world.carried == {}
    assert world.carried["right"] is held


def test_a_picked_thing_is_in_the_hand_meanwhile(world: BelievedWorld) -> None:
    order = list(world.standing)
    with world.picked("left", "soda2", scenes.HELD_SODA):
        assert "soda2" not in world.standing
        world.set_arm("left", world.robot.arm("left"))
        assert bodies.full_pose(world.client, world.carried["left"].body)[0][1] == pytest.approx(0.5, abs=1e-3)
    assert list(world.standing) == order
    item = world.standing["soda2"]
    assert bodies.pose(world.client, item.body, item.type)[:3] == pytest.approx(item.world_T_object[:3], abs=1e-9)


def test_a_thing_stands_on_the_table_below_it(world: BelievedWorld) -> None:
    table = world.table_below(world.standing["soda2"])
    assert table is not None
    assert table.anchor == "table2"
    assert [item.anchor for item in world.ground()] == list(scenes.TABLES)


def test_a_thing_that_the_robot_would_stand_in_takes_its_mere_size(world: BelievedWorld) -> None:
    beside = scenes.believed("soda", (0.40, 0.0, 0.0, 0.0), sd_m=0.03)
    world.update(scenes.belief(scenes.tables() | {"can": beside}))
    assert world.free()
    assert world.standing["can"].spread_m == 0.0


def test_the_belief_decides_and_not_what_was_asked_before(world: BelievedWorld) -> None:
    belief: Belief = scenes.belief(scenes.sodas())
    fresh = [bodies.full_pose(world.client, item.body) for item in world.standing.values()]
    world.reset((0.3, 0.3, 0.3))
    world.update(scenes.belief(scenes.sodas(sd_m=0.001), version=3))
    world.update(belief)
    assert [bodies.full_pose(world.client, item.body) for item in world.standing.values()] == fresh
    assert world.robot.base() == (0.0, 0.0, 0.0)


def test_before_a_moving_arm_all_but_the_target_is_wider(world: BelievedWorld) -> None:
    objects = scenes.sodas() | {"table1": scenes.believed("table", scenes.TABLES["table1"], 0.01)}
    world.update(scenes.belief(objects, (0.5, 0.0, 0.0)))
    plain = dict(world.standing)
    with world.wary("right", "soda1"):
        assert [a for a, item in plain.items() if world.standing[a].body == item.body] == ["soda1"]
        low, high = (corner[0] for corner in p.getAABB(world.standing["table1"].body, physicsClientId=world.client))
        assert (low, high) == pytest.approx((0.9 - 0.03, 1.7 + 0.03), abs=2e-3)
        assert world.free()
    assert world.standing == plain
    with world.narrowed(), world.wary("right"):
        assert all(item.spread_m == 0.0 for item in world.standing.values())


def test_what_an_arm_or_the_base_is_near_already_does_not_stop_the_arm(world: BelievedWorld) -> None:
    objects = scenes.sodas() | {"table1": scenes.believed("table", scenes.TABLES["table1"], 0.01)}
    for x in (0.54, 0.56):
        world.update(scenes.belief(objects, (x, 0.0, 0.0)))
        with world.wary("right"):
            assert world.free()


def test_what_is_removed_or_in_an_emptied_hand_is_nowhere_meanwhile(world: BelievedWorld) -> None:
    objects = scenes.sodas()
    objects["soda2"] = scenes.in_hand(objects["soda2"])
    world.update(scenes.belief(objects))
    before = list(world.standing)
    held = world.carried["right"]
    with world.removed(("soda1",)), world.emptied("right"):
        assert "soda1" not in world.standing
        assert world.carried == {}
        assert bodies.full_pose(world.client, held.body)[0][2] < -10.0
    assert list(world.standing) == before
    assert world.carried["right"] is held
