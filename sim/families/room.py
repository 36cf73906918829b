"""Places of the tables around the robot, each with its x axis pointing away from it."""

import math

from numpy.random import Generator

from skolem.sim.families.draws import DIGITS, between
from skolem.sim.families.ranges import Variant
from skolem.sim.families.things import Thing
from skolem.traces.messages import Pose2

RADIUS_M = {3: (1.25, 1.45), 6: (2.2, 2.4)}  # of the circle around the robot
TURN_RAD = 0.06  # greatest turn of a table
SIDE_M = (0.802, 1.202)  # distances of tables in a block, which nearly touch
BLOCK_M = 1.75  # from the robot to the near edge of a block
TABLE = "table"


def tables(draw: Generator, variant: Variant) -> list[Thing]:
    """Return the tables: front, right and left of the robot, or in equal directions; a block of nine in one family."""
    directions = (0.0, -math.pi / 2, math.pi / 2) if variant.tables == 3 else _all_around(variant.tables)
    around = [_around(draw, direction, *RADIUS_M[variant.tables]) for direction in directions]
    if variant.impossible == "nothing_reached":
        around = [*around[1:], *_block(draw)]
    return [Thing(f"table{i + 1}", TABLE, None, at) for i, at in enumerate(around)]


def _all_around(count: int) -> tuple[float, ...]:
    return tuple(2.0 * math.pi * i / count for i in range(count))


def _around(draw: Generator, direction: float, low: float, high: float) -> Pose2:
    radius, turn = between(draw, low, high), between(draw, -TURN_RAD, TURN_RAD)
    x, y = radius * math.cos(direction), radius * math.sin(direction)
    return (round(x, DIGITS), round(y, DIGITS), round(direction + turn, DIGITS))


def _block(draw: Generator) -> list[Pose2]:
    """Return nine tables in front of the robot, the middle one last."""
    near = BLOCK_M + between(draw, 0.0, 0.2)
    middle = near + 1.5 * SIDE_M[0]
    cells = sorted(((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)), key=lambda cell: cell == (0, 0))
    return [(round(middle + i * SIDE_M[0], DIGITS), round(j * SIDE_M[1], DIGITS), 0.0) for i, j in cells]
