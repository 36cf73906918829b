"""Assignment of the detections of a look to anchors, by squared Mahalanobis distances within a gate.

All detections of a look share the errors of the base and of the camera. A score of each pair alone would take these
errors for independent. So where a detection could be of several anchors, whole hypotheses are compared. Each hypothesis
carries the error that it implies: its first pair corrects the pose of the base, and the next pair is scored with the
corrected pose.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.se2 import Matrix, Vector, adjoint, between, compose, exp, inverse, log, turned
from skolem.traces.messages import ObjectType, Pose2

Array = NDArray[np.float64]
FORBIDDEN = 1e6  # cost of a pair outside the gate; greater than any finite score
MAX_LOG_ODDS = 50.0  # greatest log odds of one detection


@dataclass(frozen=True, slots=True)
class Measured:
    """A detected pose.

    Attributes:
        base_T_object: Mean pose.
        covariance: Over (x, y, theta), object frame, shape (3, 3).
    """

    base_T_object: Pose2
    covariance: Matrix


@dataclass(frozen=True, slots=True)
class Match:
    """The agreement of a detection with the believed pose of an anchor.

    Attributes:
        distance2: Squared Mahalanobis distance of the innovation.
        log_density: Logarithm of the density of the detected pose, per square metre and radian.
    """

    distance2: float
    log_density: float


def with_heading_near(
    measured: Measured, predicted: float, kind: ObjectType, seen_as: ObjectType, unknown_sd_rad: float
) -> Measured:
    """Return a detection with the equivalent heading nearest to `predicted` (radians).

    Headings are equivalent if an object of type `kind` looks the same at them: all headings of a cylinder, a box after
    half a turn, a square box after a quarter. If a box is detected as another type than the believed one, its heading
    is not measured, and its sd becomes that of an unknown heading.
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
    """Return the agreement of a detection with a believed base_T_object and its covariance (3, 3), object frame."""
    innovation = log(between(believed, measured.base_T_object))
    spread = covariance + turned(measured.covariance, innovation[2])
    distance2 = float(innovation @ np.linalg.solve(spread, innovation))
    return Match(distance2, -0.5 * (distance2 + float(np.linalg.slogdet(math.tau * spread)[1])))


def assign(scores: Array, unmatched: Array) -> tuple[int | None, ...]:
    """Return each detection's column of `scores`, or None for a new object, in the assignment of greatest score.

    Args:
        scores: Log-likelihood ratio of each (detection, anchor) pair, shape (n, m); -inf for an impossible pair.
        unmatched: Score of each detection if it is of no anchor, shape (n,).
    """
    n, m = scores.shape
    possible = np.isfinite(scores)
    if (possible.sum(axis=0) <= 1).all() and (possible.sum(axis=1) <= 1).all():  # no two compete
        wins = np.where(possible, scores - unmatched[:, None], -np.inf) > 0.0
        return tuple(int(np.argmax(row)) if row.any() else None for row in wins)
    from scipy.optimize import linear_sum_assignment  # its import takes a third of the time to start a replay

    cost = np.full((n, m + n), FORBIDDEN)
    cost[:, :m] = np.where(np.isfinite(scores), -scores, FORBIDDEN)
    cost[np.arange(n), m + np.arange(n)] = -unmatched
    rows, columns = linear_sum_assignment(cost)
    chosen = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    return tuple(chosen[row] if chosen[row] < m else None for row in range(n))


@dataclass(frozen=True, slots=True)
class Scene:
    """The belief before the look.

    Attributes:
        poses: First world_T_camera_base, the pose of the base that includes the camera's error; then world_T_object of
            each anchor.
        covariance: Joint covariance, shape (3n, 3n), tangent space of each pose.
    """

    poses: tuple[Pose2, ...]
    covariance: Matrix


@dataclass(frozen=True, slots=True)
class Pair:
    """A possible pair of a detection and an anchor.

    Attributes:
        column: Column of the anchor.
        measured: The detected pose; its covariance leaves out the error that is common to the look.
        bonus: The part of the score that does not depend on the pose: from type, existence and P(detected).
    """

    column: int
    measured: Measured
    bonus: float


@dataclass(frozen=True, slots=True)
class _Hypothesis:
    score: float
    scene: Scene
    columns: tuple[int | None, ...]


def is_ambiguous(scores: Array) -> bool:
    """Return whether some detection could be of several anchors, or several detections of one anchor.

    Args:
        scores: Score of each (detection, anchor) pair, shape (n, m); -inf for an impossible pair.
    """
    can = np.isfinite(scores)
    return bool((can.sum(axis=1) > 1).any() or (can.sum(axis=0) > 1).any())


def assign_jointly(
    scene: Scene, pairs: Sequence[Sequence[Pair]], unmatched: Array, gates: Sequence[float], width: int
) -> tuple[int | None, ...]:
    """Return each detection's column, or None for a new object, in the likeliest hypothesis that a beam search finds.

    Args:
        scene: Belief before the look; the anchor of column i has pose i + 1.
        pairs: The possible pairs of each detection.
        unmatched: Score of each detection if it is of no anchor, shape (n,).
        gates: Greatest squared Mahalanobis distance of each detection in a pair, given the pairs before it.
        width: Number of hypotheses kept after each detection.
    """
    order = sorted(range(len(pairs)), key=lambda i: (len(pairs[i]), i))  # the clearest first
    beam = [_Hypothesis(0.0, scene, ())]
    for i in order:
        grown = [_Hypothesis(h.score + float(unmatched[i]), h.scene, (*h.columns, None)) for h in beam]
        for h in beam:
            grown += [found for pair in pairs[i] if (found := _with(h, pair, gates[i])) is not None]
        beam = sorted(grown, key=lambda h: -h.score)[:width]
    best = dict(zip(order, beam[0].columns, strict=True))
    return tuple(best[i] for i in range(len(pairs)))


def _with(hypothesis: _Hypothesis, pair: Pair, gate: float) -> _Hypothesis | None:
    """Return a hypothesis with one more pair, or None if the pair is impossible in it."""
    if pair.column in hypothesis.columns:
        return None
    scene, at = hypothesis.scene, pair.column + 1
    expected = between(scene.poses[0], scene.poses[at])
    innovation = log(between(expected, pair.measured.base_T_object))
    jacobian = np.zeros((3, len(scene.covariance)))
    jacobian[:, :3], jacobian[:, 3 * at : 3 * at + 3] = -adjoint(inverse(expected)), np.eye(3)
    crossed = scene.covariance @ jacobian.T
    spread = jacobian @ crossed + pair.measured.covariance
    solved = np.linalg.solve(spread, np.column_stack([innovation, crossed.T]))
    distance2 = float(innovation @ solved[:, 0])
    if distance2 > gate:
        return None
    density = -0.5 * (distance2 + float(np.linalg.slogdet(2.0 * np.pi * spread)[1]))
    moved = _moved(scene, crossed @ solved[:, 0], scene.covariance - crossed @ solved[:, 1:])
    return _Hypothesis(hypothesis.score + density + pair.bonus, moved, (*hypothesis.columns, pair.column))


def _moved(scene: Scene, tangent: Vector, covariance: Matrix) -> Scene:
    poses = tuple(compose(pose, exp(tangent[3 * i : 3 * i + 3])) for i, pose in enumerate(scene.poses))
    return Scene(poses, covariance)
