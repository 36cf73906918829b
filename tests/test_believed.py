import math
from collections.abc import Iterator

import believed_scenes as scenes
import numpy as np
import pytest

from skolem.sim import bodies
from skolem.sim.believed import BelievedWorld
from skolem.sim.doubt import relative_covariance
from skolem.sim.poses import compose2, inverse2, raised
from skolem.traces.messages import Belief, Pose2

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


def test_doubt_shared_with_the_base_is_no_doubt() -> None:
    """If all that is unknown is where the base stands, an object seen from it has no doubt at all."""
    world_T_base: Pose2 = (0.5, -0.4, 0.6)
    base_T_object: Pose2 = (0.8, 0.6, 0.3)
    x, y, theta = inverse2(base_T_object)
    c, s = math.cos(theta), math.sin(theta)
    adjoint = np.array([[c, -s, y], [s, c, -x], [0.0, 0.0, 1.0]])
    root = np.random.default_rng(0).normal(size=(3, 3)) * 0.05
    of_base = root @ root.T
    joint = np.block([[of_base, of_base @ adjoint.T], [adjoint @ of_base, adjoint @ of_base @ adjoint.T]])
    soda = scenes.believed("soda", raised(compose2(world_T_base, base_T_object), 0.68))
    belief = scenes.belief({"soda1": soda}, world_T_base).model_copy(
        update={"keys": ("base", "soda1"), "joint_covariance": tuple(joint[np.triu_indices(6)].tolist())}
    )
    assert relative_covariance(belief, "soda1") == pytest.approx(np.zeros((3, 3)), abs=1e-12)


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


def test_without_a_row_in_the_joint_covariance_the_marginal_counts() -> None:
    belief = scenes.belief(scenes.sodas(sd_m=0.02))
    assert relative_covariance(belief, "soda1")[:2, :2] == pytest.approx(np.eye(2) * 0.0004)
