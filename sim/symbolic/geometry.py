"""The geometry of the symbolic robot, by distances and closed-form arm kinematics alone.

It answers the same questions of the reasoner as the planner with collision checking, in a fraction of the time: the
base drives in a straight line, a hand comes through a straight corridor, a camera sees along rays.
"""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from skolem.sim.space.grasps import RELEASE_M, spots, widest_half
from skolem.sim.symbolic.belief import BODY_M, SymbolicBelief
from skolem.sim.symbolic.hands import FAR_M, SymbolicHands
from skolem.sim.symbolic.view import head_towards
from skolem.sim.symbolic.ways import LOOK_M, IsClear, Way, Ways
from skolem.traces.messages import (
    Activity,
    Belief,
    Command,
    Hand,
    LookAt,
    MoveBase,
    ObjectType,
    Pick,
    Place,
    Pose2,
    Weigh,
)
from skolem.traces.messages.poses import compose2, flat, inverse2, raised

SPOTS = 24  # number of spots on a table that are tried, best first


class SymbolicGeometry:
    """Answers about the belief of the last `sync`."""

    def __init__(self, types: Mapping[str, ObjectType]) -> None:
        """Keep the types; there is no belief yet."""
        self._types = dict(types)
        self._belief: Belief | None = None

    def sync(self, belief: Belief) -> None:
        """Take over the believed world."""
        if belief != self._belief:
            self._belief = belief
            self._believed = SymbolicBelief(self._types, belief)
            self._hands = SymbolicHands(self._believed)
            self._ways = Ways(self._believed, self._hands)

    def close(self) -> None:
        """Do nothing: there is no physics client."""

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from where the robot stands, or None."""
        match activity.kind, activity.hand, activity.support:
            case "look", _, _:
                return self._look(activity)
            case "look_region", _, _:
                found = self._ways.survey_here(activity.anchor)
                return None if found is None else LookAt(pan=found.head[0], tilt=found.head[1])
            case "pick", ("right" | "left") as hand, _:
                return None if self._believed.full(hand) else self._pick(hand, activity.anchor)
            case "place", ("right" | "left") as hand, str(support):
                return self._place(hand, activity, support, self._now.world_T_base)
            case "weigh", ("right" | "left") as hand, _:
                return Weigh(hand=hand) if self._believed.object(activity.anchor).in_hand == hand else None
        return None

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a straight drive to where `activity` can be done, or None."""
        stance: Pose2 | None = None
        if activity.kind == "place" and activity.support is not None:
            stance = self._to_place(activity, activity.support)
        elif self._is_open(activity):
            stance = next(self._ways.free(activity), None)
        if stance is None:
            return None
        return MoveBase(start_T_waypoint=(compose2(inverse2(self._now.world_T_base), stance),))

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        """Return the blockers of the way with the fewest, sorted; empty if that is free or there is no way."""
        way = self._way(activity) if self._is_open(activity) else None
        return () if way is None else way.blockers

    @property
    def _now(self) -> Belief:
        return self._believed.belief

    def _is_open(self, activity: Activity) -> bool:
        """Return whether the activity is a look or a pick of an object in no hand, or a look at a region."""
        if activity.kind == "look_region":
            return True
        item = self._now.objects.get(activity.anchor)
        return activity.kind in ("look", "pick") and item is not None and item.in_hand is None

    def _way(self, activity: Activity) -> Way | None:
        """Return the way of an activity with an empty hand."""
        if activity.kind == "pick" and activity.hand is not None:
            return self._ways.best(activity, self._pick(activity.hand, activity.anchor) is not None)
        return self._ways.best(activity, self.ready(activity) is not None)

    def _look(self, activity: Activity) -> LookAt | None:
        """Return the look from here; None if the object may be hidden and another stance is surer."""
        believed, anchor = self._believed, activity.anchor
        x, y, z, _ = believed.base_T(believed.object(anchor).world_T_object)
        if believed.object(anchor).in_hand is not None or math.hypot(x, y) > LOOK_M:
            return None
        is_table = believed.type(anchor).shape == "table"
        if not is_table:
            sight = believed.sight(self._now.world_T_base, anchor)
            if sight.hiders(anchor, ()) is None:
                return None
            if sight.hiders(anchor, (), believed.doubt(anchor)) is None and next(self._ways.sure(activity), None):
                return None
        if activity.elsewhere and self.approach(activity) is not None:
            return None
        middle = z + believed.type(anchor).size_m[2] * (1.0 if is_table else 0.5)
        head = head_towards(self._now.robot.torso, np.array([x, y, middle]))
        return None if head is None else LookAt(pan=head[0], tilt=head[1])

    def _pick(self, hand: Hand, anchor: str) -> Pick | None:
        """Return the pick from here; None if the object is in a hand, blocked or out of reach."""
        here = self._now.world_T_base
        if self._believed.object(anchor).in_hand is not None or self._ways.in_corridor(here, anchor):
            return None
        return self._hands.pick(hand, anchor, here)

    def _place(self, hand: Hand, activity: Activity, support: str, world_T_base: Pose2) -> Place | None:
        """Return the placement of the held object on the best spot within reach from a base pose, or None."""
        top = self._believed.type(support).size_m[2]
        releases = ((x, y, top + RELEASE_M, theta) for x, y, theta in self._spots(activity, support))
        found = (self._hands.place(hand, activity.anchor, release, world_T_base) for release in releases)
        return next((place for place in found if place is not None), None)

    def _to_place(self, activity: Activity, support: str) -> Pose2 | None:
        """Return the nearest base pose from which the hand reaches a spot on a table, or None."""
        hand = activity.hand
        found = [self._believed.standoffs(spot, support, FAR_M)[:1] for spot in self._spots(activity, support)]
        stances = sorted((pose for poses in found for pose in poses), key=self._believed.drive_length)
        can_place = (at for at in stances if hand is not None and self._place(hand, activity, support, at) is not None)
        return next(can_place, None)

    def _spots(self, activity: Activity, support: str) -> Iterator[Pose2]:
        """Yield free spots on a table for an object, world, those with most room first."""
        believed = self._believed
        table, kind = believed.type(support), believed.type(activity.anchor)
        if table.shape != "table":
            return
        world_T_table = flat(believed.object(support).world_T_object)
        others = []
        for other in believed.standing():
            x, y, _ = compose2(inverse2(world_T_table), flat(believed.object(other).world_T_object))
            if believed.type(other).shape != "table" and abs(x) <= table.size_m[0] and abs(y) <= table.size_m[1]:
                others.append((x, y, widest_half(believed.type(other))))
        places, _ = spots(table, kind, np.array(others).reshape(-1, 3))
        is_clear = self._is_clear(activity.clear_of, kind)
        tried = 0
        for x, y in places.tolist():
            spot = compose2(world_T_table, (x, y, 0.0))
            if table.size_m[0] / 2.0 - abs(x) <= FAR_M - BODY_M and is_clear(raised(spot, table.size_m[2])):
                yield spot
                tried += 1
            if tried == SPOTS:
                return

    def _is_clear(self, other: Activity | None, kind: ObjectType) -> IsClear:
        """Return a test of whether an object at a pose leaves room for another activity."""
        way = None if other is None or not self._is_open(other) else self._way(other)
        return (lambda at: True) if other is None or way is None else self._ways.leaves_room(other, way, kind)
