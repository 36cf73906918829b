"""A world without physics with two tables and two objects, and beliefs about it, shared by tests."""

import math
from collections.abc import Sequence

from skolem.reasoner.protocols import Geometry
from skolem.sim.symbolic.arm import reach
from skolem.sim.symbolic.geometry import SymbolicGeometry
from skolem.sim.symbolic.world import SymbolicWorld
from skolem.sim.truth.bodies import TrueBody
from skolem.traces.messages import (
    Action,
    ActionResult,
    Belief,
    Command,
    Hand,
    HsvBelief,
    MoveBase,
    NoiseModel,
    ObjectBelief,
    ObjectType,
    Observation,
    Pick,
    Pose4,
    TrueObject,
)
from skolem.traces.messages.arm import CARRY

TYPES = {
    "bottle": ObjectType(shape="cylinder", size_m=(0.06, 0.06, 0.2), graspable=True),
    "carton": ObjectType(shape="box", size_m=(0.06, 0.09, 0.14), graspable=True),
    "soda": ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True),
    "table": ObjectType(shape="table", size_m=(0.8, 1.2, 0.68), graspable=False),
}
EXACT = NoiseModel(
    depth_sd_scale=0.0,
    extrinsics_sd_m=0.0,
    extrinsics_sd_rad=0.0,
    found=1.0,
    false_per_look=0.0,
    type_right=1.0,
    colour_gain=1.0,
    colour_sd_rgb=0.0,
    odometry_sd_m=0.0,
    odometry_sd_per_m=0.0,
    odometry_sd_rad=0.0,
    odometry_sd_per_rad=0.0,
    wrist_sd_newton=0.0,
    wrist_drift_newton=0.0,
    grasp_sd_m=0.0,
    grasp_sd_rad=0.0,
    place_sd_m=0.0,
    place_sd_rad=0.0,
)
BODIES = (
    TrueBody("table1", "table", (1.3, 0.0, 0.0, 0.0), (0.1, 0.5, 0.6), 30.0),
    TrueBody("table2", "table", (0.0, -1.6, 0.0, -math.pi / 2), (0.1, 0.5, 0.6), 30.0),
    TrueBody("green", "soda", (1.05, 0.1, 0.68, 0.3), (0.33, 0.9, 0.8), 0.35),
    TrueBody("red", "carton", (1.1, -0.3, 0.68, 0.3), (0.99, 0.9, 0.8), 0.5),
)
DRIVE = MoveBase(start_T_waypoint=((0.43, 0.1, 0.0),))  # ends where a hand reaches the green can


def world(noise: NoiseModel = EXACT, seed: int = 0, bodies: Sequence[TrueBody] = BODIES) -> SymbolicWorld:
    return SymbolicWorld(TYPES, bodies, (0.0, 0.0, 0.0), 0.2, noise, seed)


def do(there: SymbolicWorld, command: Command, step: int = 0) -> tuple[ActionResult, Observation]:
    return there.execute(Action(step=step, op="test", args=(), command=command))


def thing(there: SymbolicWorld, name: str) -> TrueObject:
    return next(item for item in there.state(0).objects if item.id == name)


def picking(x: float, y: float, hand: Hand = "right") -> Pick:
    """Return a pick of a can at (x, y) on table1 (metres, world frame), from the end of DRIVE."""
    tool: Pose4 = (x - 0.43, y - 0.1, 0.75, 0.0)
    joints = reach(hand, 0.2, tool)
    assert joints is not None
    path = (joints,)
    return Pick(
        hand=hand, approach=path, reach=path, lift=path, carry=(CARRY[hand],), tool_T_object=(0.0, 0.0, -0.07, 0.0)
    )


def belief_of(there: SymbolicWorld, held: Pose4 | None = None) -> Belief:
    """Return a belief equal to the truth."""
    state = there.state(0)
    return Belief(
        step=0,
        version=0,
        world_T_base=state.world_T_base,
        base_covariance=(0.0,) * 6,
        robot=there.robot_state(),
        anchors=tuple(item.id for item in state.objects),
        objects={
            item.id: ObjectBelief(
                exists=1.0,
                type={item.type: 1.0},
                world_T_object=item.world_T_object,
                covariance=(0.0,) * 6,
                support=item.on,
                in_hand=item.in_hand,
                tool_T_object=held if item.in_hand else None,
                colour=HsvBelief(mean=item.hsv, variance=(0.1, 0.1, 0.1)),
                log_weight=(0.0, 1.0),
            )
            for item in state.objects
        },
        keys=(),
        joint_covariance=(),
    )


def geometry(there: SymbolicWorld, held: Pose4 | None = None) -> Geometry:
    answers = SymbolicGeometry(TYPES)
    answers.sync(belief_of(there, held))
    return answers
