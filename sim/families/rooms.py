"""Room on a table: where one more thing can stand, or why there is none."""

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from skolem.sim.families.places import is_free
from skolem.sim.families.reaching import Floor
from skolem.sim.families.shapes import beyond
from skolem.sim.families.words import Words
from skolem.sim.families.world import Thing
from skolem.traces.messages import ObjectType, Pose2

GAP_M = 0.06  # to what stands there already
XS, YS = (-0.26, -0.18, -0.10, -0.02), tuple(round(0.06 * i, 2) for i in range(-7, 8))  # places that are tried
APART_M = 0.2  # of places that are counted together
GRID_M = 0.01


def spots(table: Thing, kind: ObjectType, things: Sequence[Thing], floor: Floor, words: Words) -> Iterator[Pose2]:
    """Yield places on a table where a thing can be put down and that a base can stand at, all of them free."""
    for x in XS:
        for y in YS:
            if is_free(kind, table.id, (x, y, math.pi / 2), things, GAP_M, words) and floor.stand(table, x, y):
                yield x, y, 0.0


def spread(places: Iterable[Pose2]) -> list[Pose2]:
    """Return places that do not take each other's room, as many as are met in order."""
    chosen: list[Pose2] = []
    for at in places:
        if all(math.hypot(at[0] - other[0], at[1] - other[1]) >= APART_M for other in chosen):
            chosen.append(at)
    return chosen


def never_room(table: Thing, kind: ObjectType, things: Sequence[Thing], words: Words) -> bool:
    """Return whether no place of a table is free of what nobody can lift, however the thing is turned.

    Every point of a grid is nearer to such a thing or to the table's edge than the inner radius less the grid.
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
