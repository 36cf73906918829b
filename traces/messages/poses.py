"""Poses of upright objects: composition and inverse of Pose2 (x, y, theta) and Pose4 (x, y, z, theta).

`compose2(a_T_b, b_T_c)` is `a_T_c`. All numbers are plain floats: metres, radians.

Two functions wrap an angle into one turn. Recorded runs hold the last bits of both, so each side keeps its own: the
estimator `wrap_exactly`, simulators and planners `wrap_half_open`.
"""

import math
from collections.abc import Callable

from skolem.traces.messages.base import Pose2, Pose4

Quaternion = tuple[float, float, float, float]
Vector3 = tuple[float, float, float]


def wrap_exactly(angle: float) -> float:
    """Return the angle in [-pi, pi]; an angle in that range is not rounded."""
    return math.remainder(angle, math.tau)


def wrap_half_open(angle: float) -> float:
    """Return the angle in [-pi, pi): unique for each direction, but most angles are rounded in their last bits."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def compose2(a_T_b: Pose2, b_T_c: Pose2, wrap: Callable[[float], float] = wrap_half_open) -> Pose2:
    """Return a_T_c, its angle wrapped by `wrap`."""
    x, y, theta = a_T_b
    c, s = math.cos(theta), math.sin(theta)
    return (x + c * b_T_c[0] - s * b_T_c[1], y + s * b_T_c[0] + c * b_T_c[1], wrap(theta + b_T_c[2]))


def inverse2(a_T_b: Pose2, wrap: Callable[[float], float] = wrap_half_open) -> Pose2:
    """Return b_T_a, its angle wrapped by `wrap`."""
    x, y, theta = a_T_b
    c, s = math.cos(theta), math.sin(theta)
    return (-c * x - s * y, s * x - c * y, wrap(-theta))


def compose4(a_T_b: Pose4, b_T_c: Pose4) -> Pose4:
    """Return a_T_c."""
    x, y, theta = compose2(flat(a_T_b), flat(b_T_c))
    return (x, y, a_T_b[2] + b_T_c[2], theta)


def inverse4(a_T_b: Pose4) -> Pose4:
    """Return b_T_a."""
    x, y, theta = inverse2(flat(a_T_b))
    return (x, y, -a_T_b[2], theta)


def flat(a_T_b: Pose4) -> Pose2:
    """Drop the height."""
    return (a_T_b[0], a_T_b[1], a_T_b[3])


def raised(a_T_b: Pose2, z: float = 0.0) -> Pose4:
    """Add a height; no number of the result is a negative zero."""
    return (a_T_b[0] + 0.0, a_T_b[1] + 0.0, z + 0.0, a_T_b[2] + 0.0)


def quaternion_xyzw(theta: float) -> Quaternion:
    """Return the rotation about z by theta."""
    return (0.0, 0.0, math.sin(theta / 2.0), math.cos(theta / 2.0))


def heading(quaternion: Quaternion) -> float:
    """Return the direction of the frame's x axis seen from above; its yaw, if the frame is upright."""
    x, y, z, w = quaternion
    return math.atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))
