"""Rigid motions of the plane, Pose2 (x, y, theta), their tangent space, and covariances in it.

`compose(a_T_b, b_T_c)` is `a_T_c`. Tangent vectors are (x, y, theta) in the frame of their pose. A pose with a tangent
v stands for `compose(pose, exp(v))`, as in GTSAM.
"""

import math

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Pose2, Upper3x3
from skolem.traces.messages.poses import compose2, inverse2, wrap_exactly

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


def compose(a_T_b: Pose2, b_T_c: Pose2) -> Pose2:
    """Return a_T_c, its angle in [-pi, pi]."""
    return compose2(a_T_b, b_T_c, wrap_exactly)


def inverse(a_T_b: Pose2) -> Pose2:
    """Return b_T_a, its angle in [-pi, pi]."""
    return inverse2(a_T_b, wrap_exactly)


def between(w_T_a: Pose2, w_T_b: Pose2) -> Pose2:
    """Return a_T_b."""
    return compose(inverse(w_T_a), w_T_b)


def exp(tangent: Vector) -> Pose2:
    """Return the pose after a motion along `tangent`, shape (3,), for one unit of time."""
    x, y, turn = (float(v) for v in tangent)
    a, b = _arc(turn)
    return (a * x - b * y, b * x + a * y, wrap_exactly(turn))


def log(pose: Pose2) -> Vector:
    """Return the tangent, shape (3,), whose `exp` is `pose`."""
    turn = wrap_exactly(pose[2])
    a, b = _arc(turn)
    d = a * a + b * b
    return np.array([(a * pose[0] + b * pose[1]) / d, (a * pose[1] - b * pose[0]) / d, turn])


def adjoint(a_T_b: Pose2) -> Matrix:
    """Return the matrix, shape (3, 3), that maps tangents in frame b to tangents in frame a."""
    x, y, theta = a_T_b
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, -s, y], [s, c, -x], [0.0, 0.0, 1.0]])


def relative_jacobian(a_T_b: Pose2) -> Matrix:
    """Return d(tangent of a_T_b) / d(tangents of w_T_a, w_T_b), shape (3, 6)."""
    return np.hstack([-adjoint(inverse(a_T_b)), np.eye(3)])


def apart(w_T_base: Pose2, w_T_a: Pose2, w_T_b: Pose2) -> tuple[Vector, Matrix]:
    """Return the vector from the place of a to that of b, base frame, shape (2,), and its derivative, shape (2, 9).

    The derivative is by the tangents of base, a and b.
    """
    (ax, ay, turned_a), (bx, by, turned_b) = (between(w_T_base, pose) for pose in (w_T_a, w_T_b))
    jacobian = np.zeros((2, 9))
    jacobian[:, 2] = (by - ay, ax - bx)  # by the base's heading
    for column, sign, turn in ((3, -1.0, turned_a), (6, 1.0, turned_b)):
        jacobian[:, column : column + 2] = sign * adjoint((0.0, 0.0, turn))[:2, :2]
    return np.array([bx - ax, by - ay]), jacobian


def turned(covariance: Matrix, angle: float) -> Matrix:
    """Return R C R' for a covariance C over (x, y, theta) and the rotation R by `angle`; the axes turn by -`angle`."""
    r = adjoint((0.0, 0.0, angle))
    return np.asarray(r @ covariance @ r.T)


def upper(covariance: Matrix) -> Upper3x3:
    """Return the upper triangle of a 3x3 matrix, row by row, as plain floats without negative zeros."""
    (a, b, c), (_, d, e), (_, _, f) = (covariance + 0.0).tolist()
    return (a, b, c, d, e, f)


def symmetric(upper_triangle: Upper3x3) -> Matrix:
    """Return the symmetric 3x3 matrix with a given upper triangle, row by row."""
    a, b, c, d, e, f = upper_triangle
    return np.array([[a, b, c], [b, d, e], [c, e, f]])


def _arc(turn: float) -> tuple[float, float]:
    """Return sin(turn) / turn and (1 - cos(turn)) / turn."""
    if abs(turn) < 1e-6:
        return 1.0 - turn * turn / 6.0, turn / 2.0
    return math.sin(turn) / turn, (1.0 - math.cos(turn)) / turn
