"""The eye with which a run is first looked at: where points of the world are seen in the picture, in its pixels.

A viewer's window may have another size and its eye be moved; what is laid out for this one is then merely good.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.traces.rerun_shapes import Xyz

FIELD_RAD: Final = math.radians(55.0)  # the viewer's vertical field of view
VIEW_PX: Final = (878, 578)  # of the 3D view in a window of 1600 x 1000, as the layout divides it
_NEAR_M: Final = 0.05  # what is nearer, or behind the eye, is drawn as if it were there


@dataclass(frozen=True, slots=True)
class Eye:
    """A pinhole above the world, upright.

    Attributes:
        at: Where it is [m].
        target: The point in the middle of the picture [m].
    """

    at: Xyz
    target: Xyz

    def pixels(self, points: Iterable[Xyz]) -> NDArray[np.float64]:
        """Return where points of the world are seen: one row each of column, row (downwards) and metres per pixel."""
        right, up, forward = _axes(self)
        away = np.asarray(list(points), np.float64).reshape(-1, 3) - self.at
        depth = np.maximum(away @ forward, _NEAR_M)
        metres = depth / self._focal
        return np.column_stack(
            (VIEW_PX[0] / 2.0 + away @ right / metres, VIEW_PX[1] / 2.0 - away @ up / metres, metres)
        )

    def moved(self, point: Xyz, columns: float, rows: float, nearer: float = 1.0) -> Xyz:
        """Return the point seen so many pixels to the right of another and below, so many times as far from the eye."""
        right, up, _ = _axes(self)
        metres = float(self.pixels([point])[0, 2])
        away = np.asarray(point) + metres * (columns * right - rows * up) - self.at
        x, y, z = (float(part) for part in self.at + nearer * away)
        return x, y, z

    @property
    def _focal(self) -> float:
        """The focal length in pixels."""
        return VIEW_PX[1] / 2.0 / math.tan(FIELD_RAD / 2.0)


@cache
def _axes(eye: Eye) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the directions right, up and forward of an eye, unit vectors in the world."""
    forward = np.subtract(eye.target, eye.at)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward), forward


EYE: Final = Eye(at=(2.95, -0.75, 2.55), target=(0.3, -0.12, 0.68))
