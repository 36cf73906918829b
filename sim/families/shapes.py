"""Gaps between shapes seen from above: by circles where these decide, else exactly."""

import math

import numpy as np
from numpy.typing import NDArray

from skolem.sim.space.footprints import Footprint, distance
from skolem.traces.messages import ObjectType, Pose2
from skolem.traces.messages.poses import inverse2

Floats = NDArray[np.float64]


def apart(a: Footprint, b: Footprint, gap_m: float) -> bool:
    """Return whether the gap between two footprints is greater than `gap_m`."""
    (ax, ay, _), (bx, by, _) = a.world_T_centre, b.world_T_centre
    between = math.hypot(ax - bx, ay - by)
    if between - math.hypot(*a.half_m) - a.radius_m - math.hypot(*b.half_m) - b.radius_m > gap_m:
        return True
    if between - min(a.half_m) - a.radius_m - min(b.half_m) - b.radius_m <= gap_m:
        return False
    return distance(a, b) > gap_m


def beyond(world_T_thing: Pose2, kind: ObjectType, x: Floats, y: Floats) -> Floats:
    """Return the distance of points, x and y of shape (n,), to the rectangle that an object covers, shape (n,)."""
    fx, fy, turn = inverse2(world_T_thing)
    c, s = math.cos(turn), math.sin(turn)
    u, v = fx + c * x - s * y, fy + s * x + c * y
    length, width, _ = kind.size_m
    aside = (np.maximum(np.abs(u) - length / 2.0, 0.0), np.maximum(np.abs(v) - width / 2.0, 0.0))
    return np.asarray(np.hypot(*aside))
