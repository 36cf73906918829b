"""Tests on Gaussian beliefs: probability mass in a polygon, and comparison of covariances. Pure functions."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import owens_t

Array = NDArray[np.float64]
LEAST_SD = 1e-9  # metres; a narrower Gaussian is widened to this before it is whitened
TINY = 1e-300  # divisor instead of zero


def prob_in_polygon(mean: Array, covariance: Array, vertices: Array) -> float:
    """Return P(x in the polygon) for a Gaussian x, to about 1e-12.

    The polygon is whitened and cut into signed triangles from the mean to each edge; the mass of such a triangle is a
    difference of Owen's T functions (Owen, "Tables for computing bivariate normal probabilities", 1956).

    Args:
        mean: Mean of x, shape (2,).
        covariance: Covariance of x, shape (2, 2), in the frame of `vertices`.
        vertices: Vertices of a simple polygon, counter-clockwise, shape (m, 2), in the unit of `mean`.
    """
    a = max(math.sqrt(covariance[0, 0]), LEAST_SD)
    b = covariance[1, 0] / a
    c = math.sqrt(max(covariance[1, 1] - b * b, LEAST_SD**2))
    offset = vertices - mean
    white = np.column_stack([offset[:, 0] / a, (offset[:, 1] - b * offset[:, 0] / a) / c])
    edge = np.roll(white, -1, axis=0) - white
    length = np.hypot(edge[:, 0], edge[:, 1])
    start, end = white[length > 0.0], np.roll(white, -1, axis=0)[length > 0.0]
    along = edge[length > 0.0] / length[length > 0.0, None]
    side = start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]  # signed distance of the edge's line from the mean
    distance = np.maximum(np.abs(side), TINY)
    mass = _triangle(distance, (end * along).sum(axis=1)) - _triangle(distance, (start * along).sum(axis=1))
    return float(min(1.0, max(0.0, (np.sign(side) * mass).sum())))


def _triangle(distance: Array, reach: Array) -> Array:
    """Return the signed standard normal mass of right triangles at the origin with legs `distance` and `reach`."""
    return np.asarray(np.arctan2(reach, distance) / math.tau - owens_t(distance, reach / distance))


def rectangle(size: tuple[float, float]) -> Array:
    """Return the corners of an axis-aligned rectangle around the origin, counter-clockwise, shape (4, 2)."""
    return np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * size


def disc(radius: float, corners: int = 32) -> Array:
    """Return a regular polygon with the area of a disc around the origin, counter-clockwise, shape (corners, 2)."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    reach = radius * math.sqrt(2.0 * math.pi / (corners * math.sin(2.0 * math.pi / corners)))
    return reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def covariance_within(covariance: Array, bound: Array) -> bool:
    """Return whether covariance <= bound in the Loewner order, up to rounding: its ellipsoid lies in the bound's.

    Both have shape (n, n) and the same frame.
    """
    return bool(np.linalg.eigvalsh(bound - covariance)[0] >= -1e-9 * np.trace(bound))
