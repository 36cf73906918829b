"""Edges of table tops in a picture: pixels of a plane next to pixels of points below it.

Only certain edges count. A ray to a point below the plane crosses the plane where no table is; if the pixel beside it
shows the plane, there is an edge between them. An object above the plane may hide more of it, the border of the image
cuts it, and a pixel without reading shows nothing: none of these is an edge.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.detector.cloud import Cloud
from skolem.sim.detector.supports import Support

ON_M = 0.015  # points this near a plane show it
BESIDE_M = 0.03  # points this far beside a support's hull may be of it
REACH_M = 2.4  # from the camera; beyond it depth errors hide the step between a plane and points below it
GAP_PX = 3  # a depth camera loses a pixel on either side of an edge
RUN_PX = 3  # most of so many pixels in a row must lie below the plane
FACE_M = 0.06  # a point below nearer than this may be the table's front, which ends where the top does
CELL_M = 0.04  # width of the grid on which parts of a plane are connected

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Top:
    """One connected part of a plane and its seen edges, in the base frame's x and y.

    Attributes:
        cloud: Its points.
        inside: Crossings of these points' rays with the plane, shape (n, 2), metres.
        edge: Points on its edges, shape (k, 2).
        outward: Rough direction in which the plane ends at each edge point, unit vectors, shape (k, 2).
        gap_m: Distance between the last ray on the plane and the first one beyond it, shape (k,).
    """

    cloud: Cloud
    inside: Array
    edge: Array
    outward: Array
    gap_m: Array


def tops(cloud: Cloud, support: Support) -> list[Top]:
    """Return the connected parts of a support's plane over its hull, largest first.

    Args:
        cloud: All seen points, in the order of their pixels.
        support: The support.
    """
    height = support.height(cloud.points_base)
    near = np.linalg.norm(cloud.points_base - cloud.camera_base, axis=1) < REACH_M
    on, below = near & (np.abs(height) < ON_M), height < -ON_M
    on[on] = support.covers(cloud.points_base[on], BESIDE_M)
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
    """Return the crossings with a plane of the rays to points at least `depth_m` below it, shape (m, 2)."""
    height = support.height(cloud.points_base)
    return _crossings(cloud, height, support)[height < -depth_m]


def _crossings(cloud: Cloud, height: Array, support: Support) -> Array:
    """Return the crossing of each point's ray with the plane, shape (n, 2); rays to points above it are extended."""
    eye = float(support.height(cloud.camera_base[None])[0])
    share = eye / np.maximum(eye - height, ON_M)
    return np.asarray((cloud.camera_base + share[:, None] * (cloud.points_base - cloud.camera_base))[:, :2])


def _parts(foot: Array, on: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the number, from 1, of the connected part of the plane that each point shows, shape (n,); 0 for none."""
    part = np.zeros(len(foot), dtype=np.int64)
    if on.any():
        cell = np.floor((foot[on] - foot[on].min(axis=0)) / CELL_M).astype(np.int64)
        grid = np.zeros(cell.max(axis=0) + 1, dtype=bool)
        grid[tuple(cell.T)] = True
        label, _ = scipy.ndimage.label(grid, structure=np.ones((3, 3)))
        part[on] = label[tuple(cell.T)]
    return part


def _steps_over_edges(
    pixel: NDArray[np.int64], on: NDArray[np.bool_], below: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the indices of plane points next to a point below the plane, and of the latter, in all four directions."""
    margin = GAP_PX + RUN_PX
    rows, columns = pixel.max(axis=0, initial=0) + 1 + 2 * margin
    at = np.full((rows, columns), -1, dtype=np.int64)
    at[pixel[:, 0] + margin, pixel[:, 1] + margin] = np.arange(len(pixel))
    start = pixel[on] + margin
    inner, outer = [], []
    for direction in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        line = [start + step * np.array(direction) for step in range(1, margin + 1)]
        ahead = np.array([at[place[:, 0], place[:, 1]] for place in line])  # (margin, k), -1: no reading
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
