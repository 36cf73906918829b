"""How uncertain the place of an object is, seen from the robot: what motions must leave room for."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from skolem.sim.poses import compose2, flat, inverse2
from skolem.traces.messages import Belief

Floats = NDArray[np.float64]

SPREAD_SDS, SPREAD_STEP_M = 2.0, 0.005


def spread(belief: Belief, anchor: str, limit_m: float) -> float:
    """Return by how much an object may be beside its mean place, in whole steps, at most `limit_m`."""
    deviation = math.sqrt(max(0.0, float(np.linalg.eigvalsh(relative_covariance(belief, anchor)[:2, :2])[-1])))
    return min(SPREAD_STEP_M * math.ceil(SPREAD_SDS * deviation / SPREAD_STEP_M - 1e-9), limit_m)


def relative_covariance(belief: Belief, anchor: str) -> Floats:
    """Return the covariance of base_T_object, shape (3, 3), x, y [m], theta [rad], tangent space, object frame.

    The base is the key of the joint covariance that names no object. Without both rows: the object's own marginal.
    """
    base = next((key for key in belief.keys if key not in belief.objects), None)
    if base is None or anchor not in belief.keys:
        return _symmetric(belief.objects[anchor].covariance, 3)
    joint = _symmetric(belief.joint_covariance, 3 * len(belief.keys))
    rows = [3 * belief.keys.index(key) + i for key in (base, anchor) for i in range(3)]
    object_T_base = compose2(inverse2(flat(belief.objects[anchor].world_T_object)), belief.world_T_base)
    x, y, theta = object_T_base
    c, s = math.cos(theta), math.sin(theta)
    adjoint = np.array([[c, -s, y], [s, c, -x], [0.0, 0.0, 1.0]])
    jacobian = np.hstack([-adjoint, np.eye(3)])
    return np.asarray(jacobian @ joint[np.ix_(rows, rows)] @ jacobian.T)


def _symmetric(upper: Sequence[float], n: int) -> Floats:
    """Return the symmetric matrix, shape (n, n), of an upper triangle in row order."""
    out = np.zeros((n, n))
    out[np.triu_indices(n)] = upper
    return np.asarray(out + out.T - np.diag(np.diag(out)))
