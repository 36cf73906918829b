"""Where the hands of the symbolic robot are: the PR2's arms without its meshes.

Joint angles mean what they mean on the real model, so that whoever computes a hand's place from them gets it right.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from skolem.sim.robot.ik import (
    FOREARM_M,
    PAN_TO_LIFT_M,
    SHOULDER_M,
    UPPER_ARM_M,
    WRIST_TO_TOOL_M,
    all_solutions,
    pan_grid,
)
from skolem.sim.robot.poses import rotation
from skolem.traces.messages import Hand, Joints7, Pose4

CARRY: Mapping[Hand, Joints7] = MappingProxyType(
    {  # those of skolem.sim.robot.pr2, which cannot be imported without the physics engine
        "right": (-0.72, 0.84865, 0.08833, -2.15891, -2.34645, -1.42687, 2.91387),
        "left": (0.72, 0.84865, -0.08833, -2.15891, 2.34645, -1.42687, -2.91387),
    }
)
PANS = 24
# joint axis, and the way to the next joint along x, from the shoulder's pan to the tool
_CHAIN = (
    ("z", PAN_TO_LIFT_M),
    ("y", 0.0),
    ("x", UPPER_ARM_M),
    ("y", 0.0),
    ("x", FOREARM_M),
    ("y", 0.0),
    ("x", WRIST_TO_TOOL_M),
)


def shoulder(hand: Hand, torso: float) -> tuple[float, float, float]:
    """Return the axis of the shoulder's pan in base_footprint."""
    x, y, z = SHOULDER_M
    return (x, y if hand == "left" else -y, z + torso)


def base_T_tool(hand: Hand, torso: float, joints: Joints7) -> Pose4:
    """Return the tool frame in base_footprint by its origin and the heading of its x axis."""
    axes = np.eye(3)
    origin = np.array(shoulder(hand, torso))
    for (axis, length), angle in zip(_CHAIN, joints, strict=True):
        axes = axes @ _about(axis, angle)
        origin = origin + length * axes[:, 0]
    x, y, z = origin.tolist()
    return (x, y, z, math.atan2(axes[1, 0], axes[0, 0]))


def reach(hand: Hand, torso: float, base_T_goal: Pose4) -> Joints7 | None:
    """Return the configuration nearest to the carry pose that holds the tool upright at a pose, or None."""
    x, y, z, theta = base_T_goal
    found = all_solutions(hand, torso, np.array([x, y, z]), rotation(theta), pan_grid(hand, PANS))
    if not len(found):
        return None
    a, b, c, d, e, f, g = found[np.abs(found - CARRY[hand]).max(axis=1).argmin()].tolist()
    return (a, b, c, d, e, f, g)


def _about(axis: str, angle: float) -> NDArray[np.float64]:
    """Return the rotation about a coordinate axis, shape (3, 3)."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[j, i] = math.sin(angle)
    turn[i, j] = -math.sin(angle)
    return turn
