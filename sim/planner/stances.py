"""Stances: base poses on a fixed grid around a target, sorted by cost.

A stance has the target at one of several offsets in the base frame, each with a quality, and one of many headings.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Pose2

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

BASE_HALF_M = 0.335  # half the side of the base's outline
OUTLINE = np.linspace(-BASE_HALF_M, BASE_HALF_M, 5)
CLEARANCE_M = 0.06  # least distance of the base from objects on the floor: odometry errs by 3 to 5 cm
AMPLE_M, TIGHT_COST = 0.12, 4.0  # cost per m of distance below AMPLE_M
HEADINGS = 24
LEAST_QUALITY = 0.3
DRIVE_COST, TURN_COST = 0.15, 0.05  # per m and per rad, against a quality of 1


@dataclass(frozen=True, slots=True)
class Footprint:
    """A rectangle on the floor: its pose in the world and half its sides [m]."""

    world_T_middle: Pose2
    half: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Stances:
    """Base poses by rising cost.

    Attributes:
        world_T_base: Shape (k, 3).
        target: Index of each stance's target, shape (k,).
    """

    world_T_base: Floats
    target: Ints


def headings(theta: float) -> Floats:
    """Return headings of the base, among them the four that face a table's edges squarely."""
    return np.asarray(theta + np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS))


def around(
    targets: Floats, penalty: Floats, offsets: Floats, quality: Floats, directions: Floats, present: Pose2
) -> tuple[Stances, Floats]:
    """Return every combination of target, offset and direction as a base pose, with its cost, unsorted.

    Args:
        targets: Shape (t, 2), in the world.
        penalty: Shape (t,), cost of each target.
        offsets: Shape (o, 2), of the target in the base frame.
        quality: Shape (o, h), 0..1; combinations below `LEAST_QUALITY` are left out.
        directions: Shape (h,), headings of the base.
        present: Present pose of the base.
    """
    t, o, h = (a.ravel() for a in np.indices((len(targets), len(offsets), len(directions))))
    good = quality[o, h] >= LEAST_QUALITY
    t, o, h = t[good], o[good], h[good]
    c, s = np.cos(directions[h]), np.sin(directions[h])
    x = targets[t, 0] - c * offsets[o, 0] + s * offsets[o, 1]
    y = targets[t, 1] - s * offsets[o, 0] - c * offsets[o, 1]
    turn = np.abs((directions[h] - present[2] + math.pi) % (2.0 * math.pi) - math.pi)
    drive = np.hypot(x - present[0], y - present[1])
    cost = penalty[t] + 1.0 - quality[o, h] + DRIVE_COST * drive + TURN_COST * turn
    return Stances(np.stack([x, y, directions[h]], axis=1), t), cost


def standable(stances: Stances, cost: Floats, obstacles: list[Footprint], clearance_m: float = CLEARANCE_M) -> Stances:
    """Return the stances whose base keeps clear of all obstacles, by rising cost; narrow spaces cost more."""
    room = np.full(len(cost), AMPLE_M)
    for obstacle in obstacles:
        room = np.minimum(room, clearance(stances.world_T_base, obstacle))
    cost = np.round(cost + TIGHT_COST * (AMPLE_M - room), 9)
    keep = np.flatnonzero(room >= clearance_m)
    keep = keep[np.argsort(cost[keep], kind="stable")]
    return Stances(stances.world_T_base[keep], stances.target[keep])


def clearance(world_T_base: Floats, obstacle: Footprint) -> Floats:
    """Return the distance between the base's outline and a rectangle, negative inside, shape (n,), from shape (n, 3).

    Exact where corner meets edge; where two edges cross without a corner inside, points along the outline find it.
    """
    corners = np.array([(a * obstacle.half[0], b * obstacle.half[1]) for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
    edge = np.full(len(OUTLINE), BASE_HALF_M)
    sides = ((OUTLINE, edge), (OUTLINE, -edge), (edge, OUTLINE), (-edge, OUTLINE))
    outline = np.concatenate([np.stack(side, axis=1) for side in sides])
    base_T_obstacle, obstacle_T_base = _relative(world_T_base, obstacle.world_T_middle)
    of_base = _signed_distance(_moved(obstacle_T_base, outline), np.array(obstacle.half))
    of_obstacle = _signed_distance(_moved(base_T_obstacle, corners), np.array([BASE_HALF_M, BASE_HALF_M]))
    return np.asarray(np.minimum(of_base.min(axis=1), of_obstacle.min(axis=1)))


def _relative(world_T_base: Floats, world_T_middle: Pose2) -> tuple[Floats, Floats]:
    """Return base_T_middle and middle_T_base, shape (n, 3) each."""
    middle = np.array(world_T_middle)
    delta = middle - world_T_base
    return _turned(delta, -world_T_base[:, 2]), _turned(-delta, np.full(len(delta), -middle[2]))


def _turned(poses: Floats, angle: Floats) -> Floats:
    """Return poses with their positions turned about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * poses[:, 0] - s * poses[:, 1], s * poses[:, 0] + c * poses[:, 1], poses[:, 2]], axis=1)


def _moved(a_T_b: Floats, points: Floats) -> Floats:
    """Return points (k, 2) of frame b in frame a, shape (n, k, 2)."""
    c, s = np.cos(a_T_b[:, 2, None]), np.sin(a_T_b[:, 2, None])
    x = a_T_b[:, 0, None] + c * points[:, 0] - s * points[:, 1]
    y = a_T_b[:, 1, None] + s * points[:, 0] + c * points[:, 1]
    return np.stack([x, y], axis=2)


def _signed_distance(points: Floats, half: Floats) -> Floats:
    """Return the distance of points (..., 2) from a rectangle around the origin, negative inside."""
    beyond = np.abs(points) - half
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
    return np.asarray(outside + np.minimum(beyond.max(axis=-1), 0.0))
