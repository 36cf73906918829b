"""Room on a table: places for one more object, or the proof that there are none."""

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from skolem.sim.families.places import is_free
from skolem.sim.families.reaching import Floor
from skolem.sim.families.shapes import beyond
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.traces.messages import ObjectType, Pose2

GAP_M = 0.06  # to the objects on the table
XS, YS = (-0.26, -0.18, -0.10, -0.02), tuple(round(0.06 * i, 2) for i in range(-7, 8))  # of the places tried
APART_M = 0.2  # least distance of places that can be used together
GRID_M = 0.01


def spots(table: Thing, kind: ObjectType, things: Sequence[Thing], floor: Floor, words: Words) -> Iterator[Pose2]:
    """Yield free places on a table that can be reached from a stand of the base."""
    for x in XS:
        for y in YS:
            if is_free(kind, table.id, (x, y, math.pi / 2), things, GAP_M, words) and floor.stand(table, x, y):
                yield x, y, 0.0


def spread(places: Iterable[Pose2]) -> list[Pose2]:
    """Return places that can be used together, chosen greedily in order."""
    chosen: list[Pose2] = []
    for at in places:
        if all(math.hypot(at[0] - other[0], at[1] - other[1]) >= APART_M for other in chosen):
            chosen.append(at)
    return chosen


def never_room(table: Thing, kind: ObjectType, things: Sequence[Thing], words: Words) -> bool:
    """Return whether objects that cannot be lifted leave no place on a table, whatever the object's heading.

    They leave none if every point of a grid is nearer to such an object or to the table's edge than the object's inner
    radius less the grid's width.
    """
    length, width, _ = words.types[table.type].size_m
    inner = min(kind.size_m[:2]) / 2.0
    xs = np.arange(-length / 2.0 + inner, length / 2.0 - inner + GRID_M, GRID_M)
    ys = np.arange(-width / 2.0 + inner, width / 2.0 - inner + GRID_M, GRID_M)
    gx, gy = (axis.ravel() for axis in np.meshgrid(xs, ys))
    taken = np.zeros(len(gx), dtype=bool)
    for item in things:
        if item.on != table.id or words.types[item.type].graspable:
            continue
        taken |= beyond(item.at, words.types[item.type], gx, gy) <= inner - GRID_M
    return bool(taken.all())
