"""Which detection is of which anchor: squared Mahalanobis distance, a gate, and the best assignment of a whole look."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.se2 import Matrix, between, compose, log, turned
from skolem.traces.messages import ObjectType, Pose2

Array = NDArray[np.float64]
FORBIDDEN = 1e6  # cost of a pair outside the gate; beyond any finite score
MAX_LOG_ODDS = 50.0  # a detection is never surer than this


@dataclass(frozen=True, slots=True)
class Measured:
    """A detected pose.

    Attributes:
        base_T_object: Mean.
        covariance: Over (x, y, theta), object frame, shape (3, 3).
    """

    base_T_object: Pose2
    covariance: Matrix


@dataclass(frozen=True, slots=True)
class Match:
    """How a detection agrees with where an anchor is believed to be.

    Attributes:
        distance2: Squared Mahalanobis distance of the innovation.
        log_density: Of the detection's pose, per square metre and radian.
    """

    distance2: float
    log_density: float


def with_heading_near(
    measured: Measured, predicted: float, kind: ObjectType, seen_as: ObjectType, unknown_sd_rad: float
) -> Measured:
    """Return the same detection with, of all headings at which `kind` looks alike, the one nearest to `predicted`.

    A cylinder looks alike at all headings, a box after half a turn, a square one after a quarter. The heading of a box
    that is believed to be of another type is not measured: its sd is that of a heading of which nothing is known.
    """
    x, y, theta = measured.base_T_object
    turn = predicted - theta
    if kind.shape != "cylinder":
        period = math.pi / 2.0 if kind.size_m[0] == kind.size_m[1] else math.pi
        turn = period * round(turn / period)
    pose = compose((x, y, theta), (0.0, 0.0, turn))
    covariance = turned(measured.covariance, -turn)
    if seen_as != kind and seen_as.shape != "cylinder":
        covariance = covariance + np.diag([0.0, 0.0, unknown_sd_rad**2])
    return Measured(pose, covariance)


def match(believed: Pose2, covariance: Matrix, measured: Measured) -> Match:
    """Return how well a detection agrees with a believed base_T_object and its covariance (object frame)."""
    innovation = log(between(believed, measured.base_T_object))
    spread = covariance + turned(measured.covariance, innovation[2])
    distance2 = float(innovation @ np.linalg.solve(spread, innovation))
    return Match(distance2, -0.5 * (distance2 + float(np.linalg.slogdet(math.tau * spread)[1])))


def assign(scores: Array, unmatched: Array) -> tuple[int | None, ...]:
    """Return for each detection its anchor's column, or None for a new one, maximising the sum of scores.

    Args:
        scores: Log-likelihood ratio of each (detection, anchor) pair, shape (n, m); -inf where they cannot be one.
        unmatched: Score of each detection if it is of no anchor, shape (n,).
    """
    n, m = scores.shape
    possible = np.isfinite(scores)
    if (possible.sum(axis=0) <= 1).all() and (possible.sum(axis=1) <= 1).all():  # no two compete
        wins = np.where(possible, scores - unmatched[:, None], -np.inf) > 0.0
        return tuple(int(np.argmax(row)) if row.any() else None for row in wins)
    from scipy.optimize import linear_sum_assignment  # a third of the time that a replay takes to start

    cost = np.full((n, m + n), FORBIDDEN)
    cost[:, :m] = np.where(np.isfinite(scores), -scores, FORBIDDEN)
    cost[np.arange(n), m + np.arange(n)] = -unmatched
    rows, columns = linear_sum_assignment(cost)
    chosen = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    return tuple(chosen[row] if chosen[row] < m else None for row in range(n))
