"""Ways of the symbolic robot to do an activity: base poses, their blockers, and the places they need free."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from skolem.sim.space import surveys
from skolem.sim.space.activities import is_other_side
from skolem.sim.space.grasps import widest_half
from skolem.sim.space.surveys import Survey
from skolem.sim.symbolic.belief import SymbolicBelief
from skolem.sim.symbolic.corridors import CORRIDOR_M, pillar, standing_in
from skolem.sim.symbolic.hands import FAR_M, SymbolicHands
from skolem.sim.symbolic.sight import BelievedSight, Thing
from skolem.traces.messages import Activity, ObjectType, Pose2, Pose4
from skolem.traces.messages.poses import Vector3, flat

LOOK_M = 1.6  # greatest distance from the base of an object to look at
ROOM_M = 0.03  # around an object that is put down beside a way
ELSEWHERE_M = 0.5  # after a look that showed nothing new, least distance to the next stance
METRE_COST = 0.02  # share of the unseen part that a metre of driving costs

Points = NDArray[np.float64]
IsClear = Callable[[Pose4], bool]


@dataclass(frozen=True, slots=True)
class Way:
    """A base pose for an activity, and the objects that must be taken away before."""

    world_T_base: Pose2
    blockers: tuple[str, ...]


class Ways:
    """Compares the base poses for activities in one belief."""

    def __init__(self, belief: SymbolicBelief, hands: SymbolicHands) -> None:
        """Keep the belief and its hands; surveys of a region are made on first use and kept."""
        self._belief = belief
        self._hands = hands
        self._compared: dict[str, list[tuple[Pose2, Survey]]] = {}

    def free(self, activity: Activity) -> Iterator[Pose2]:
        """Return the base poses from which a pick or a look can be done, in order of preference."""
        if activity.kind == "look_region":
            return (stance for stance, _ in self.surveyed(activity.anchor))
        ways = self._all(activity) if activity.kind == "pick" else chain(self.sure(activity), self._all(activity))
        return (way.world_T_base for way in ways if not way.blockers)

    def sure(self, activity: Activity) -> Iterator[Way]:
        """Return the ways to look at an object that show it at all its possible places."""
        doubt = self._belief.doubt(activity.anchor)
        return (way for way in self._all(activity, doubt) if not way.blockers)

    def best(self, activity: Activity, can_do_here: bool) -> Way | None:
        """Return the way with the fewest blockers: the one from here if `can_do_here`; None if there is none."""
        if can_do_here:
            return Way(self._belief.belief.world_T_base, ())
        if activity.kind == "look_region":
            stance = next(self.free(activity), None)
            return None if stance is None else Way(stance, ())
        best: Way | None = None
        for way in self._all(activity):
            if best is None or len(way.blockers) < len(best.blockers):
                best = way
            if not best.blockers:
                break
        return best

    def in_corridor(self, world_T_base: Pose2, anchor: str) -> tuple[str, ...]:
        """Return the anchors in the corridor of a hand from a base pose to an object."""
        believed = self._belief
        return standing_in(world_T_base[:2], believed.pillar(anchor), believed.pillars(), CORRIDOR_M)

    def _all(self, activity: Activity, doubt_m: float = 0.0) -> Iterator[Way]:
        believed, anchor = self._belief, activity.anchor
        target, support = flat(believed.object(anchor).world_T_object), believed.object(anchor).support
        if activity.kind == "pick":
            for stance in believed.standoffs(target, support, FAR_M):
                if activity.hand is not None and self._hands.pick(activity.hand, anchor, stance) is not None:
                    yield Way(stance, self.in_corridor(stance, anchor))
            return
        is_table = believed.type(anchor).shape == "table"
        for stance in (*believed.standoffs(target, support, FAR_M), *believed.ring(target[:2])):
            if activity.elsewhere and not is_other_side(stance, believed.belief.world_T_base, target):
                continue
            blockers = (
                () if is_table else believed.sight(stance, anchor).hiders(anchor, believed.movable(anchor), doubt_m)
            )
            if blockers is not None:
                yield Way(stance, tuple(sorted(blockers)))

    # ---------------------------------------------------------------- regions

    def unseen(self, region: str) -> Points:
        """Return the unseen points of a region, shape (n, 3), metres, world; empty if there is no such region."""
        at = self._belief.belief.regions.get(region)
        if at is None or at.support not in self._belief.belief.objects:
            return np.empty((0, 3))
        world_T_support = self._belief.object(at.support).world_T_object
        return surveys.unseen_points(at, world_T_support, self._belief.type(at.support).size_m[2])

    def survey_here(self, region: str) -> Survey | None:
        """Return the look at a region from here; None if the robot must go elsewhere."""
        found = surveys.survey(self._belief.sight(self._belief.belief.world_T_base), self.unseen(region))
        if found is None or self._was_taken(found):
            return None
        return found if surveys.is_worth_it(found, lambda: [other for _, other in self.surveyed(region)]) else None

    def surveyed(self, region: str) -> list[tuple[Pose2, Survey]]:
        """Return base poses that show a part of a region, each with its survey, best first."""
        if region not in self._compared:
            found = self._surveys(self.unseen(region))
            self._compared[region] = sorted(found, key=lambda pair: -self._value(*pair))
        return self._compared[region]

    def _surveys(self, points: Points) -> list[tuple[Pose2, Survey]]:
        believed = self._belief
        if not len(points):
            return []
        just = surveys.survey(believed.sight(believed.belief.world_T_base), points)
        nearest = ELSEWHERE_M if just is not None and self._was_taken(just) else 0.0
        out = []
        for stance in believed.ring((float(points[:, 0].mean()), float(points[:, 1].mean()))):
            found = surveys.survey(believed.sight(stance), points)
            if found is not None and found.share >= surveys.LEAST_SHARE and self._far(stance) >= nearest:
                out.append((stance, found))
        return out

    def _value(self, stance: Pose2, found: Survey) -> float:
        return round(found.share - METRE_COST * self._far(stance), 9)

    def _far(self, stance: Pose2) -> float:
        return self._belief.drive_length(stance)[0]

    def _was_taken(self, found: Survey) -> bool:
        return surveys.was_taken(found, self._belief.belief.robot.head)

    # ---------------------------------------------------------------- leaving room

    def leaves_room(self, activity: Activity, way: Way, kind: ObjectType) -> IsClear:
        """Return a test of whether an object of a type at a world pose leaves a way of an activity free."""
        if activity.kind == "pick":
            target = self._belief.pillar(activity.anchor)
            return lambda at: not standing_in(way.world_T_base[:2], target, [pillar("", kind, at, ROOM_M)], CORRIDOR_M)
        wide = 2.0 * (widest_half(kind) + ROOM_M)
        round_kind = ObjectType(shape="cylinder", size_m=(wide, wide, kind.size_m[2]), graspable=True)
        points = self._looked_at(activity, way)

        def is_clear(at: Pose4) -> bool:
            alone = BelievedSight(way.world_T_base, self._belief.belief.robot.torso, [Thing("", round_kind, at)])
            middle = points.mean(axis=0)
            target: Vector3 = (float(middle[0]), float(middle[1]), float(middle[2]))
            alone.look_at(target)
            return bool(alone.unhidden(points).all())

        return is_clear

    def _looked_at(self, activity: Activity, way: Way) -> Points:
        """Return the points that must be seen along a way, shape (n, 3), metres, world."""
        sight = self._belief.sight(way.world_T_base)
        if activity.kind == "look_region":
            points = self.unseen(activity.anchor)
            found = surveys.survey(sight, points)
            return points if found is None else points[found.shown]
        return sight.outline(activity.anchor)
