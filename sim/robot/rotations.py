"""Rotations about coordinate axes as matrices."""

import math

import numpy as np
from numpy.typing import NDArray


def about(axis: str, angle: float) -> NDArray[np.float64]:
    """Return the rotation by `angle` about the axis x, y or z, shape (3, 3)."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[j, i] = math.sin(angle)
    turn[i, j] = -math.sin(angle)
    return turn


def rotation(theta: float) -> NDArray[np.float64]:
    """Return the rotation by `theta` about z, shape (3, 3): the orientation of an upright object."""
    return about("z", theta)
