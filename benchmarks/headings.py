"""Visible headings: a box looks alike after half a turn, a square one after a quarter."""

import math

from skolem.traces.messages import ObjectType


def least_turn(angle: float, box: ObjectType) -> float:
    """Return the smallest turn, rad, after which a box looks the same as after a turn by `angle`."""
    return math.remainder(angle, math.pi / 2.0 if box.size_m[0] == box.size_m[1] else math.pi)
