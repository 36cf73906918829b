"""Which detection is of which anchor, decided jointly: hypotheses over a whole look.

Pairs scored one by one take errors for independent that are common to a look: of the base, and of the camera. Where a
detection could be of several anchors, hypotheses are compared that each carry the error they imply: a first pair says
how far off the base is, and with that the next pair is judged.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.association import Measured
from skolem.estimation.se2 import Matrix, Vector, adjoint, between, compose, exp, inverse, log
from skolem.traces.messages import Pose2

Array = NDArray[np.float64]


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
