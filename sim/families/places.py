"""Places of objects on tables: without overlaps or overhangs, and in the groups of a layout.

Places are in the frame of a table's top: x points away from the robot, y to its left as it faces the table.
"""

import math
from collections.abc import Callable, Iterator, Sequence

from numpy.random import Generator

from skolem.sim.families.draws import between, pick
from skolem.sim.families.ranges import Range
from skolem.sim.families.shapes import apart
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.space.footprints import footprint
from skolem.traces.messages import ObjectType, Pose2

NEAR_X, NEAR_Y = (-0.33, 0.0), (-0.46, 0.46)  # reachable from the near side
WHOLE_X, WHOLE_Y = (-0.33, 0.33), (-0.53, 0.53)
NARROW_SIDE_RAD = 0.6  # greatest turn of a box that shows its narrow sides to the robot
EDGE_M = 0.02
TRIES = 400
ROW_FIRST_X, ROW_PITCH_Y = -0.345, 0.24
CRATE_PLAY = 0.15  # of the gap between crates


class NoPlaceError(Exception):
    """The objects of an attempt do not fit; another attempt is made."""


def anywhere(draw: Generator, kind: ObjectType, whole: bool = False) -> Pose2:
    """Return a uniformly drawn place on a table: where a hand can reach, or with `whole` anywhere."""
    x, y = (WHOLE_X, WHOLE_Y) if whole else (NEAR_X, NEAR_Y)
    return between(draw, *x), between(draw, *y), turned(draw, kind)


def turned(draw: Generator, kind: ObjectType) -> float:
    """Return a heading of an object at which a hand reaches a box's narrow sides from in front of the table."""
    if kind.shape == "cylinder":
        return between(draw, -3.0, 3.0)
    return between(draw, math.pi / 2 - NARROW_SIDE_RAD, math.pi / 2 + NARROW_SIDE_RAD)


def free_place(
    kind: ObjectType, on: str, standing: Sequence[Thing], gap_m: float, words: Words, proposal: Callable[[], Pose2]
) -> Pose2:
    """Return the first proposal that keeps a gap to all objects on the table and does not hang over its edge.

    Raises:
        NoPlaceError: If none of `TRIES` does.
    """
    for _ in range(TRIES):
        at = proposal()
        if is_free(kind, on, at, standing, gap_m, words):
            return at
    raise NoPlaceError(on)


def is_free(kind: ObjectType, on: str, at: Pose2, standing: Sequence[Thing], gap_m: float, words: Words) -> bool:
    """Return whether an object at a place keeps a gap to all objects on the table and stays within its edge."""
    half = words.types["table"].size_m
    reach = math.hypot(*kind.size_m[:2]) / 2.0 if kind.shape == "box" else max(kind.size_m[:2]) / 2.0
    if abs(at[0]) + reach + EDGE_M > half[0] / 2.0 or abs(at[1]) + reach + EDGE_M > half[1] / 2.0:
        return False
    cover = footprint(kind, at)
    others = (footprint(words.types[other.type], other.at) for other in standing if other.on == on)
    return all(apart(cover, other, gap_m) for other in others)


def beside(draw: Generator, kind: ObjectType, group: Sequence[Thing], gap_m: Range, words: Words) -> Pose2:
    """Return a place beside an object of a group, in any direction, with a gap in the range."""
    other, direction = pick(draw, group), between(draw, -math.pi, math.pi)
    away = _half(kind) + _half(words.types[other.type]) + between(draw, *gap_m)
    x, y = other.at[0] + away * math.cos(direction), other.at[1] + away * math.sin(direction)
    x, y = min(max(x, NEAR_X[0]), NEAR_X[1]), min(max(y, NEAR_Y[0]), NEAR_Y[1])
    return round(x, 4), round(y, 4), turned(draw, kind)


def before(draw: Generator, kind: ObjectType, hidden: Thing, gap_m: Range, words: Words) -> Pose2:
    """Return a place between an object and the robot."""
    away = _half(kind) + _half(words.types[hidden.type]) + between(draw, *gap_m)
    return round(hidden.at[0] - away, 4), round(hidden.at[1] + between(draw, -0.02, 0.02), 4), turned(draw, kind)


def rows(draw: Generator, count: int, deepest: int, gap_m: Range, widths: Sequence[float]) -> Iterator[Pose2]:
    """Yield places in rows that lead away from the robot, nearest first; every row but the last is full.

    Args:
        draw: Generator of the places.
        count: Number of objects.
        deepest: Number of objects in a full row.
        gap_m: Range of gaps between objects.
        widths: Diameter of each object.
    """
    number = -(-count // deepest)
    start = between(draw, -0.03, 0.03) - ROW_PITCH_Y * (number - 1) / 2.0
    x = ROW_FIRST_X
    for i in range(count):
        row, depth = divmod(i, deepest)
        x = ROW_FIRST_X if depth == 0 else round(x + (widths[i - 1] + widths[i]) / 2.0 + between(draw, *gap_m), 4)
        yield x, round(start + ROW_PITCH_Y * row, 4), between(draw, -3.0, 3.0)


def crates(draw: Generator, kind: ObjectType, table: ObjectType) -> Iterator[Pose2]:
    """Yield places of crates that fill a table except for gaps too narrow for any object."""
    (x, y, _), (length, width, _) = kind.size_m, table.size_m
    nx, ny = int(length // x), int(width // y)
    gap_x, gap_y = (length - nx * x) / (nx + 1), (width - ny * y) / (ny + 1)
    for i in range(nx):
        for j in range(ny):
            jitter = [between(draw, -CRATE_PLAY, CRATE_PLAY) * gap for gap in (gap_x, gap_y)]
            at_x, at_y = (i + 0.5) * x + (i + 1) * gap_x - length / 2.0, (j + 0.5) * y + (j + 1) * gap_y - width / 2.0
            yield round(at_x + jitter[0], 4), round(at_y + jitter[1], 4), 0.0


def _half(kind: ObjectType) -> float:
    return max(kind.size_m[:2]) / 2.0
