"""Trials of activities from base poses in the believed world.

Cheap tests come first and whole motions last; each kind has a limit by count, never by time.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner import sight
from skolem.sim.planner.arm_motions import ArmPlanner, Spots
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.candidates import Candidates
from skolem.sim.planner.stances import Stances
from skolem.sim.space.activities import is_other_side
from skolem.traces.messages import SENSING_HAND, Activity, Belief, Command, Hand, LookAt, Pick, Pose2, Weigh
from skolem.traces.messages.poses import wrap_half_open

Floats = NDArray[np.float64]

STANCE_MARGIN_M = 0.04  # least distance of the robot to all objects where it stops
SAME_M, SAME_RAD = 0.08, 0.2  # stances nearer than this to one that failed are skipped
SAME_VIEW_M = 0.15  # ... whatever their heading, if the object was hidden


@dataclass(frozen=True, slots=True)
class Effort:
    """The dear tests that a search of stances may make.

    Attributes:
        sketched: Stances at which the motion of the arm near the object is sought.
        joined: ... and at which whole motions are planned.
        apart_m: A stance nearer than this to a failed one, with a heading within `apart_rad` of its, is skipped.
    """

    sketched: int
    joined: int
    apart_m: float
    apart_rad: float


# The likeliest stances first, however near to one another; if none serves, others from all sides, farther apart.
EFFORTS = (Effort(16, 4, SAME_M, SAME_RAD), Effort(40, 8, 0.2, 0.5))


@dataclass(frozen=True, slots=True)
class Task:
    """An activity, with the possible spots if it is a place, and the stances where motions were sought in vain."""

    activity: Activity
    spots: Spots | None = None
    in_vain: list[Pose2] = field(default_factory=list)


class Trials:
    """Tries activities with the robot at any pose of the believed world."""

    def __init__(self, world: BelievedWorld, arms: ArmPlanner, candidates: Candidates) -> None:
        """Keep the world and its planners."""
        self._world = world
        self._arms = arms
        self._candidates = candidates

    def possible(self, activity: Activity) -> bool:
        """Return whether the present hands and objects allow the activity at all."""
        world, hand = self._world, activity.hand
        if activity.kind == "look":
            return activity.anchor in world.standing
        if hand is None:
            return False
        carried = world.carried.get(hand)
        if activity.kind == "pick":
            item = world.standing.get(activity.anchor)
            return carried is None and item is not None and item.type.graspable
        if carried is None or carried.anchor != activity.anchor:
            return False
        if activity.kind == "place":
            table = world.standing.get(activity.support or "")
            return table is not None and table.type.shape == "table"
        return activity.kind == "weigh" and hand == SENSING_HAND

    def here(self, task: Task) -> Command | None:
        """Return the command from the robot's present pose, or None; the activity must be possible."""
        activity, hand = task.activity, task.activity.hand
        if hand is None:
            turned = sight.look(self._world, self._world.standing[activity.anchor])
            return None if turned is None else LookAt(pan=turned[0], tilt=turned[1])
        if activity.kind == "pick":
            return self.pick(hand, activity.anchor)
        if task.spots is not None and activity.support is not None:
            with self._world.wary(hand):
                return self._arms.place(hand, activity.support, task.spots)
        return Weigh(hand=hand)

    def pick(self, hand: Hand, anchor: str) -> Pick | None:
        """Return the whole pick of a standing object from the robot's present pose, or None."""
        with self._world.wary(hand, anchor):
            return self._arms.pick(hand, anchor)

    def serving(self, task: Task, belief: Belief) -> Iterator[Pose2]:
        """Yield the base poses from which an activity can be done and its object or spot is seen, best first."""
        candidates, places = self._around(task, belief.world_T_base)
        asked = [
            ((float(row[0]), float(row[1]), float(row[2])), places[int(target)])
            for row, target in zip(candidates.world_T_base, candidates.target, strict=True)
        ]
        asked = [pair for pair in asked if self._is_asked_for(pair[0], task.activity, belief)]
        failed: list[Pose2] = []
        for effort in EFFORTS:
            serves = False
            for stance in self._tried(task, asked, effort, failed):
                serves = True
                yield stance
            if serves or task.activity.hand is None:
                return

    def _tried(
        self, task: Task, candidates: list[tuple[Pose2, Floats]], effort: Effort, failed: list[Pose2]
    ) -> Iterator[Pose2]:
        """Yield those of the candidate stances that serve; add those that do not to `failed`.

        Cheap tests are not counted: every candidate is tested whether the robot stands there and sees the place.
        """
        looks = task.activity.hand is None
        hidden: list[Pose2] = []
        sketched = joined = 0
        for stance, place in candidates:
            if sketched >= effort.sketched or joined >= effort.joined:
                return
            if any(is_same(stance, other, effort.apart_m, effort.apart_rad) for other in failed):
                continue
            if any(math.dist(stance[:2], other[:2]) < SAME_VIEW_M for other in hidden):
                continue
            if not self.stands(stance):
                failed.append(stance)
            elif not self._sees(task, place):
                (hidden if looks else failed).append(stance)
            elif looks:
                yield stance
            else:
                sketched += 1
                if self._sketch(task):
                    joined += 1
                    if self.here(task) is not None:
                        yield stance
                        continue
                failed.append(stance)
                task.in_vain.append(stance)

    def _is_asked_for(self, stance: Pose2, activity: Activity, belief: Belief) -> bool:
        """Return whether a stance is allowed: after a look in vain it must be on another side of the object."""
        at = self._world.standing[activity.anchor].world_T_object if activity.elsewhere else None
        return at is None or is_other_side(stance, belief.world_T_base, at)

    def stands(self, stance: Pose2) -> bool:
        """Put the robot at a stance and return whether it keeps its distance there."""
        self._world.reset(stance)
        return self._world.free() and self._world.clear(STANCE_MARGIN_M)

    def _around(self, task: Task, here: Pose2) -> tuple[Stances, Floats]:
        activity = task.activity
        if task.spots is None or activity.hand is None or activity.support is None:
            return self._candidates.around_object(activity, here), np.zeros((1, 2))
        table = self._world.standing[activity.support]
        carried = self._world.carried[activity.hand]
        below_tool_m = -carried.tool_T_object[2]
        return self._candidates.around_spots(table, activity.hand, carried.type, below_tool_m, task.spots, here)

    def _sees(self, task: Task, place: Floats) -> bool:
        """Return whether the object, or the spot for it in the table's frame, is seen from the robot's present pose."""
        if task.activity.support is not None:
            spot = (float(place[0]), float(place[1]))
            return sight.look_at_spot(self._world, self._world.standing[task.activity.support], spot) is not None
        return sight.look(self._world, self._world.standing[task.activity.anchor]) is not None

    def _sketch(self, task: Task) -> bool:
        """Return whether the arm motion near the object is feasible; paths to and from it are not planned."""
        activity, hand = task.activity, task.activity.hand
        assert hand is not None
        if task.spots is not None and activity.support is not None:
            with self._world.wary(hand):
                return next(self._arms.place_sketches(hand, activity.support, task.spots), None) is not None
        with self._world.wary(hand, activity.anchor):
            return next(self._arms.pick_sketches(hand, activity.anchor), None) is not None


def is_same(a: Pose2, b: Pose2, apart_m: float = SAME_M, apart_rad: float = SAME_RAD) -> bool:
    """Return whether two base poses are so near that a failure at one implies, or suggests, a failure at the other."""
    return math.dist(a[:2], b[:2]) < apart_m and abs(wrap_half_open(a[2] - b[2])) < apart_rad
