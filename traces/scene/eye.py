"""The first eye of a run: it maps points of the world to pixels of the picture.

If a viewer's window has another size or its eye is moved, labels laid out for this eye may cover something.
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
VIEW_PX: Final = (878, 578)  # size of the 3D view in a window of 1600 x 1000 with this layout
_NEAR_M: Final = 0.05  # points that are nearer, or behind the eye, are drawn at this distance
_FRAME: Final = 0.94  # largest share of the width and height of the picture that a framed scene fills
Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Eye:
    """A pinhole above the world, upright.

    Attributes:
        at: Its position, world frame [m].
        target: The point in the middle of the picture, world frame [m].
    """

    at: Xyz
    target: Xyz

    def pixels(self, points: Iterable[Xyz]) -> Points:
        """Return for each point of the world its column, its row (downwards) and the metres per pixel there."""
        right, up, forward = _axes(self)
        away = np.asarray(list(points), np.float64).reshape(-1, 3) - self.at
        depth = np.maximum(away @ forward, _NEAR_M)
        metres = depth / _FOCAL_PX
        return np.column_stack(
            (VIEW_PX[0] / 2.0 + away @ right / metres, VIEW_PX[1] / 2.0 - away @ up / metres, metres)
        )

    def moved(self, point: Xyz, columns: float, rows: float, nearer: float = 1.0) -> Xyz:
        """Return the point `columns` right of a point and `rows` below, at `nearer` times its distance from the eye."""
        right, up, _ = _axes(self)
        metres = float(self.pixels([point])[0, 2])
        away = np.asarray(point) + metres * (columns * right - rows * up) - self.at
        x, y, z = (float(part) for part in self.at + nearer * away)
        return x, y, z


_FOCAL_PX: Final = VIEW_PX[1] / 2.0 / math.tan(FIELD_RAD / 2.0)


def framing(balls: Points, azimuth: float, elevation: float) -> Eye:
    """Return the nearest eye in a direction that has all balls within the picture.

    Each edge of the picture bounds the eye to one side; the bound moves outwards as the eye moves forward. Opposite
    edges limit how far forward the eye can be; there it is midway between both bounds.

    Args:
        balls: Centres and radius, world frame, metres, shape (n, 4), at least one.
        azimuth: Direction of the eye from the balls, about the vertical, from the x axis on [rad].
        elevation: Direction of the eye above the ground, less than a right angle [rad].
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
