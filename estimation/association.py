"""Which detection is of which anchor: squared Mahalanobis distance, a gate, and the best assignment of a whole look.

Pairs scored one by one take errors for independent that are common to a look: of the base, and of the camera. Where a
detection could be of several anchors, hypotheses are compared that each carry the error they imply: a first pair says
how far off the base is, and with that the next pair is judged.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.se2 import Matrix, Vector, adjoint, between, compose, exp, inverse, log, turned
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


@dataclass(frozen=True, slots=True)
class Scene:
    """What is believed before the look.

    Attributes:
        poses: world_T_camera_base, the base frame as the camera has it, then world_T_object of each anchor.
        covariance: Joint, shape (3n, 3n), tangent space of each pose.
    """

    poses: tuple[Pose2, ...]
    covariance: Matrix


@dataclass(frozen=True, slots=True)
class Pair:
    """An anchor that a detection may be of.

    Attributes:
        column: Of the anchor.
        measured: What was measured; covariance without the error that is common to the look.
        bonus: The score beside that of the pose: type, existence, and what speaks for a report.
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
    """Return whether some detection could be of several anchors, or some anchor several detections' own.

    Args:
        scores: Of each (detection, anchor) pair, shape (n, m); -inf where they cannot be one.
    """
    can = np.isfinite(scores)
    return bool((can.sum(axis=1) > 1).any() or (can.sum(axis=0) > 1).any())


def assign_jointly(
    scene: Scene, pairs: Sequence[Sequence[Pair]], unmatched: Array, gates: Sequence[float], width: int
) -> tuple[int | None, ...]:
    """Return for each detection its anchor's column, or None for a new one, of the likeliest hypothesis.

    Args:
        scene: Belief before the look; anchor `column` is pose `column + 1`.
        pairs: Of each detection, the anchors it may be of.
        unmatched: Score of each detection if it is of no anchor, shape (n,).
        gates: Of each detection, the squared Mahalanobis distance beyond which a pair is none, given the pairs before.
        width: Hypotheses kept after each detection.
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
    """Return a hypothesis with one more pair, or None if that cannot be one."""
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
