"""A coarse depth image as arrays: what the space between the camera and the things it saw is known to be."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import DepthView

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class DepthImage:
    """The arrays of a `DepthView`.

    Attributes:
        origin: Of the camera, shape (3,), metres, base frame.
        axes: Rotation base_R_camera, shape (3, 3); the camera looks along x, y is left, z is up.
        focal_px: Focal length, pixels.
        depth: Distance along the camera's axis, shape (rows, columns), metres; 0 where nothing came back.
        hits: Where the readings ended, shape (m, 3), metres, base frame.
    """

    origin: Array
    axes: Array
    focal_px: float
    depth: Array
    hits: Array

    @classmethod
    def of(cls, view: DepthView) -> "DepthImage":
        """Return the image of a message."""
        depth = np.array(view.depth_mm, dtype=np.float64).reshape(view.rows, view.columns) / 1000.0
        focal_px = view.rows / 2.0 / math.tan(view.fovy_rad / 2.0)
        origin, axes = np.array(view.base_T_camera[:3]), _rotation(*view.base_T_camera[3:])
        return cls(origin, axes, focal_px, depth, _hits(depth, focal_px, axes, origin))

    def read(self, points_base: Array) -> tuple[Array, Array]:
        """Return how far along the camera's axis points are, and the depth the image has in their direction.

        Args:
            points_base: Shape (n, 3), metres, base frame.

        Returns:
            Two arrays of shape (n,), metres. The reading is that of the nearest pixel; 0 where nothing came back, NaN
            for points outside of the image or behind the camera.
        """
        forward, left, up = (self.axes.T @ (points_base - self.origin).T).copy()
        rows, columns = self.depth.shape
        ahead = forward > 0.0
        scale = self.focal_px / np.where(ahead, forward, 1.0)
        column = np.rint(columns / 2.0 - left * scale)
        row = np.rint(rows / 2.0 - 1.0 - up * scale)
        inside = np.nonzero(ahead & (column >= 0) & (column < columns) & (row >= 0) & (row < rows))[0]
        reading = np.full(len(points_base), math.nan)
        reading[inside] = self.depth[row[inside].astype(np.int64), column[inside].astype(np.int64)]
        return forward, reading


def _hits(depth: Array, focal_px: float, axes: Array, origin: Array) -> Array:
    row, column = np.nonzero(depth)
    rows, columns = depth.shape
    left, up = (columns / 2.0 - column) / focal_px, (rows / 2.0 - 1.0 - row) / focal_px
    rays = np.stack([np.ones(len(row)), left, up], axis=1)
    return np.asarray((rays * depth[row, column, None]) @ axes.T + origin)


def _rotation(x: float, y: float, z: float, w: float) -> Array:
    """Return the matrix of a unit quaternion xyzw."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
