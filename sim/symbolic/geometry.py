"""The geometry of the symbolic robot, by distances and closed-form arm kinematics alone.

It answers the same questions of the reasoner as the planner with collision checking, in a fraction of the time: the
base drives in a straight line, a hand comes through a straight corridor, a camera sees along rays.
"""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from skolem.sim.space.grasps import RELEASE_M, spots, widest_half
from skolem.sim.space.room import Disc, Room, leaves_room, rooms
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
    Pose4,
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
            self._reached: dict[tuple[str, tuple[float, float]], bool] = {}

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

    def tried(self, activity: Activity) -> int:
        """Return the number of spots that were tried for a place, if there are more; 0 if `approach` has an answer."""
        if activity.kind != "place" or activity.support is None or self.approach(activity) is not None:
            return 0
        tried = sum(1 for _ in self._spots(activity, activity.support))
        return tried if tried == SPOTS else 0

    def blockers(self, activity: Activity) -> tuple[str, ...] | None:
        """Return the blockers of the way with the fewest, sorted; empty if that is free or there is no way.

        For a place, they are those of the spot with the fewest; None if there is no spot whatever is taken away.
        """
        if activity.kind == "place":
            room = self._room(activity)
            return None if room is None else room.blockers
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
        others = list(self._on_table(support, activity.anchor).values())
        places, _ = spots(table, kind, np.array(others).reshape(-1, 3))
        is_clear = self._is_clear(activity.clear_of, kind, support)
        tried = 0
        for x, y in places.tolist():
            spot = compose2(world_T_table, (x, y, 0.0))
            if table.size_m[0] / 2.0 - abs(x) <= FAR_M - BODY_M and is_clear(raised(spot, table.size_m[2])):
                yield spot
                tried += 1
            if tried == SPOTS:
                return

    def _room(self, activity: Activity) -> Room | None:
        """Return the room for an object on a table, in a hand or not; None if there is none or none in reach."""
        believed, support = self._believed, activity.support
        if support is None or support not in self._now.objects or believed.type(support).shape != "table":
            return None
        on_table = self._on_table(support, activity.anchor)
        movable = {name: disc for name, disc in on_table.items() if believed.type(name).graspable}
        fixed = {name: disc for name, disc in on_table.items() if name not in movable}
        found = rooms(believed.type(support), believed.type(activity.anchor), fixed, movable)
        return next((room for room in found if self._is_in_reach(support, room.spot)), None)

    def _is_in_reach(self, support: str, spot: tuple[float, float]) -> bool:
        """Return whether the robot can stand before a spot of a table."""
        if (support, spot) not in self._reached:
            at = compose2(flat(self._believed.object(support).world_T_object), (*spot, 0.0))
            self._reached[support, spot] = bool(self._believed.standoffs(at, support, FAR_M))
        return self._reached[support, spot]

    def _on_table(self, support: str, besides: str) -> dict[str, Disc]:
        """Return the standing objects over a table, but one, in its frame."""
        believed = self._believed
        table, table_T_world = believed.type(support), inverse2(flat(believed.object(support).world_T_object))
        out: dict[str, Disc] = {}
        for other in believed.standing():
            kind = believed.type(other)
            x, y, _ = compose2(table_T_world, flat(believed.object(other).world_T_object))
            over = abs(x) <= table.size_m[0] and abs(y) <= table.size_m[1]
            if kind.shape != "table" and over and other != besides:
                out[other] = (x, y, widest_half(kind))
        return out

    def _is_clear(self, other: Activity | None, kind: ObjectType, support: str) -> IsClear:
        """Return a test of whether an object at a pose on a support leaves room for another activity."""
        if other is not None and other.kind == "place":
            return self._leaves_room(other, kind) if other.support == support else lambda at: True
        way = None if other is None or not self._is_open(other) else self._way(other)
        return (lambda at: True) if other is None or way is None else self._ways.leaves_room(other, way, kind)

    def _leaves_room(self, other: Activity, kind: ObjectType) -> IsClear:
        """Return a test of whether an object at a pose leaves the room for another one to be put down."""
        room, support = self._room(other), other.support
        if room is None or support is None:
            return lambda at: True
        table_T_world = inverse2(flat(self._believed.object(support).world_T_object))
        wanted = self._believed.type(other.anchor)

        def is_clear(at: Pose4) -> bool:
            place = np.array([compose2(table_T_world, flat(at))[:2]])
            return bool(leaves_room(place, kind, room.spot, wanted)[0])

        return is_clear
