import math
from collections.abc import Iterator

import numpy as np
import pytest
from kit import believed_scenes as scenes

from skolem.sim.planner import sight
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.robot.pr2 import HEAD
from skolem.traces.messages import Joints7, RobotState

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def world() -> Iterator[BelievedWorld]:
    world = BelievedWorld(scenes.TYPES)
    yield world
    world.close()


@pytest.mark.parametrize("anchor", ["soda1", "soda2", "soda3", "table1", "table2", "table3"])
def test_from_the_middle_of_the_room_everything_can_be_looked_at(world: BelievedWorld, anchor: str) -> None:
    world.update(scenes.belief(scenes.sodas()))
    item = world.standing[anchor]
    turned = sight.look(world, item)
    assert turned is not None
    assert world.robot.joints(HEAD) == turned
    eye, rotation = world.robot.camera_pose()
    ahead = np.subtract(sight.centre(item.type, item.world_T_object), eye) @ rotation
    assert math.hypot(ahead[1], ahead[2]) < 1e-3 * ahead[0]


def test_what_is_too_far_or_too_near_or_behind_is_not_looked_at(world: BelievedWorld) -> None:
    far, near = (-0.9, 0.0, 0.0), (0.98, 0.0, 0.0)
    for world_T_base in (far, near):
        world.update(scenes.belief({"can": scenes.believed("soda", (1.05, 0.1, 0.68, 0.0))}, world_T_base))
        assert sight.look(world, world.standing["can"]) is None
    world.update(scenes.belief({"can": scenes.believed("soda", (1.05, 0.1, 0.68, 0.0))}, (2.0, 0.1, 0.0)))
    assert sight.look(world, world.standing["can"]) is None


def test_a_thing_behind_another_is_not_seen(world: BelievedWorld) -> None:
    objects = scenes.tables() | {"can": scenes.believed("soda", (1.2, 0.0, 0.68, 0.0))}
    world.update(scenes.belief(objects))
    assert sight.look(world, world.standing["can"]) is not None
    bottle = scenes.believed("bottle", (1.13, 0.0, 0.68, 0.0), sd_m=0.02)
    world.update(scenes.belief(objects | {"bottle": bottle}))
    assert sight.look(world, world.standing["can"]) is None


def test_what_is_believed_to_be_in_a_thing_does_not_hide_it(world: BelievedWorld) -> None:
    objects = scenes.tables() | {"can": scenes.believed("soda", (1.2, 0.0, 0.68, 0.0))}
    bottle = scenes.believed("bottle", (1.15, 0.0, 0.68, 0.0), sd_m=0.02)
    world.update(scenes.belief(objects | {"bottle": bottle}))
    for name in ("can", "bottle"):
        item = world.standing[name]
        assert sight.look(world, item) is not None
        view = sight.towards(world, item)
        assert view is not None
        assert sight.hiders(world, view, ("can", "bottle")) == ()


def test_the_robot_s_own_arm_hides_things(world: BelievedWorld) -> None:
    objects = {"can": scenes.believed("soda", (0.9, 0.0, 0.68, 0.0))}
    stretched: Joints7 = (0.25, 0.0, 0.0, -0.5, 0.0, -0.3, 0.0)
    for arm, seen in ((scenes.CARRYING.right_arm, True), (stretched, False)):
        robot = RobotState(torso=0.2, right_arm=arm, left_arm=scenes.CARRYING.left_arm)
        world.update(scenes.belief(objects, (0.1, 0.0, 0.0), robot=robot))
        assert (sight.look(world, world.standing["can"]) is not None) is seen


def test_a_place_on_a_table_is_seen_unless_something_stands_there(world: BelievedWorld) -> None:
    world.update(scenes.belief(scenes.sodas()))
    table = world.standing["table1"]
    assert sight.look_at_spot(world, table, (0.0, -0.2)) is not None
    assert sight.look_at_spot(world, table, (-0.25, 0.1)) is None
