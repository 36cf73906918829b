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

from skolem.traces.scene.shapes import Xyz

FIELD_RAD: Final = math.radians(55.0)  # the viewer's vertical field of view
VIEW_PX: Final = (878, 578)  # of the 3D view in a window of 1600 x 1000, as the layout divides it
_NEAR_M: Final = 0.05  # what is nearer, or behind the eye, is drawn as if it were there
_FRAME: Final = 0.94  # share of the picture, across and upwards, that a framed scene fills at most
Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Eye:
    """A pinhole above the world, upright.

    Attributes:
        at: Where it is [m].
        target: The point in the middle of the picture [m].
    """

    at: Xyz
    target: Xyz

    def pixels(self, points: Iterable[Xyz]) -> Points:
        """Return where points of the world are seen: one row each of column, row (downwards) and metres per pixel."""
        right, up, forward = _axes(self)
        away = np.asarray(list(points), np.float64).reshape(-1, 3) - self.at
        depth = np.maximum(away @ forward, _NEAR_M)
        metres = depth / _FOCAL_PX
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


_FOCAL_PX: Final = VIEW_PX[1] / 2.0 / math.tan(FIELD_RAD / 2.0)


def framing(balls: Points, azimuth: float, elevation: float) -> Eye:
    """Return the nearest eye that looks from a side and sees all balls within the picture.

    A ball is off an edge of the picture if the eye is far enough to that side, and the farther forward the farther:
    opposite edges bound how far forward it can be, and there it is midway between both bounds.

    Args:
        balls: Centres and radius, world frame, metres, shape (n, 4), at least one.
        azimuth: Where the eye is, seen from the balls, about the vertical from the x axis on [rad].
        elevation: The same, upwards from the ground, less than a right angle [rad].
    """
    away = (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation))
    axes = _axes(Eye(away, (0.0, 0.0, 0.0)))
    depth = balls[:, :3] @ axes[2]
    middle, farthest_forward = [], []
    for axis, room in zip(axes, VIEW_PX, strict=False):
        slope = _FRAME * room / 2.0 / _FOCAL_PX
        across, radius = balls[:, :3] @ axis, balls[:, 3] * math.hypot(1.0, slope)
        ceiling, floor = np.min(across - radius + slope * depth), np.max(across + radius - slope * depth)
        middle.append((ceiling + floor) / 2.0)
        farthest_forward.append((ceiling - floor) / 2.0 / slope)
    forward = min(farthest_forward)
    at = middle[0] * axes[0] + middle[1] * axes[1] + forward * axes[2]
    target = at + (float(np.mean(depth)) - forward) * axes[2]
    return Eye((float(at[0]), float(at[1]), float(at[2])), (float(target[0]), float(target[1]), float(target[2])))


@cache
def _axes(eye: Eye) -> tuple[Points, Points, Points]:
    """Return the directions right, up and forward of an eye, unit vectors in the world."""
    forward = np.subtract(eye.target, eye.at)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward), forward
