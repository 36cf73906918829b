"""Footprints: outlines of objects seen from above, with their distances, overlaps and overhangs."""

import math
from dataclasses import dataclass, replace

from skolem.traces.messages import ObjectType, Pose2, Pose4
from skolem.traces.messages.poses import compose2, flat, inverse2

Corner = tuple[float, float]
TOUCHING_M = 0.001


@dataclass(frozen=True, slots=True)
class Footprint:
    """A rectangle with rounded corners: a box has no radius, a cylinder no extent.

    Attributes:
        world_T_centre: Pose of its centre.
        half_m: Half extents of the rectangle along x and y of its own frame.
        radius_m: Added on every side.
    """

    world_T_centre: Pose2
    half_m: tuple[float, float]
    radius_m: float

    def corners(self) -> list[Corner]:
        """Return the rectangle's corners, in order around it."""
        x, y = self.half_m
        around = ((x, y), (-x, y), (-x, -y), (x, -y))
        return [compose2(self.world_T_centre, (a, b, 0.0))[:2] for a, b in around]


def footprint(object_type: ObjectType, world_T_object: Pose2) -> Footprint:
    """Return the footprint of an upright object of the type."""
    x, y, _ = object_type.size_m
    if object_type.shape == "cylinder":
        return Footprint(world_T_object, (0.0, 0.0), max(x, y) / 2.0)
    return Footprint(world_T_object, (x / 2.0, y / 2.0), 0.0)


def distance(a: Footprint, b: Footprint) -> float:
    """Return the gap between two footprints in metres, 0 if they overlap."""
    inside = any(_within(a, corner) for corner in b.corners()) or any(_within(b, corner) for corner in a.corners())
    gap = 0.0 if inside else min(_segments(p, q, r, s) for p, q in _edges(a) for r, s in _edges(b))
    return max(0.0, gap - a.radius_m - b.radius_m)


def overlaps(a: Footprint, b: Footprint) -> bool:
    """Return whether two footprints overlap by more than a millimetre; so tables may stand side by side."""
    if math.dist(a.world_T_centre[:2], b.world_T_centre[:2]) > _reach(a) + _reach(b):
        return False  # most pairs are far apart
    if a.radius_m > TOUCHING_M:
        a = replace(a, radius_m=a.radius_m - TOUCHING_M)
    else:
        a = replace(a, half_m=(max(0.0, a.half_m[0] - TOUCHING_M), max(0.0, a.half_m[1] - TOUCHING_M)))
    return distance(a, b) == 0.0


def collide(a: ObjectType, world_T_a: Pose4, b: ObjectType, world_T_b: Pose4) -> bool:
    """Return whether two upright objects would intersect, so that at least one of them must be elsewhere."""
    if world_T_a[2] + a.size_m[2] <= world_T_b[2] or world_T_b[2] + b.size_m[2] <= world_T_a[2]:
        return False
    return overlaps(footprint(a, flat(world_T_a)), footprint(b, flat(world_T_b)))


def overhang(inner: Footprint, outer: Footprint) -> float:
    """Return how far `inner` reaches beyond the rectangle `outer`, metres; negative values are the remaining margin."""
    outer_T_world = inverse2(outer.world_T_centre)
    beyond = -math.inf
    for x, y in inner.corners():
        u, v, _ = compose2(outer_T_world, (x, y, 0.0))
        beyond = max(beyond, abs(u) + inner.radius_m - outer.half_m[0], abs(v) + inner.radius_m - outer.half_m[1])
    return beyond


def _reach(footprint: Footprint) -> float:
    """Return the radius of the circle around a footprint, metres."""
    return math.hypot(*footprint.half_m) + footprint.radius_m


def _within(footprint: Footprint, corner: Corner) -> bool:
    x, y, _ = compose2(inverse2(footprint.world_T_centre), (*corner, 0.0))
    return abs(x) <= footprint.half_m[0] and abs(y) <= footprint.half_m[1]


def _edges(footprint: Footprint) -> list[tuple[Corner, Corner]]:
    corners = footprint.corners()
    return list(zip(corners, corners[1:] + corners[:1], strict=True))


def _segments(p: Corner, q: Corner, r: Corner, s: Corner) -> float:
    """Return the distance between two segments in the plane."""
    if _side(p, q, r) * _side(p, q, s) < 0.0 and _side(r, s, p) * _side(r, s, q) < 0.0:
        return 0.0
    return min(_point(p, r, s), _point(q, r, s), _point(r, p, q), _point(s, p, q))


def _side(p: Corner, q: Corner, point: Corner) -> float:
    return (q[0] - p[0]) * (point[1] - p[1]) - (q[1] - p[1]) * (point[0] - p[0])


def _point(point: Corner, p: Corner, q: Corner) -> float:
    """Return the distance of a point to a segment."""
    dx, dy = q[0] - p[0], q[1] - p[1]
    length2 = dx * dx + dy * dy
    t = 0.0 if length2 == 0.0 else ((point[0] - p[0]) * dx + (point[1] - p[1]) * dy) / length2
    t = min(1.0, max(0.0, t))
    return math.hypot(point[0] - p[0] - t * dx, point[1] - p[1] - t * dy)
