"""The believed world of the symbolic robot: standing objects, and base poses around them."""

import itertools
import math
from collections.abc import Iterator, Mapping
from functools import cached_property

from skolem.sim.space.doubt import Doubts
from skolem.sim.space.footprints import Footprint, footprint, overlaps
from skolem.sim.symbolic.corridors import Pillar, pillar
from skolem.sim.symbolic.sight import BelievedSight, Thing
from skolem.traces.messages import Belief, Hand, ObjectBelief, ObjectType, Pose2, Pose4
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import compose2, compose4, flat, inverse2, inverse4, raised, wrap_half_open

STANDOFF_M = 0.62  # from the base to the target of a hand
OBLIQUE_RAD = 0.4  # between an oblique heading of the base and the square one
BODY_M, AIR_M = 0.36, 0.01  # from the middle of the base to its edge, and the part of that which is air
DOUBT_LIMIT_M = 0.05  # greatest considered doubt about the place of an object to look at
EXISTS = 0.5  # objects less likely to exist are no obstacles
RING_HEADINGS, RING_M = 12, (0.8, 1.0, 1.2, 1.4)  # base poses around an object to look at


class SymbolicBelief:
    """One belief, with the geometry of its objects."""

    def __init__(self, types: Mapping[str, ObjectType], belief: Belief) -> None:
        """Read a belief about objects of these types."""
        self._types = types
        self.belief = belief
        self._doubts = Doubts(belief)

    def object(self, anchor: str) -> ObjectBelief:
        """Return the belief about an anchor."""
        return self.belief.objects[anchor]

    def type(self, anchor: str) -> ObjectType:
        """Return the most likely type of an anchor."""
        return self._types[likeliest(self.object(anchor).type)]

    def base_T(self, world_T_thing: Pose4, world_T_base: Pose2 | None = None) -> Pose4:
        """Return base_T_thing for a base pose; without one, for the believed pose of the base."""
        return compose4(inverse4(raised(world_T_base or self.belief.world_T_base)), world_T_thing)

    def full(self, hand: Hand) -> bool:
        """Return whether a hand holds something."""
        return any(believed.in_hand == hand for believed in self.belief.objects.values())

    def standing(self) -> tuple[str, ...]:
        """Return the anchors that are believed to exist and are in no hand."""
        return tuple(a for a, item in self.belief.objects.items() if item.in_hand is None and item.exists >= EXISTS)

    def movable(self, target: str) -> tuple[str, ...]:
        """Return the anchors that a hand could take away, without the target."""
        return tuple(anchor for anchor in self.standing() if self.type(anchor).graspable and anchor != target)

    def doubt(self, anchor: str) -> float:
        """Return how far an object may be from its place among the other objects, metres."""
        return self._doubts.own_spread(anchor, DOUBT_LIMIT_M)

    def pillar(self, anchor: str) -> Pillar:
        """Return an object as a pillar."""
        return pillar(anchor, self.type(anchor), self.object(anchor).world_T_object)

    def pillars(self) -> list[Pillar]:
        """Return the pillars of all objects that could block a hand."""
        return [self.pillar(anchor) for anchor in self.standing() if self.type(anchor).shape != "table"]

    def sight(self, world_T_base: Pose2, target: str | None = None) -> BelievedSight:
        """Return the camera of a robot at a base pose; the object that it looks at counts as existing."""
        seen = self.standing() if target is None else dict.fromkeys((*self.standing(), target))
        things = [Thing(a, self.type(a), self.object(a).world_T_object) for a in seen]
        return BelievedSight(world_T_base, self.belief.robot.torso, things)

    # ---------------------------------------------------------------- base poses

    def standoffs(self, world_T_target: Pose2, support: str | None, farthest_m: float) -> list[Pose2]:
        """Return base poses before a target: those square to the edges below it, nearest first, then oblique ones."""
        x, y, _ = world_T_target
        bx, by, _ = self.belief.world_T_base
        if support is None or self.type(support).shape != "table":
            sides = [(math.atan2(y - by, x - bx), 0.0)]
        else:
            sides = self._edges(world_T_target, support)
        found: list[Pose2] = []
        for turns in ((0.0,), (-OBLIQUE_RAD, OBLIQUE_RAD)):
            poses = []
            for (edge, depth), turn in itertools.product(sides, turns):
                away, heading = max(STANDOFF_M, (depth + BODY_M) / math.cos(turn)), wrap_half_open(edge + turn)
                pose = (x - away * math.cos(heading), y - away * math.sin(heading), heading)
                if away <= farthest_m and self.free(pose):
                    poses.append(pose)
            found += sorted(poses, key=self.drive_length)
        return found

    def ring(self, middle: tuple[float, float]) -> Iterator[Pose2]:
        """Yield the free base poses around a point, facing it, nearest first."""
        headings = [2.0 * math.pi * k / RING_HEADINGS for k in range(RING_HEADINGS)]
        poses = [
            (middle[0] - away * math.cos(heading), middle[1] - away * math.sin(heading), wrap_half_open(heading))
            for heading in headings
            for away in RING_M
        ]
        return (pose for pose in sorted(poses, key=self.drive_length) if self.free(pose))

    def drive_length(self, world_T_base: Pose2) -> tuple[float, ...]:
        """Return a sort key for drives: distance and turn to a base pose, then the pose itself to break ties."""
        x, y, theta = (round(v, 9) for v in compose2(inverse2(self.belief.world_T_base), world_T_base))
        return (round(math.hypot(x, y), 6), abs(theta), x, y)

    def free(self, world_T_base: Pose2) -> bool:
        """Return whether a base at this pose intersects no table."""
        body = Footprint(world_T_base, (0.0, 0.0), BODY_M - AIR_M)
        return not any(
            math.dist(world_T_base[:2], table.world_T_centre[:2]) <= BODY_M + math.hypot(*table.half_m)
            and overlaps(body, table)
            for table in self._tables
        )

    @cached_property
    def _tables(self) -> list[Footprint]:
        return [
            footprint(self.type(anchor), flat(believed.world_T_object))
            for anchor, believed in self.belief.objects.items()
            if self.type(anchor).shape == "table"
        ]

    def _edges(self, world_T_target: Pose2, support: str) -> list[tuple[float, float]]:
        """Return the heading into each edge of a table, and the distance of the target behind that edge."""
        world_T_table = flat(self.object(support).world_T_object)
        u, v, _ = compose2(inverse2(world_T_table), world_T_target)
        a, b = (size / 2.0 for size in self.type(support).size_m[:2])
        inward = ((0.0, a + u), (math.pi, a - u), (math.pi / 2.0, b + v), (-math.pi / 2.0, b - v))
        return [(wrap_half_open(world_T_table[2] + turn), depth) for turn, depth in inward]
