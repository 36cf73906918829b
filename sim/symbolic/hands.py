"""Picks and places of the symbolic robot from a base pose, by closed-form kinematics of the arms."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.space.grasps import STEEPEST_RAD, YAWS, approach_yaws, back_off, grasp
from skolem.sim.symbolic.arm import reach
from skolem.sim.symbolic.belief import SymbolicBelief
from skolem.traces.messages import Hand, Joints7, Pick, Place, Pose2, Pose4
from skolem.traces.messages.arm import CARRY, shoulder
from skolem.traces.messages.poses import compose4, inverse4, wrap_half_open

NEAR_M, FAR_M = 0.5, 0.8  # from the base to the target of a hand
FACING_RAD = 0.5
LIFT_M = 0.05


@dataclass(frozen=True, slots=True)
class Reach:
    """Arm configurations before, at and above a grasp or a release."""

    before: Joints7
    at: Joints7
    above: Joints7


class SymbolicHands:
    """Answers about one belief; blockers are not considered here."""

    def __init__(self, belief: SymbolicBelief) -> None:
        """Keep the belief."""
        self._belief = belief

    def pick(self, hand: Hand, anchor: str, world_T_base: Pose2) -> Pick | None:
        """Return the pick of an object from a base pose, or None."""
        believed, kind = self._belief.object(anchor), self._belief.type(anchor)
        base_T_object = self._belief.base_T(believed.world_T_object, world_T_base)
        if believed.in_hand is not None or not _within_reach(base_T_object):
            return None
        for yaw in self._straightest(hand, base_T_object, approach_yaws(kind, base_T_object[3])):
            held = grasp(kind, base_T_object, yaw)
            arm = self._reach(hand, held.base_T_tool, back_off(kind, 0.0))
            if arm is not None:
                return Pick(
                    hand=hand,
                    approach=(arm.before,),
                    reach=(arm.at,),
                    lift=(arm.above,),
                    carry=(CARRY[hand],),
                    tool_T_object=held.tool_T_object,
                )
        return None

    def place(self, hand: Hand, anchor: str, world_T_release: Pose4, world_T_base: Pose2) -> Place | None:
        """Return the placement, from a base pose, of the held object at `world_T_release`, or None.

        An object may be put down with any heading, so the hand comes as straight as possible.
        """
        believed, kind = self._belief.object(anchor), self._belief.type(anchor)
        base_T_release = self._belief.base_T(world_T_release, world_T_base)
        if believed.in_hand != hand or believed.tool_T_object is None or not _within_reach(base_T_release):
            return None
        for yaw in self._straightest(hand, base_T_release, np.linspace(-STEEPEST_RAD, STEEPEST_RAD, YAWS)):
            turned = (*base_T_release[:3], wrap_half_open(yaw + believed.tool_T_object[3]))
            arm = self._reach(hand, compose4(turned, inverse4(believed.tool_T_object)), back_off(kind, 0.0))
            if arm is not None:
                return Place(
                    hand=hand, approach=(arm.above,), lower=(arm.at,), retreat=(arm.before,), carry=(CARRY[hand],)
                )
        return None

    def _straightest(self, hand: Hand, base_T_target: Pose4, yaws: NDArray[np.float64]) -> Iterator[float]:
        """Yield the yaws of the fingers, shape (n,), those straight away from the shoulder first."""
        sx, sy, _ = shoulder(hand, self._belief.belief.robot.torso)
        straight = math.atan2(base_T_target[1] - sy, base_T_target[0] - sx)
        angles: list[float] = yaws.tolist()
        yield from sorted(angles, key=lambda yaw: (abs(wrap_half_open(yaw - straight)), yaw))

    def _reach(self, hand: Hand, base_T_tool: Pose4, back_m: float) -> Reach | None:
        """Return the arm configurations at a tool pose, `back_m` behind it and a little above it, or None."""
        torso = self._belief.belief.robot.torso
        before = reach(hand, torso, compose4(base_T_tool, (-back_m, 0.0, 0.0, 0.0)))
        at = reach(hand, torso, base_T_tool)
        above = reach(hand, torso, compose4(base_T_tool, (0.0, 0.0, LIFT_M, 0.0)))
        return None if before is None or at is None or above is None else Reach(before, at, above)


def _within_reach(base_T_target: Pose4) -> bool:
    """Return whether a target lies in the reachable ring before the base."""
    x, y = base_T_target[:2]
    return NEAR_M <= math.hypot(x, y) <= FAR_M and abs(math.atan2(y, x)) <= FACING_RAD
