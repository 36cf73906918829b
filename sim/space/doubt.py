"""Doubts: the uncertainty of an object's place relative to the robot, for which motions must leave room."""

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Belief
from skolem.traces.messages.poses import compose2, flat, inverse2

Floats = NDArray[np.float64]

SPREAD_SDS, SPREAD_STEP_M = 2.0, 0.005


class Doubts:
    """The doubts in one belief; its joint covariance is unpacked once, on first use."""

    def __init__(self, belief: Belief) -> None:
        """Read a belief."""
        self._belief = belief
        self._rows = {key: range(3 * i, 3 * i + 3) for i, key in enumerate(belief.keys)}
        self._base = next((key for key in belief.keys if key not in belief.objects), None)

    def spread(self, anchor: str, limit_m: float) -> float:
        """Return how far an object may be from its mean place, metres, in whole steps, at most `limit_m`."""
        return _in_steps(_deviation(self.relative_covariance(anchor)), limit_m)

    def own_spread(self, anchor: str, limit_m: float) -> float:
        """Return how far an object may be from its place among the others: the least spread relative to any of them.

        Objects that were seen together share the errors of the camera and of every drive since, so whether one hides
        the other is less doubtful than their places.
        """
        others = [key for key in self._rows if key != anchor] if anchor in self._rows else []
        if not others:
            return self.spread(anchor, limit_m)
        return _in_steps(min(_deviation(self.relative_covariance(anchor, other)) for other in others), limit_m)

    def relative_covariance(self, anchor: str, other: str | None = None) -> Floats:
        """Return the covariance of other_T_object, shape (3, 3), x, y [m], theta [rad], tangent space, object frame.

        Without `other`, it is relative to the base: the key of the joint covariance that names no object. If the joint
        covariance lacks one of the two, it is the object's own marginal.
        """
        objects, base = self._belief.objects, other or self._base
        if base is None or anchor not in self._rows:
            return _symmetric(objects[anchor].covariance, 3)
        rows = [*self._rows[base], *self._rows[anchor]]
        seen_from = flat(objects[base].world_T_object) if base in objects else self._belief.world_T_base
        x, y, theta = compose2(inverse2(flat(objects[anchor].world_T_object)), seen_from)
        c, s = math.cos(theta), math.sin(theta)
        adjoint = np.array([[c, -s, y], [s, c, -x], [0.0, 0.0, 1.0]])
        jacobian = np.hstack([-adjoint, np.eye(3)])
        return np.asarray(jacobian @ self._joint[np.ix_(rows, rows)] @ jacobian.T)

    @cached_property
    def _joint(self) -> Floats:
        return _symmetric(self._belief.joint_covariance, 3 * len(self._belief.keys))


def _deviation(covariance: Floats) -> float:
    return math.sqrt(max(0.0, float(np.linalg.eigvalsh(covariance[:2, :2])[-1])))


def _in_steps(deviation: float, limit_m: float) -> float:
    return min(SPREAD_STEP_M * math.ceil(SPREAD_SDS * deviation / SPREAD_STEP_M - 1e-9), limit_m)


def _symmetric(upper: Sequence[float], n: int) -> Floats:
    """Return the symmetric matrix, shape (n, n), of an upper triangle in row order."""
    out = np.zeros((n, n))
    out[np.triu_indices(n)] = upper
    return np.asarray(out + out.T - np.diag(np.diag(out)))
