"""Room on a table for one more object, and the movable objects that take it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.space.grasps import NEIGHBOUR_M, spots, widest_half
from skolem.traces.messages import ObjectType

Floats = NDArray[np.float64]
Disc = tuple[float, float, float]  # x, y in a table's frame and the largest half width of an object on it, metres


@dataclass(frozen=True, slots=True)
class Room:
    """A spot for an object on a table, and the objects that must be taken away before.

    Attributes:
        spot: Position in the table's frame, metres.
        blockers: Their names, sorted; empty if the spot is free.
    """

    spot: tuple[float, float]
    blockers: tuple[str, ...]


def rooms(table: ObjectType, thing: ObjectType, fixed: Mapping[str, Disc], movable: Mapping[str, Disc]) -> list[Room]:
    """Return the spots for an object that are free once movable objects are taken away.

    Those with the fewest objects to take away come first; of those, the ones nearest to an edge, which an arm reaches.

    Args:
        table: The type of the table.
        thing: The type of the object to put down.
        fixed: The objects on the table that no hand can take away.
        movable: The other objects on the table.
    """
    places, _ = spots(table, thing, _array(fixed))
    others = _array(movable)
    gap = np.hypot(places[:, None, 0] - others[:, 0], places[:, None, 1] - others[:, 1])
    crowds = gap - widest_half(thing) - others[:, 2] < NEIGHBOUR_M
    depth = (np.array(table.size_m[:2]) / 2.0 - np.abs(places)).min(axis=1)
    order = np.lexsort((np.round(depth, 6), crowds.sum(axis=1)))
    names = np.array(list(movable), dtype=object)
    return [Room((float(places[k, 0]), float(places[k, 1])), tuple(sorted(names[crowds[k]]))) for k in order]


def leaves_room(places: Floats, thing: ObjectType, spot: tuple[float, float], other: ObjectType) -> NDArray[np.bool_]:
    """Return the mask, shape (k,), of places (k, 2) where an object does not crowd another one at a spot."""
    gap = np.hypot(places[:, 0] - spot[0], places[:, 1] - spot[1]) - widest_half(thing) - widest_half(other)
    return np.asarray(gap >= NEIGHBOUR_M)


def _array(discs: Mapping[str, Disc]) -> Floats:
    return np.reshape(np.array(list(discs.values()), dtype=np.float64), (-1, 3))
