"""Stands of the base and reach of the arm, by simple geometry that errs on the safe side.

There are no joints: a base is a square that faces a table from its near side, and an arm reaches places in a range
ahead of it. A reachable place is so with a margin; a place out of reach is farther away than an arm is long.
"""

import math
from collections.abc import Sequence

import numpy as np

from skolem.sim.families.shapes import apart, beyond
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.space.footprints import Footprint, footprint
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import compose2

BASE_HALF_M = 0.354  # half the side of the base, plus 2 cm
DISC_M = 0.49  # around the middle of a base that turns on the way
FROM_EDGE_M = (0.38, 0.44, 0.50)  # from the edge of a table to the middle of the base in front of it
BACK_M = 0.56  # the same, where the base begins to drive straight ahead to the table
ASIDE_M = (0.0, -0.19, 0.19)  # of the middle of the base, so that one shoulder or the other faces the object
AHEAD_M = (0.5, 0.84)  # range of an arm from the middle of the base
TOP_M = (0.4, 1.0)  # heights of table tops within reach
ARM_M = 1.25  # from the middle of the base: longer than any arm
INSCRIBED_M = 0.334  # radius of the circle within the base
GRID_M = 0.04
HAND_HALF_M = 0.08  # half the width of the free space before an object that a grasp from the table's near edge needs


class Floor:
    """The objects on the floor, and stands of the base between them, which are kept once found."""

    def __init__(self, standing: Sequence[Thing], words: Words) -> None:
        """Take over all objects on the floor."""
        self._standing, self._words = standing, words
        self._covers = [footprint(words.types[item.type], item.at) for item in standing]
        self._ways: dict[tuple[str, float, float], Pose2 | None] = {}
        self._stands: dict[tuple[str, float, float], Pose2 | None] = {}

    def stand(self, table: Thing, x: float, y: float) -> Pose2 | None:
        """Return a world_T_base to which the base can drive and from which a place on a table is reached, or None.

        The base drives straight from the middle of the room to a point behind the stand, and then ahead.

        Args:
            table: The table.
            x: x of the place in the frame of the table's top [m].
            y: y of the place in the same frame [m].
        """
        key = (table.id, x, y)
        if key not in self._stands:
            self._stands[key] = self._found(table, x, y)
        return self._stands[key]

    def _found(self, table: Thing, x: float, y: float) -> Pose2 | None:
        depth, width, top = self._words.types[table.type].size_m
        if not TOP_M[0] <= top <= TOP_M[1] or abs(y) > width / 2.0:
            return None
        for gap in FROM_EDGE_M:
            if AHEAD_M[0] <= x + depth / 2.0 + gap <= AHEAD_M[1]:
                stands = (self._stand_at(table, gap, y + aside) for aside in ASIDE_M)
                found = next((world_T_base for world_T_base in stands if world_T_base is not None), None)
                if found is not None:
                    return found
        return None

    def _stand_at(self, table: Thing, gap: float, y: float) -> Pose2 | None:
        """Return world_T_base before a table; None if it or the way to it is not free."""
        key = (table.id, gap, y)
        if key not in self._ways:
            depth = self._words.types[table.type].size_m[0]
            world_T_base = compose2(table.at, (-depth / 2.0 - gap, y, 0.0))
            back = compose2(table.at, (-depth / 2.0 - BACK_M, y, 0.0))
            square = Footprint(world_T_base, (BASE_HALF_M, BASE_HALF_M), 0.0)
            free = all(apart(square, cover, 0.0) and apart(_way_to(back), cover, 0.0) for cover in self._covers)
            self._ways[key] = world_T_base if free else None
        return self._ways[key]

    def out_of_reach(self, table: Thing, x: float, y: float) -> bool:
        """Return whether the base overlaps an object on the floor at every pose near enough to a place on a table.

        It does if every point of a grid around the place is within a footprint grown by the circle in the base, less
        the grid's width.
        """
        px, py, _ = compose2(table.at, (x, y, 0.0))
        steps = np.arange(-ARM_M - GRID_M, ARM_M + GRID_M, GRID_M)
        gx, gy = (axis.ravel() for axis in np.meshgrid(px + steps, py + steps))
        near = np.hypot(gx - px, gy - py) <= ARM_M + GRID_M
        gx, gy = gx[near], gy[near]
        taken = np.zeros(len(gx), dtype=bool)
        for item in self._standing:
            taken |= beyond(item.at, self._words.types[item.type], gx, gy) <= INSCRIBED_M - GRID_M
        return bool(taken.all())


def _way_to(point: Pose2) -> Footprint:
    """Return the footprint of a turning base on the straight way from the middle of the room."""
    x, y, _ = point
    return Footprint((x / 2.0, y / 2.0, math.atan2(y, x)), (math.hypot(x, y) / 2.0, 0.0), DISC_M)


def in_the_way(thing: Thing, things: Sequence[Thing], words: Words) -> list[Thing]:
    """Return the objects that block a hand's way to an object, and those that block the way to them, nearest first."""
    found: dict[str, Thing] = {}
    open_ends = [thing]
    while open_ends:
        goal = open_ends.pop()
        for other in things:
            if other.on != goal.on or other.id in found or other.id == thing.id or other.at[0] >= goal.at[0]:
                continue
            if abs(other.at[1] - goal.at[1]) < HAND_HALF_M + max(words.types[other.type].size_m[:2]) / 2.0:
                found[other.id] = other
                open_ends.append(other)
    return sorted(found.values(), key=lambda other: (other.at[0], other.id))
