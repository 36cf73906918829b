"""Where the symbolic robot must stand and how its hand must go, by distance and closed-form arm kinematics alone.

It answers the reasoner's questions about the believed world as the planner with collision checking does, in a fraction
of a millisecond and without obstacles: the base drives in a straight line, the arm goes from its carry pose to the
grasp and back.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skolem.sim.footprints import Footprint, footprint, overlaps
from skolem.sim.grasps import RELEASE_M, STEEPEST_RAD, YAWS, approach_yaws, back_off, grasp, spots, widest_half
from skolem.sim.poses import compose2, compose4, flat, inverse2, inverse4, raised, wrap
from skolem.sim.symbolic_arm import CARRY, reach, shoulder
from skolem.sim.symbolic_view import head_towards
from skolem.traces.messages import (
    Belief,
    Command,
    Hand,
    Joints7,
    LookAt,
    MoveBase,
    ObjectBelief,
    ObjectType,
    Pick,
    Place,
    Pose2,
    Pose4,
    Weigh,
)

LOOK_M = 1.6  # from the base: what is nearer can be looked at
NEAR_M, FAR_M = 0.5, 0.8  # from the base to what a hand reaches for
STANDOFF_M = 0.62
FACING_RAD = 0.5
BODY_M, AIR_M = 0.36, 0.01  # from the middle of the base to its edge, and how much of that is air
LIFT_M = 0.05
SPOTS = 24  # of the best places on a table, how many are tried
EXISTS = 0.5  # objects less likely to exist take no room


class Activity(Protocol):
    """What is to be done, as the reasoner asks for it."""

    @property
    def kind(self) -> str:
        """Return "look", "pick", "place" or "weigh"."""
        ...

    @property
    def anchor(self) -> str:
        """Return the object it is about."""
        ...

    @property
    def hand(self) -> Hand | None:
        """Return the hand that does it."""
        ...

    @property
    def support(self) -> str | None:
        """Return where to place."""
        ...


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
        self._belief = belief

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from where the robot stands, or None."""
        match activity.kind, activity.hand, activity.support:
            case "look", _, _:
                return self._look(activity.anchor)
            case "pick", ("right" | "left") as hand, _:
                return self._pick(hand, activity.anchor)
            case "place", ("right" | "left") as hand, str(support):
                return self._place(hand, activity.anchor, support)
            case "weigh", ("right" | "left") as hand, _:
                return Weigh(hand=hand) if self._object(activity.anchor).in_hand == hand else None
        return None

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a straight drive to where `activity` can be done, or None."""
        if activity.kind in ("look", "pick") and self._object(activity.anchor).in_hand is None:
            targets: Iterator[Pose2] = iter([flat(self._object(activity.anchor).world_T_object)])
            support = self._object(activity.anchor).support
        elif activity.kind == "place" and activity.support is not None:
            targets, support = self._spots(activity.anchor, activity.support), activity.support
        else:
            return None
        found = [pose for target in targets if (pose := self._standoff(target, support)) is not None]
        if not found:
            return None
        start = inverse2(self._now.world_T_base)
        drives = [compose2(start, pose) for pose in found]
        return MoveBase(start_T_waypoint=(min(drives, key=_length),))

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        """Return what stands in the way of `activity`: nothing, as the hand goes straight through obstacles."""
        return ()

    @property
    def _now(self) -> Belief:
        assert self._belief is not None, "sync comes before the first question"
        return self._belief

    def _object(self, anchor: str) -> ObjectBelief:
        return self._now.objects[anchor]

    def _type(self, anchor: str) -> ObjectType:
        shares = self._object(anchor).type
        return self._types[max(sorted(shares), key=shares.__getitem__)]

    def _base_T(self, world_T_thing: Pose4) -> Pose4:
        return compose4(inverse4(raised(self._now.world_T_base)), world_T_thing)

    def _look(self, anchor: str) -> LookAt | None:
        x, y, z, _ = self._base_T(self._object(anchor).world_T_object)
        if self._object(anchor).in_hand is not None or math.hypot(x, y) > LOOK_M:
            return None
        middle = z + self._type(anchor).size_m[2] * (1.0 if self._type(anchor).shape == "table" else 0.5)
        head = head_towards(self._now.robot.torso, np.array([x, y, middle]))
        return None if head is None else LookAt(pan=head[0], tilt=head[1])

    def _pick(self, hand: Hand, anchor: str) -> Pick | None:
        kind, believed = self._type(anchor), self._object(anchor)
        base_T_object = self._base_T(believed.world_T_object)
        if believed.in_hand is not None or self._full(hand) or not _within_reach(base_T_object):
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

    def _place(self, hand: Hand, anchor: str, support: str) -> Place | None:
        believed, kind = self._object(anchor), self._type(anchor)
        if believed.in_hand != hand or believed.tool_T_object is None:
            return None
        top = self._type(support).size_m[2]
        for x, y, theta in self._spots(anchor, support):
            base_T_spot = self._base_T((x, y, top + RELEASE_M, theta))
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

    def _full(self, hand: Hand) -> bool:
        return any(believed.in_hand == hand for believed in self._now.objects.values())

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

    def _spots(self, anchor: str, support: str) -> Iterator[Pose2]:
        """Yield free places on a table for an object, in the world, the ones with most room first."""
        table, kind = self._type(support), self._type(anchor)
        if table.shape != "table":
            return
        world_T_table = flat(self._object(support).world_T_object)
        others = []
        for other, believed in self._now.objects.items():
            if other in (anchor, support) or believed.in_hand is not None or believed.exists < EXISTS:
                continue
            x, y, _ = compose2(inverse2(world_T_table), flat(believed.world_T_object))
            if self._type(other).shape != "table" and abs(x) <= table.size_m[0] and abs(y) <= table.size_m[1]:
                others.append((x, y, widest_half(self._type(other))))
        places, _ = spots(table, kind, np.array(others).reshape(-1, 3))
        reachable = [place for place in places.tolist() if table.size_m[0] / 2.0 - abs(place[0]) <= FAR_M - BODY_M]
        for x, y in reachable[:SPOTS]:
            yield compose2(world_T_table, (x, y, 0.0))

    def _standoff(self, world_T_target: Pose2, support: str | None) -> Pose2 | None:
        """Return the nearest base pose before a target that is square to a free edge of what the target stands on."""
        x, y, _ = world_T_target
        bx, by, _ = self._now.world_T_base
        if support is None or self._type(support).shape != "table":
            sides = [(math.atan2(y - by, x - bx), 0.0)]
        else:
            sides = self._edges(world_T_target, support)
        poses = []
        for heading, depth in sides:
            away = max(STANDOFF_M, depth + BODY_M)
            pose = (x - away * math.cos(heading), y - away * math.sin(heading), heading)
            if away <= FAR_M and self._free(pose):
                poses.append(pose)
        return min(poses, key=lambda pose: _length(compose2(inverse2(self._now.world_T_base), pose)), default=None)

    def _edges(self, world_T_target: Pose2, support: str) -> list[tuple[float, float]]:
        """Return, for each edge of a table, the heading into it and how deep behind it the target lies."""
        world_T_table = flat(self._object(support).world_T_object)
        u, v, _ = compose2(inverse2(world_T_table), world_T_target)
        a, b = (size / 2.0 for size in self._type(support).size_m[:2])
        inward = ((0.0, a + u), (math.pi, a - u), (math.pi / 2.0, b + v), (-math.pi / 2.0, b - v))
        return [(wrap(world_T_table[2] + turn), depth) for turn, depth in inward]

    def _free(self, world_T_base: Pose2) -> bool:
        """Return whether a base there stands in no table."""
        body = Footprint(world_T_base, (0.0, 0.0), BODY_M - AIR_M)
        return not any(
            overlaps(body, footprint(self._type(anchor), flat(believed.world_T_object)))
            for anchor, believed in self._now.objects.items()
            if self._type(anchor).shape == "table"
        )


def _within_reach(base_T_target: Pose4) -> bool:
    """Return whether a target lies in the ring before the base where a hand reaches it."""
    x, y = base_T_target[:2]
    return NEAR_M <= math.hypot(x, y) <= FAR_M and abs(math.atan2(y, x)) <= FACING_RAD


def _length(start_T_end: Pose2) -> tuple[float, ...]:
    """Return the length of a drive and its turn, then the pose itself to break ties."""
    x, y, theta = (round(value, 9) for value in start_T_end)
    return (round(math.hypot(x, y), 6), abs(theta), x, y)
