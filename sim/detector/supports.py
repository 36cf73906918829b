"""Supports: horizontal planes in a point cloud whose vertical is a few degrees off.

Heights are collected in a histogram weighted by the surface area of each pixel; the plane at its peak is fitted by
trimmed least squares; its points are removed and the search is repeated until no plane is large enough. A plane holds
the supports that `patches` finds in it: the tops of many things of one height lie in one plane and are no support.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.detector.patches import MIN_AREA_M2, MIN_RAY_SLOPE, Plane, patches

BIN_M = 0.01
PEAK_BINS = 5  # a tilt of 2 degrees spreads a table of 1.2 m over 4 cm
TRIM_M = (0.045, 0.03, 0.02, 0.015)  # successive distances within which a point belongs to the plane
NARROW_M, NARROW_SD, NARROW_STEPS = 0.002, 2.5, 3  # at last only the bulk: table edges and feet of objects bias a fit
MEDIAN_PER_SD = 0.6745  # of the absolute value of a Gaussian
MAX_SLOPE = 0.1  # of a fitted plane; six sd of a calibration error of 1 degree
MAX_PLANES = 12  # that are tried: the tops and sides of things in a crowd come before a small support


@dataclass(frozen=True, slots=True)
class Support:
    """A patch of a horizontal plane: normal . point = offset, over the hull of its visible points.

    Attributes:
        normal: Unit vector, shape (3,), pointing up, base frame.
        offset: Metres.
        hull: Lines (a, b, c) with a x + b y + c <= 0 inside, shape (k, 3).
        points: Its visible points, shape (n, 3), base frame.
    """

    normal: NDArray[np.float64]
    offset: float
    hull: NDArray[np.float64]
    points: NDArray[np.float64]

    def height(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distance above the plane of points of shape (n, 3); shape (n,), metres."""
        return np.asarray(points @ self.normal - self.offset)

    def covers(self, points: NDArray[np.float64], margin_m: float) -> NDArray[np.bool_]:
        """Return the mask, shape (n,), of points (n, 3) that lie over the hull or at most `margin_m` beside it."""
        beside = points[:, :2] @ self.hull[:, :2].T + self.hull[:, 2]
        return np.asarray(beside.max(axis=1) <= margin_m)

    def foot(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points, shape (n, 3), projected on the plane along its normal, shape (n, 3)."""
        return np.asarray(points - self.height(points)[:, None] * self.normal)

    def z_at(self, x: float, y: float) -> float:
        """Return the height of the plane at a place, metres, base frame."""
        return float((self.offset - self.normal[0] * x - self.normal[1] * y) / self.normal[2])


def find_supports(
    points_base: NDArray[np.float64],
    camera_base: NDArray[np.float64],
    focal_px: float,
    depth_sd_scale: float = 1.0,
    table_m2: float = 0.0,
    reach_m: float = np.inf,
) -> tuple[Support, ...]:
    """Return the supports in a cloud, highest first.

    Args:
        points_base: Shape (n, 3), metres, base frame, z nearly up.
        camera_base: Position of the camera, shape (3,), base frame.
        focal_px: Focal length of the depth image in pixels.
        depth_sd_scale: Factor on the standard deviation of depth readings.
        table_m2: Area of the smallest known table.
        reach_m: Greatest distance from the camera of a support's points; farther ones only show what is not there.
    """
    area = area_per_point(points_base, camera_base, focal_px)
    free = np.linalg.norm(points_base - camera_base, axis=1) < reach_m
    found: list[Support] = []
    for _ in range(MAX_PLANES):
        peak = _peak_height(points_base[free, 2], area[free])
        if peak is None:
            break
        slope = _fit(points_base[free], peak)
        near = free & (_distance(points_base, slope) < TRIM_M[-1])
        plane = Plane(points_base, camera_base, near, slope, area, focal_px, depth_sd_scale, table_m2)
        parts = patches(plane) if np.hypot(slope[0], slope[1]) < MAX_SLOPE else []
        found += [_support(points_base[part], slope) for part in parts]
        free &= ~near if parts else np.abs(points_base[:, 2] - peak) > TRIM_M[0]
    return tuple(sorted(found, key=lambda support: -float(np.median(support.points[:, 2]))))


def area_per_point(points: NDArray[np.float64], camera: NDArray[np.float64], focal_px: float) -> NDArray[np.float64]:
    """Return the horizontal surface area of each pixel, shape (n,), square metres; 0 for rays that go up."""
    ray = points - camera
    distance = np.linalg.norm(ray, axis=1)
    slope = -ray[:, 2] / np.maximum(distance, np.finfo(np.float64).tiny)
    return np.where(slope > MIN_RAY_SLOPE, (distance / focal_px) ** 2 / np.maximum(slope, MIN_RAY_SLOPE), 0.0)


def _peak_height(heights: NDArray[np.float64], area: NDArray[np.float64]) -> float | None:
    """Return the height around which most surface lies, or None if that is less than `MIN_AREA_M2`."""
    if not len(heights):
        return None
    lowest = np.floor(heights.min() / BIN_M) * BIN_M
    bins = ((heights - lowest) / BIN_M).astype(np.int64)
    histogram = np.bincount(bins, weights=area, minlength=PEAK_BINS)
    window = np.convolve(histogram, np.ones(PEAK_BINS), mode="same")
    peak = int(np.argmax(window))
    return float(lowest + (peak + 0.5) * BIN_M) if window[peak] >= MIN_AREA_M2 / 2.0 else None


def _fit(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Return (a, b, c) of z = a x + b y + c through the points near a height, by trimmed least squares."""
    plane = np.array([0.0, 0.0, height])
    design = np.column_stack([points[:, :2], np.ones(len(points))])
    for trim in (*TRIM_M, *[None] * NARROW_STEPS):
        distance = np.abs(points[:, 2] - design @ plane)
        near = distance < (_bulk(distance[distance < TRIM_M[-1]]) if trim is None else trim)
        if np.count_nonzero(near) < plane.size:
            break
        rows = design[near]  # normal equations, summed without BLAS: the same on any number of threads
        plane = np.linalg.solve(np.einsum("ni,nj->ij", rows, rows), np.einsum("ni,n->i", rows, points[near, 2]))
    return plane


def _bulk(distance: NDArray[np.float64]) -> float:
    """Return the distance from a plane within which most of its points lie, from their median distance."""
    sd = float(np.median(distance)) / MEDIAN_PER_SD if len(distance) else 0.0
    return max(NARROW_M, NARROW_SD * sd)


def _distance(points: NDArray[np.float64], plane: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the vertical distance of points, shape (n, 3), from z = a x + b y + c."""
    return np.asarray(np.abs(points[:, 2] - points[:, :2] @ plane[:2] - plane[2]))


def _support(points: NDArray[np.float64], plane: NDArray[np.float64]) -> Support:
    length = float(np.sqrt(plane[0] ** 2 + plane[1] ** 2 + 1.0))
    normal = np.array([-plane[0], -plane[1], 1.0]) / length
    return Support(normal, float(plane[2]) / length, scipy.spatial.ConvexHull(points[:, :2]).equations, points)
