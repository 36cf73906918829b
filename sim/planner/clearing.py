"""Blockers of an activity that cannot be done from any base pose: those of the way with the fewest.

Ways are found on all sides of the object without movable objects, and then checked for collisions with those.
"""

import dataclasses
import math
from collections import Counter
from collections.abc import Iterator

import numpy as np

from skolem.sim.planner import sight, ways
from skolem.sim.planner.arm_motions import ArmPlanner
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.candidates import Candidates
from skolem.sim.planner.surveyor import Surveyor
from skolem.sim.planner.trials import Trials, is_same
from skolem.sim.planner.ways import Sweep, Way
from skolem.traces.messages import Activity, Belief, Pose2

SIDES = 8  # sides of an object on which ways are sought
TRIED_PER_SIDE, TAKEN_PER_SIDE = 6, 2  # base poses tried, and base poses from which ways are taken
SWEEPS_PER_STANCE = 4  # each with another yaw of the fingers
SURVEYS = 4  # base poses to look at a region from
WHOLE_WAYS = 4  # ways whose paths to and from the object are planned too, if nothing blocks the rest


class Clearing:
    """Finds ways in the believed world."""

    def __init__(
        self, world: BelievedWorld, arms: ArmPlanner, candidates: Candidates, trials: Trials, surveyor: Surveyor
    ) -> None:
        """Keep the world and its planners."""
        self._world = world
        self._arms = arms
        self._candidates = candidates
        self._trials = trials
        self._surveyor = surveyor

    def ways(self, activity: Activity, belief: Belief) -> list[Way]:
        """Return the ways that movable objects alone block, with their blockers, fewest first."""
        movable = tuple(a for a, item in self._world.standing.items() if item.type.graspable and a != activity.anchor)
        with self._world.removed(movable):
            bare = list(self._bare(activity, belief))
        found = [way for way in (self._blocked(way, movable) for way in bare) if way is not None]
        if activity.kind == "pick" and not any(way.blockers for way in found):
            with self._world.removed(movable):
                whole = [self._whole(way) for way in found[:WHOLE_WAYS]]
            found = [way for way in (self._blocked(way, movable) for way in whole) if way is not None]
        return sorted((way for way in found if way.blockers), key=lambda way: len(way.blockers))

    def way_from(self, activity: Activity, stance: Pose2) -> Way | None:
        """Return the unblocked way from a base pose; None if the activity cannot be done from there."""
        self._world.reset(stance)
        if activity.kind == "look_region":
            found = self._surveyor.from_here(activity.anchor)
            if found is None:
                return None
            points = self._surveyor.unseen(activity.anchor)[found.shown]
            return Way(activity.anchor, stance, found.target, points, None)
        pick = None if activity.hand is None else self._trials.pick(activity.hand, activity.anchor)
        if activity.hand is not None and pick is None:
            return None
        return self._way(activity, stance, None if pick is None else Sweep.of(pick))

    def _way(self, activity: Activity, stance: Pose2, sweep: Sweep | None) -> Way:
        """Return a way with the points of its object that must be seen from the robot's present pose."""
        item = self._world.standing[activity.anchor]
        view = sight.towards(self._world, item)
        target = sight.centre(item.type, item.world_T_object)
        return Way(activity.anchor, stance, target, np.empty((0, 3)) if view is None else view.points[0], sweep)

    def _bare(self, activity: Activity, belief: Belief) -> Iterator[Way]:
        """Yield ways in a world without movable objects."""
        if activity.kind == "look_region":
            points = self._surveyor.unseen(activity.anchor)
            for stance, found in self._surveyor.stances(activity.anchor)[:SURVEYS]:
                yield Way(activity.anchor, stance, found.target, points[found.shown], None)
            return
        for stance in self._stances(activity, belief):
            if activity.hand is None:
                yield self._way(activity, stance, None)
                continue
            yaws: set[float] = set()
            for sketch in self._arms.pick_sketches(activity.hand, activity.anchor):
                if sketch.tool_T_object[3] not in yaws:
                    yaws.add(sketch.tool_T_object[3])
                    sweep = Sweep(activity.hand, sketch.reach, sketch.lift, sketch.tool_T_object)
                    yield self._way(activity, stance, sweep)
                if len(yaws) >= SWEEPS_PER_STANCE:
                    break

    def _stances(self, activity: Activity, belief: Belief) -> Iterator[Pose2]:
        """Put the robot at base poses on all sides of the object, and yield those from which the object is seen."""
        around = self._candidates.around_object(activity, belief.world_T_base)
        x, y = self._world.standing[activity.anchor].world_T_object[:2]
        tried: Counter[int] = Counter()
        taken: Counter[int] = Counter()
        before: list[Pose2] = []
        for row in around.world_T_base:
            stance = (float(row[0]), float(row[1]), float(row[2]))
            side = round(math.atan2(stance[1] - y, stance[0] - x) / (2.0 * math.pi / SIDES)) % SIDES
            if tried[side] >= TRIED_PER_SIDE or taken[side] >= TAKEN_PER_SIDE:
                continue
            if any(is_same(stance, other) for other in before):
                continue
            before.append(stance)
            tried[side] += 1
            if not self._trials.stands(stance):
                continue
            if sight.look(self._world, self._world.standing[activity.anchor]) is not None:
                taken[side] += 1
                yield stance

    def _whole(self, way: Way) -> Way:
        """Return the way with the paths to and from the object."""
        assert way.sweep is not None
        self._world.reset(way.world_T_base)
        pick = self._trials.pick(way.sweep.hand, way.anchor)
        if pick is None:
            return way
        reach = np.vstack([pick.approach, pick.reach])
        lift = np.vstack([pick.lift, pick.carry])
        return dataclasses.replace(way, sweep=Sweep(pick.hand, reach, lift, pick.tool_T_object))

    def _blocked(self, way: Way, movable: tuple[str, ...]) -> Way | None:
        """Return the way with its blockers; None if its object is hidden even without them."""
        self._world.reset(way.world_T_base)
        blockers = set(self._world.touched() & frozenset(movable))
        hidden = self._hiders(way, movable)
        if hidden is None:
            return None
        blockers.update(hidden)
        if way.sweep is not None:
            blockers |= ways.touched(self._world, way.anchor, way.sweep)
        return dataclasses.replace(way, blockers=tuple(sorted(blockers)))

    def _hiders(self, way: Way, movable: tuple[str, ...]) -> tuple[str, ...] | None:
        """Return the objects that hide the way's object or points of its region; None if others hide it too."""
        item = self._world.standing.get(way.anchor)
        if item is not None:
            view = sight.towards(self._world, item)
            return None if view is None else sight.hiders(self._world, view, movable)
        self._world.look_at(way.target)
        met = set(self._world.hits(way.points))
        return tuple(a for a in movable if self._world.standing[a].body in met)
