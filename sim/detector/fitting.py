"""The fit of a type to a cluster of points: the best pose and the errors that remain.

The size of a type is known, so only its pose is fitted: least squares of the distance between points and outline, seen
from above, with the axis vertical on the support. Only part of an object is seen; a fit without the known size would be
off by several millimetres.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.traces.messages import ObjectType

OUTLIER_M = 0.004  # distances beyond this count linearly (soft L1)
OUTSIDE_M = 0.015  # a point this far outside the outline belongs to another object
TOP_M = 0.012  # points this near the top may lie inside the outline
TOP_PERCENTILE = 98.0  # of the heights: lies on the top, above its middle by as much as depth errors spread it
TOP_SPREAD_M = 0.006  # points this near that height are of the top
TOP_BIAS_M = 0.0005  # mean error of a seen top: 0.9 mm for a cylinder, none for a box
MAX_POINTS = 240  # greatest number of a cluster's points in a fit, evenly chosen
MAX_EVALUATIONS = 10  # per start of a fit; more move the best fit by less than a tenth of a millimetre
MODEL_SD_M = 0.0015  # least sd of a fit: depth steps and the outline's discreteness are common errors
PRIOR_SD = (0.05, 0.05, 1.8)  # m, m, rad: sd of a pose in a direction that the points do not constrain
YAW_STARTS = 4
UNKNOWN_YAW_SD_RAD = 1.8  # uniform over a full turn has sd pi / sqrt(3)

Residual = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Fit:
    """A type's best pose for a cluster.

    Attributes:
        height_error_m: Height of the cluster's top less that of the type.
        outline_error_m: Mean distance of the points from the outline.
        outside: Share of the points that lie clearly outside the outline; it is large for a cluster of two objects.
        xy_theta: Shape (3,), metres and radians, base frame; theta of a cylinder is 0.
        covariance: Of the fit alone, shape (3, 3), over (x, y, theta) along the base frame's axes.
    """

    height_error_m: float
    outline_error_m: float
    outside: float
    xy_theta: NDArray[np.float64]
    covariance: NDArray[np.float64]


def fit_type(
    outline_points: NDArray[np.float64],
    heights: NDArray[np.float64],
    camera_xy: NDArray[np.float64],
    kind: ObjectType,
    start: NDArray[np.float64] | None = None,
) -> Fit:
    """Return the best fit of a type to a cluster.

    Args:
        outline_points: The points' feet on the support, shape (n, 2), metres, base frame.
        heights: Their heights above the support, shape (n,), metres.
        camera_xy: Position of the camera, shape (2,); the far side of the object is not seen from there.
        kind: Shape and size of the type.
        start: A start pose (x, y, theta) beside those behind the seen side; it wins if others fit equally well.
    """
    every = len(heights) // MAX_POINTS + 1
    feet, is_top = outline_points[::every], heights[::every] > kind.size_m[2] - TOP_M
    distance = distance_to(kind)

    def residual(pose: NDArray[np.float64]) -> NDArray[np.float64]:
        signed = distance(feet, pose)
        return np.where(is_top, np.maximum(signed, 0.0), signed)

    fits = [
        scipy.optimize.least_squares(residual, pose, loss="soft_l1", f_scale=OUTLIER_M, max_nfev=MAX_EVALUATIONS)
        for pose in (
            ([] if start is None else [start[: 2 if kind.shape == "cylinder" else 3]]) + _starts(feet, camera_xy, kind)
        )
    ]
    best = min(fits, key=lambda fit: float(fit.cost))
    left = residual(best.x)
    spread = max(float(np.sqrt(np.mean(left**2))), MODEL_SD_M)
    return Fit(
        height_error_m=_top_m(heights) - kind.size_m[2],
        outline_error_m=float(np.abs(left).mean()),
        outside=float(np.mean(left > OUTSIDE_M)),
        xy_theta=_canonical(best.x, kind),
        covariance=_covariance(np.asarray(best.jac), spread),
    )


def _top_m(heights: NDArray[np.float64]) -> float:
    """Return the height of a cluster's top: the median of the points that depth errors spread around it."""
    high = np.percentile(heights, TOP_PERCENTILE, method="lower")
    return float(np.median(heights[np.abs(heights - high) < TOP_SPREAD_M])) - TOP_BIAS_M


def _starts(feet: NDArray[np.float64], camera_xy: NDArray[np.float64], kind: ObjectType) -> list[NDArray[np.float64]]:
    """Return the start poses of the fit: behind the seen side, and for a box at several headings."""
    centre = feet.mean(axis=0)
    away = (centre - camera_xy) / np.linalg.norm(centre - camera_xy)
    start = centre + away * 0.3 * min(kind.size_m[:2])
    if kind.shape == "cylinder":
        return [start]
    return [np.array([*start, k * math.pi / YAW_STARTS]) for k in range(YAW_STARTS)]


def distance_to(kind: ObjectType) -> Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    """Return the function that gives the signed distance of points (n, 2) from a type's outline at a pose.

    The distance is negative inside.
    """
    half = np.array(kind.size_m[:2]) / 2.0

    def circle(feet: NDArray[np.float64], pose: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.hypot(feet[:, 0] - pose[0], feet[:, 1] - pose[1]) - half[0])

    def rectangle(feet: NDArray[np.float64], pose: NDArray[np.float64]) -> NDArray[np.float64]:
        c, s = np.cos(pose[2]), np.sin(pose[2])
        beyond = np.abs((feet - pose[:2]) @ np.array([[c, -s], [s, c]])) - half
        outside = np.hypot(*np.maximum(beyond, 0.0).T)
        return np.asarray(np.where((beyond > 0.0).any(axis=1), outside, beyond.max(axis=1)))

    return circle if kind.shape == "cylinder" else rectangle


def _canonical(pose: NDArray[np.float64], kind: ObjectType) -> NDArray[np.float64]:
    """Return the pose with the one heading that stands for all equal ones.

    A cylinder's is 0; a box repeats every half turn, [-pi/2, pi/2), and a square one every quarter, [-pi/4, pi/4).
    """
    if kind.shape == "cylinder":
        return np.array([pose[0], pose[1], 0.0])
    period = math.pi / 2.0 if kind.size_m[0] == kind.size_m[1] else math.pi
    return np.array([pose[0], pose[1], (pose[2] + period / 2.0) % period - period / 2.0])


def _covariance(jacobian: NDArray[np.float64], spread: float) -> NDArray[np.float64]:
    """Return the covariance of a fitted pose, shape (3, 3); a cylinder's heading is unknown.

    All points share the errors of depth steps and outline, so they count as one for each parameter: the information is
    that of the mean squared Jacobian, not of the sum.
    """
    information = np.diag(1.0 / np.square(PRIOR_SD))
    size = jacobian.shape[1]
    information[:size, :size] += jacobian.T @ jacobian / len(jacobian) / spread**2
    covariance = np.linalg.inv(information)
    if size == 2:
        covariance[2, 2] = UNKNOWN_YAW_SD_RAD**2
    return np.asarray(covariance)
