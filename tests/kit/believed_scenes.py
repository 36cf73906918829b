"""Beliefs about a robot among three tables, shared by the tests of planning."""

import math

from skolem.traces.messages import Belief, Hand, HsvBelief, ObjectBelief, ObjectType, Pose2, Pose4, RobotState
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import compose4

TYPES = {
    "bottle": ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.20), graspable=True),
    "carton": ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True),
    "soda": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True),
    "table": ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False),
}
TABLES: dict[str, Pose4] = {
    "table1": (1.3, 0.0, 0.0, 0.0),
    "table2": (0.0, -1.6, 0.0, -math.pi / 2.0),
    "table3": (0.0, 1.6, 0.0, math.pi / 2.0),
}
CARRYING = RobotState(torso=0.2, right_arm=CARRY["right"], left_arm=CARRY["left"])
HELD_SODA: Pose4 = (-0.005, 0.0, -0.069, 0.3)
_ANY_COLOUR = HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1))


def on(table: str, x: float, y: float, theta: float = 0.0) -> Pose4:
    """Return the world pose of an object on a table from its pose in the table's frame (metres, radians)."""
    return compose4(TABLES[table], (x, y, TYPES["table"].size_m[2], theta))


def believed(kind: str, world_T_object: Pose4, sd_m: float = 0.02, support: str | None = None) -> ObjectBelief:
    """Return a belief in an object of one type whose place has the sd `sd_m`, each axis."""
    return ObjectBelief(
        exists=1.0,
        type={kind: 1.0},
        world_T_object=world_T_object,
        covariance=(sd_m**2, 0.0, 0.0, sd_m**2, 0.0, 0.01),
        support=support,
        colour=_ANY_COLOUR,
        log_weight=(-1.0, 0.5),
    )


def in_hand(item: ObjectBelief, hand: Hand = "right", tool_T_object: Pose4 = HELD_SODA) -> ObjectBelief:
    """Return the belief in an object with the object in a hand."""
    return item.model_copy(update={"support": None, "in_hand": hand, "tool_T_object": tool_T_object})


def tables() -> dict[str, ObjectBelief]:
    """Return beliefs in the three tables with exact places."""
    return {name: believed("table", pose, 0.0) for name, pose in TABLES.items()}


def sodas(sd_m: float = 0.02) -> dict[str, ObjectBelief]:
    """Return beliefs in the three tables and a soda on each, near the edge that faces the middle of the room."""
    cans = {
        f"soda{i + 1}": believed("soda", on(table, -0.25, 0.1 * (1 - i)), sd_m, table) for i, table in enumerate(TABLES)
    }
    return tables() | cans


def belief(
    objects: dict[str, ObjectBelief],
    world_T_base: Pose2 = (0.0, 0.0, 0.0),
    version: int = 1,
    robot: RobotState = CARRYING,
) -> Belief:
    """Return a belief in these objects, without correlations."""
    return Belief(
        step=0,
        version=version,
        world_T_base=world_T_base,
        base_covariance=(0.0,) * 6,
        robot=robot,
        anchors=tuple(objects),
        objects=objects,
        keys=(),
        joint_covariance=(),
    )
