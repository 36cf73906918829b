"""Drives: collision-free paths of the base in the believed world, with arms and carried objects as they are."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner import motion
from skolem.sim.planner.believed import BelievedWorld
from skolem.traces.messages import Pose2
from skolem.traces.messages.poses import compose2, inverse2

Floats = NDArray[np.float64]

MARGINS_M = (0.10, 0.04, 0.02, 0.0)  # distances kept on the path, tried in this order
ROOM_M = 1.5  # margin around all believed objects in which the base may drive
RESOLUTION = 0.07  # m or rad between checked poses; between them no part moves farther than the widest margin
STRIDE = 1.5  # m or rad
BUDGET = 6000  # validity checks; a path around a table takes about 2000
ESCAPES_M, ESCAPE_DIRECTIONS = (0.04, 0.08, 0.12, 0.16), 12  # steps out of a body in which the robot believes to stand
SHARPEST_TURN_RAD = 0.5  # between two waypoints, so that the shorter turn is the intended one


def drive(world: BelievedWorld, start: Pose2, goal: Pose2, seed: int) -> tuple[Pose2, ...] | None:
    """Return base poses in the frame of the start, the start first, along a free path; None if none is found.

    A robot that believes to stand in an obstacle, by a few centimetres of doubt, steps out of it first.
    """
    world.reset()
    try:
        first = _out(world, start)
        if first is None:
            return None
        for margin in MARGINS_M:
            problem = _problem(world, start, goal, margin)
            if problem.valid(np.array(first)) and problem.valid(np.array(goal)):
                path = motion.plan(problem, np.array(first), np.array(goal), seed)
                if path is not None:
                    return _from_start(start, path if first == start else np.vstack([start, path]))
        return None
    finally:
        world.reset()


def _out(world: BelievedWorld, start: Pose2) -> Pose2 | None:
    """Return the start if it is free, else the nearest free pose a step away, else None."""
    turns = [k * 2.0 * math.pi / ESCAPE_DIRECTIONS for k in range(ESCAPE_DIRECTIONS)]
    steps = [(0.0, 0.0), *((length, turn) for length in ESCAPES_M for turn in turns)]
    for length, turn in steps:
        pose = (start[0] + length * math.cos(turn), start[1] + length * math.sin(turn), start[2])
        world.set_base(pose)
        if world.free():
            return pose
    return None


def _problem(world: BelievedWorld, start: Pose2, goal: Pose2, margin: float) -> motion.Problem:
    """Return the planning problem of base poses; a pose is free if all of the robot keeps the margin."""

    def valid(world_T_base: Floats) -> bool:
        world.set_base(world_T_base)
        return world.free() and (margin == 0.0 or world.clear(margin))

    points = [item.world_T_object[:2] for item in world.standing.values()] + [start[:2], goal[:2]]
    low, high = np.min(points, axis=0) - ROOM_M, np.max(points, axis=0) + ROOM_M
    lower, upper = np.array([*low, -math.pi]), np.array([*high, math.pi])
    return motion.Problem(lower, upper, (False, False, True), valid, RESOLUTION, STRIDE, BUDGET)


def _from_start(start: Pose2, world_T_waypoint: Floats) -> tuple[Pose2, ...]:
    """Return world poses, shape (k, 3), as waypoints in the frame of the start with small turns between them."""
    dense = [world_T_waypoint[0]]
    for here, there in pairwise(world_T_waypoint):
        count = max(1, math.ceil(abs(there[2] - here[2]) / SHARPEST_TURN_RAD))
        dense += [here + (there - here) * k / count for k in range(1, count + 1)]
    back = inverse2(start)
    return tuple(compose2(back, (float(x), float(y), float(theta))) for x, y, theta in dense)
