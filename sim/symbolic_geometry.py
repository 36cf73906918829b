"""Where the symbolic robot must stand and how its hand must go, by distance and closed-form arm kinematics alone.

It answers the reasoner's questions about the believed world as the planner with collision checking does, in a fraction
of the time: the base drives in a straight line, a hand comes through a straight corridor, a camera sees along rays.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.activities import Activity
from skolem.sim.grasps import RELEASE_M, STEEPEST_RAD, YAWS, approach_yaws, back_off, grasp, spots, widest_half
from skolem.sim.poses import compose2, compose4, flat, inverse2, inverse4, raised, wrap
from skolem.sim.symbolic_arm import CARRY, reach, shoulder
from skolem.sim.symbolic_belief import BODY_M, SymbolicBelief
from skolem.sim.symbolic_view import head_towards
from skolem.sim.symbolic_ways import FAR_M, LOOK_M, IsClear, Way, Ways
from skolem.traces.messages import (
    Belief,
    Command,
    Hand,
    Joints7,
    LookAt,
    MoveBase,
    ObjectType,
    Pick,
    Place,
    Pose2,
    Pose4,
    Weigh,
)

NEAR_M = 0.5  # from the base to what a hand reaches for, at least
FACING_RAD = 0.5
LIFT_M = 0.05
SPOTS = 24  # of the best places on a table, how many are tried


@dataclass(frozen=True, slots=True)
class Reach:
    """Arm configurations before, at and above a grasp or a release."""

    before: Joints7
    at: Joints7
    above: Joints7


class SymbolicGeometry:
    """Answers about the belief it was last given."""

    def __init__(self, types: Mapping[str, ObjectType]) -> None:
        """Know the types; nothing is believed yet."""
        self._types = dict(types)
        self._belief: Belief | None = None

    def sync(self, belief: Belief) -> None:
        """Take over the believed world."""
        if belief != self._belief:
            self._belief = belief
            self._believed = SymbolicBelief(self._types, belief)
            self._ways = Ways(self._believed)

    def close(self) -> None:
        """Free nothing: there is no physics."""

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
                return self._place(hand, activity, support)
            case "weigh", ("right" | "left") as hand, _:
                return Weigh(hand=hand) if self._believed.object(activity.anchor).in_hand == hand else None
        return None

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a straight drive to where `activity` can be done, or None."""
        stance: Pose2 | None = None
        if activity.kind == "place" and activity.support is not None:
            spots = self._spots(activity, activity.support)
            found = [self._believed.standoffs(spot, activity.support, FAR_M)[:1] for spot in spots]
            stance = min((pose for poses in found for pose in poses), key=self._believed.drive_length, default=None)
        elif self._is_open(activity):
            stance = next(self._ways.free(activity), None)
        if stance is None:
            return None
        return MoveBase(start_T_waypoint=(compose2(inverse2(self._now.world_T_base), stance),))

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        """Return what stands in the way that has the least in it, sorted; empty if that is free or there is none."""
        way = self._way(activity) if self._is_open(activity) else None
        return () if way is None else way.blockers

    @property
    def _now(self) -> Belief:
        return self._believed.belief

    def _is_open(self, activity: Activity) -> bool:
        """Return whether the activity is about something that could be seen or picked somewhere."""
        if activity.kind == "look_region":
            return True
        item = self._now.objects.get(activity.anchor)
        return activity.kind in ("look", "pick") and item is not None and item.in_hand is None

    def _way(self, activity: Activity) -> Way | None:
        """Return how an activity would be done with an empty hand."""
        if activity.kind == "pick" and activity.hand is not None:
            return self._ways.best(activity, self._pick(activity.hand, activity.anchor) is not None)
        return self._ways.best(activity, self.ready(activity) is not None)

    def _look(self, activity: Activity) -> LookAt | None:
        """Return the look from here, unless the object may be hidden and another stance is surer."""
        believed, anchor = self._believed, activity.anchor
        x, y, z, _ = believed.base_T(believed.object(anchor).world_T_object)
        if believed.object(anchor).in_hand is not None or math.hypot(x, y) > LOOK_M:
            return None
        is_table = believed.type(anchor).shape == "table"
        if not is_table:
            sight = believed.sight(self._now.world_T_base)
            if sight.hiders(anchor, ()) is None:
                return None
            if sight.hiders(anchor, (), believed.doubt(anchor)) is None and next(self._ways.sure(activity), None):
                return None
        middle = z + believed.type(anchor).size_m[2] * (1.0 if is_table else 0.5)
        head = head_towards(self._now.robot.torso, np.array([x, y, middle]))
        return None if head is None else LookAt(pan=head[0], tilt=head[1])

    def _pick(self, hand: Hand, anchor: str) -> Pick | None:
        kind, believed = self._believed.type(anchor), self._believed.object(anchor)
        base_T_object = self._believed.base_T(believed.world_T_object)
        if believed.in_hand is not None or not _within_reach(base_T_object):
            return None
        if self._ways.in_corridor(self._now.world_T_base, anchor):
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

    def _place(self, hand: Hand, activity: Activity, support: str) -> Place | None:
        believed, kind = self._believed.object(activity.anchor), self._believed.type(activity.anchor)
        if believed.in_hand != hand or believed.tool_T_object is None:
            return None
        top = self._believed.type(support).size_m[2]
        for x, y, theta in self._spots(activity, support):
            base_T_spot = self._believed.base_T((x, y, top + RELEASE_M, theta))
            if not _within_reach(base_T_spot):
                continue
            for yaw in self._straightest(hand, base_T_spot, np.linspace(-STEEPEST_RAD, STEEPEST_RAD, YAWS)):
                turned = (*base_T_spot[:3], wrap(yaw + believed.tool_T_object[3]))
                arm = self._reach(hand, compose4(turned, inverse4(believed.tool_T_object)), back_off(kind, 0.0))
                if arm is not None:
                    return Place(
                        hand=hand,
                        approach=(arm.above,),
                        lower=(arm.at,),
                        retreat=(arm.before,),
                        carry=(CARRY[hand],),
                    )
        return None

    def _straightest(self, hand: Hand, base_T_target: Pose4, yaws: NDArray[np.float64]) -> list[float]:
        """Return directions of the fingers, shape (n,), sorted: straight away from the shoulder first."""
        sx, sy, _ = shoulder(hand, self._now.robot.torso)
        straight = math.atan2(base_T_target[1] - sy, base_T_target[0] - sx)
        angles: list[float] = yaws.tolist()
        return sorted(angles, key=lambda yaw: (abs(wrap(yaw - straight)), yaw))

    def _reach(self, hand: Hand, base_T_tool: Pose4, back_m: float) -> Reach | None:
        """Return arm configurations at a tool pose, `back_m` behind it and a little above it, or None."""
        torso = self._now.robot.torso
        before = reach(hand, torso, compose4(base_T_tool, (-back_m, 0.0, 0.0, 0.0)))
        at = reach(hand, torso, base_T_tool)
        above = reach(hand, torso, compose4(base_T_tool, (0.0, 0.0, LIFT_M, 0.0)))
        return None if before is None or at is None or above is None else Reach(before, at, above)

    def _spots(self, activity: Activity, support: str) -> Iterator[Pose2]:
        """Yield free places on a table for an object, in the world, the ones with most room first."""
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
        """Return a test of whether something put down at a pose leaves room for another activity."""
        way = None if other is None or not self._is_open(other) else self._way(other)
        return (lambda at: True) if other is None or way is None else self._ways.leaves_room(other, way, kind)


def _within_reach(base_T_target: Pose4) -> bool:
    """Return whether a target lies in the ring before the base where a hand reaches it."""
    x, y = base_T_target[:2]
    return NEAR_M <= math.hypot(x, y) <= FAR_M and abs(math.atan2(y, x)) <= FACING_RAD
