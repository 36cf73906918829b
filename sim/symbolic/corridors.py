"""Corridors: the straight way of a hand, without its arm, from the middle of the base to its target."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from skolem.sim.space.grasps import widest_half
from skolem.traces.messages import ObjectType, Pose4

HAND_M = 0.04  # half the width that a hand truly needs
CORRIDOR_M = 0.06  # ... and half the width that is planned for it


@dataclass(frozen=True, slots=True)
class Pillar:
    """An upright cylinder around an object: axis, radius, and heights of its lower and upper end [m]."""

    name: str
    x: float
    y: float
    radius: float
    bottom: float
    top: float


def pillar(name: str, kind: ObjectType, world_T_object: Pose4, wider_m: float = 0.0) -> Pillar:
    """Return the pillar around an object, widened by `wider_m`."""
    x, y, z, _ = world_T_object
    return Pillar(name, x, y, widest_half(kind) + wider_m, z, z + kind.size_m[2])


def standing_in(start: tuple[float, float], target: Pillar, others: Iterable[Pillar], half_m: float) -> tuple[str, ...]:
    """Return the sorted names of the pillars in the corridor from `start` to a target.

    Args:
        start: Beginning of the corridor, metres.
        target: End of the corridor; pillars behind its axis or wholly above or below it do not count.
        others: Pillars that may stand in the corridor; the target itself does not count.
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
