"""The way of a hand without its arm: a straight corridor from the middle of the base to what it reaches for."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from skolem.sim.space.grasps import widest_half
from skolem.traces.messages import ObjectType, Pose4

HAND_M = 0.04  # half the width that a hand truly needs
CORRIDOR_M = 0.06  # ... and that is planned for it


@dataclass(frozen=True, slots=True)
class Pillar:
    """An upright thing: where its axis is, its radius, and the heights of its lower and upper end [m]."""

    name: str
    x: float
    y: float
    radius: float
    bottom: float
    top: float


def pillar(name: str, kind: ObjectType, world_T_object: Pose4, wider_m: float = 0.0) -> Pillar:
    """Return a thing as a pillar around all of it, a little wider if need be."""
    x, y, z, _ = world_T_object
    return Pillar(name, x, y, widest_half(kind) + wider_m, z, z + kind.size_m[2])


def standing_in(start: tuple[float, float], target: Pillar, others: Iterable[Pillar], half_m: float) -> tuple[str, ...]:
    """Return the names, sorted, of what stands in the corridor from `start` to a target.

    Args:
        start: Where the corridor begins.
        target: Where it ends: nothing behind its axis is in the way, nor what is wholly above or below it.
        others: What may stand in it; the target itself does not count.
        half_m: Half the width of the corridor.
    """
    dx, dy = target.x - start[0], target.y - start[1]
    length = math.hypot(dx, dy)
    met = []
    for other in others:
        along = ((other.x - start[0]) * dx + (other.y - start[1]) * dy) / max(length, 1e-9)
        aside = abs((other.x - start[0]) * dy - (other.y - start[1]) * dx) / max(length, 1e-9)
        level = other.bottom < target.top and target.bottom < other.top
        if other.name != target.name and level and 0.0 <= along <= length and aside < half_m + other.radius:
            met.append(other.name)
    return tuple(sorted(met))
