"""Kinematics of the symbolic robot's arms: the PR2's arms without meshes.

Joint angles have the same meaning as on the full model, so that the hand's pose can be computed from them.
"""

import math

import numpy as np

from skolem.sim.robot.ik import all_solutions, pan_grid
from skolem.sim.robot.rotations import about, rotation
from skolem.traces.messages import Hand, Joints7, Pose4
from skolem.traces.messages.arm import CARRY, CHAIN, shoulder

PANS = 24


def base_T_tool(hand: Hand, torso: float, joints: Joints7) -> Pose4:
    """Return the tool frame in base_footprint: its origin and the heading of its x axis."""
    axes = np.eye(3)
    origin = np.array(shoulder(hand, torso))
    for (axis, length), angle in zip(CHAIN, joints, strict=True):
        axes = axes @ about(axis, angle)
        origin = origin + length * axes[:, 0]
    x, y, z = origin.tolist()
    return (x, y, z, math.atan2(axes[1, 0], axes[0, 0]))


def reach(hand: Hand, torso: float, base_T_goal: Pose4) -> Joints7 | None:
    """Return the configuration nearest to the carry pose that has the tool upright at a pose, or None."""
    x, y, z, theta = base_T_goal
    found = all_solutions(hand, torso, np.array([x, y, z]), rotation(theta), pan_grid(hand, PANS))
    if not len(found):
        return None
    a, b, c, d, e, f, g = found[np.abs(found - CARRY[hand]).max(axis=1).argmin()].tolist()
    return (a, b, c, d, e, f, g)
