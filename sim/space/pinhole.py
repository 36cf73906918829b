"""The geometry of the camera: its frame, its field of view and the rays of its pixels.

Frames: the camera looks along x, y left, z up. Pixel (column, row) is the ray (1, -u / f, -v / f) with
u = column - columns / 2, v = row + 1 - rows / 2 and f = rows / 2 / tan(fovy / 2): the renderer's convention, which has
no half pixel in it.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FOVY_RAD = math.radians(45.6)
COLUMNS, ROWS = 320, 240


@dataclass(frozen=True, slots=True)
class Frame:
    """The pose of a rigid frame in another frame.

    Attributes:
        origin: Shape (3,), metres.
        axes: Its x, y and z axes as columns, shape (3, 3).
    """

    origin: NDArray[np.float64]
    axes: NDArray[np.float64]


def focal_px(rows: int) -> float:
    """Return the focal length in pixels of an image with so many rows."""
    return rows / 2.0 / math.tan(FOVY_RAD / 2.0)


def pixel_rays(columns: int, rows: int) -> NDArray[np.float64]:
    """Return the direction of every pixel, shape (rows, columns, 3), camera frame, x = 1."""
    u, v = np.meshgrid(np.arange(columns) - columns / 2.0, np.arange(rows) + 1.0 - rows / 2.0)
    return np.stack([np.ones_like(u), -u / focal_px(rows), -v / focal_px(rows)], axis=-1)
