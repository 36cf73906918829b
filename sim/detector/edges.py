"""Where the top of a table ends in a picture: edges of a plane against what lies below it.

Only what is certain counts. A ray that reaches a point below the plane has passed through it where no table is; next to
a pixel that shows the plane, it is beyond an edge. What lies above the plane may hide more of it, the border of the
image cuts it, and where nothing came back nothing is known: none of these is an edge.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skolem.sim.detector.cloud import Cloud
from skolem.sim.detector.supports import Support

ON_M = 0.015  # points this near a plane show it
REACH_M = 2.4  # from the camera; beyond it depth errors tell no plane from what is below
GAP_PX = 3  # a depth camera loses a pixel on either side of an edge
RUN_PX = 3  # so many pixels in a row lie below before the first of them counts
FACE_M = 0.06  # what is below within this distance is the front of the table: it ends where the top does
CELL_M = 0.04  # parts of a plane that touch on a grid of this width are one

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Top:
    """One connected part of a plane, and its seen edges, all along the plane in the base frame's x and y.

    Attributes:
        cloud: Its points.
        inside: Where the rays of these points cross the plane, shape (n, 2), metres.
        edge: Points on its edges, shape (k, 2).
        outward: Which way the plane ends at each of them, roughly, unit vectors, shape (k, 2).
        gap_m: How far apart the last ray on the plane and the first one beyond it are, shape (k,).
    """

    cloud: Cloud
    inside: Array
    edge: Array
    outward: Array
    gap_m: Array


def tops(cloud: Cloud, support: Support) -> list[Top]:
    """Return the connected parts of a plane, largest first.

    Args:
        cloud: Everything seen, in the order of its pixels.
        support: The plane.
    """
    height = support.height(cloud.points_base)
    near = np.linalg.norm(cloud.points_base - cloud.camera_base, axis=1) < REACH_M
    on, below = near & (np.abs(height) < ON_M), height < -ON_M
    crossing = _crossings(cloud, height, support)
    foot = support.foot(cloud.points_base)[:, :2]
    part = _parts(foot, on)
    inner, outer = _steps_over_edges(cloud.pixel, on, below)
    front = np.linalg.norm(cloud.points_base[outer] - cloud.points_base[inner], axis=1) < FACE_M
    edge = np.where(front[:, None], foot[outer], (crossing[inner] + crossing[outer]) / 2.0)
    step = crossing[outer] - crossing[inner]
    gap = np.linalg.norm(step, axis=1)
    outward = step / np.maximum(gap, np.finfo(np.float64).tiny)[:, None]
    found = []
    for index in range(1, int(part.max(initial=0)) + 1):
        mine, its = part == index, part[inner] == index
        found.append(Top(cloud.only(mine), crossing[mine], edge[its], outward[its], gap[its]))
    return sorted(found, key=lambda top: -len(top.inside))


def passed(cloud: Cloud, support: Support, depth_m: float) -> Array:
    """Return where the rays to points at least `depth_m` below a plane crossed it, shape (m, 2)."""
    height = support.height(cloud.points_base)
    return _crossings(cloud, height, support)[height < -depth_m]


def _crossings(cloud: Cloud, height: Array, support: Support) -> Array:
    """Return where the ray to each point crosses the plane, shape (n, 2); a point above it is drawn out to there."""
    eye = float(support.height(cloud.camera_base[None])[0])
    share = eye / np.maximum(eye - height, ON_M)
    return np.asarray((cloud.camera_base + share[:, None] * (cloud.points_base - cloud.camera_base))[:, :2])


def _parts(foot: Array, on: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return for each point the number of the connected part of the plane it shows, from 1; 0 if it shows none."""
    part = np.zeros(len(foot), dtype=np.int64)
    if on.any():
        cell = np.floor((foot[on] - foot[on].min(axis=0)) / CELL_M).astype(np.int64)
        grid = np.zeros(cell.max(axis=0) + 1, dtype=bool)
        grid[tuple(cell.T)] = True
        label, _ = ndimage.label(grid, structure=np.ones((3, 3)))
        part[on] = label[tuple(cell.T)]
    return part


def _steps_over_edges(
    pixel: NDArray[np.int64], on: NDArray[np.bool_], below: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the points on the plane that are next to one below it, and those, along rows and columns both ways."""
    margin = GAP_PX + RUN_PX
    rows, columns = pixel.max(axis=0, initial=0) + 1 + 2 * margin
    at = np.full((rows, columns), -1, dtype=np.int64)
    at[pixel[:, 0] + margin, pixel[:, 1] + margin] = np.arange(len(pixel))
    start = pixel[on] + margin
    inner, outer = [], []
    for direction in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        line = [start + step * np.array(direction) for step in range(1, margin + 1)]
        ahead = np.array([at[place[:, 0], place[:, 1]] for place in line])  # (margin, k), -1: nothing came back
        known = ahead >= 0
        first = np.argmax(known, axis=0)
        run = first + np.arange(RUN_PX)[:, None]
        column = np.arange(len(start))
        beyond = known[run % margin, column] & below[ahead[run % margin, column]]
        silent = ~known[run % margin, column]
        over = known.any(axis=0) & (first <= GAP_PX - 1) & beyond[0] & (beyond | silent).all(axis=0)
        over &= beyond.sum(axis=0) > RUN_PX / 2
        inner.append(np.flatnonzero(on)[over])
        outer.append(ahead[first, column][over])
    return np.concatenate(inner), np.concatenate(outer)
