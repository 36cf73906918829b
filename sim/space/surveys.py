"""Looks at a region: the head angles that show most of its unseen part."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skolem.sim.space.pinhole import COLUMNS, FOVY_RAD, ROWS
from skolem.traces.messages import Pose4, RegionBelief
from skolem.traces.messages.poses import Vector3, compose4

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

NEAREST_M, FARTHEST_M = 0.5, 2.2  # from the camera
WITHIN = 0.92  # of the image: the base and the head err a little
ENOUGH_SHARE = 0.3  # of the unseen part: a look that shows so much is worth taking from any stance
ALMOST_BEST = 0.7  # ... as is one that shows this fraction of the best stance's share
LEAST_SHARE = 0.04  # a look that shows less is not worth taking
SAME_HEAD_RAD = 0.04  # a look that turns the head by less shows nothing new
AHEAD = (0.0, 0.0)  # pan and tilt while the base drives; no look has been taken yet at its end


class Camera(Protocol):
    """A camera that can be turned."""

    def look_at(self, point_world: Vector3, /) -> tuple[float, float] | None:
        """Turn the optical axis through a point and return pan and tilt; beyond the limits return None, unturned."""
        ...

    def camera_pose(self) -> tuple[Floats, Floats]:
        """Return its position, shape (3,), and rotation, shape (3, 3); x is forward, y left, z up."""
        ...

    def unhidden(self, points_world: Floats, /) -> Mask:
        """Return the mask, shape (n,), of points (n, 3) that nothing hides."""
        ...


@dataclass(frozen=True, slots=True)
class Survey:
    """A look and the points that it shows.

    Attributes:
        head: Pan and tilt.
        target: The point in the middle of the image.
        shown: Mask of the points that come into view, shape (n,).
    """

    head: tuple[float, float]
    target: Vector3
    shown: Mask

    @property
    def share(self) -> float:
        """The share of the unseen points that the look shows."""
        return float(self.shown.mean())


def unseen_points(region: RegionBelief, world_T_support: Pose4, top: float) -> Floats:
    """Return the unseen points of a region, shape (n, 3), metres, world; the support is `top` high."""
    points = [
        compose4(world_T_support, (x / 1000.0, y / 1000.0, top + z / 1000.0, 0.0))[:3] for x, y, z in region.unseen_mm
    ]
    return np.reshape(np.array(points, dtype=np.float64), (-1, 3))


def survey(camera: Camera, points: Floats) -> Survey | None:
    """Turn the head from where the robot stands and return the best of a few looks; None if none shows anything.

    Args:
        camera: The camera, with the objects that may hide points.
        points: Shape (n, 3), world.
    """
    best: Survey | None = None
    if not len(points) or camera.look_at(_mean(points)) is None:
        return None
    for aim in _aims(camera, points):
        found = _shown_from(camera, points, aim)
        if found is not None and found.shown.any():
            found = _shown_from(camera, points, _mean(points[found.shown])) or found
        if found is not None and found.shown.any() and (best is None or found.shown.sum() > best.shown.sum()):
            best = found
    return best


def was_taken(found: Survey, head: tuple[float, float]) -> bool:
    """Return whether the head is turned that way already, so that the look would show nothing new."""
    return bool(np.abs(np.subtract(found.head, head)).max() < SAME_HEAD_RAD)


def is_worth_it(here: Survey, others: Callable[[], Iterable[Survey]]) -> bool:
    """Return whether a look from here shows enough, if necessary in comparison with other stances."""
    if here.share >= ENOUGH_SHARE:
        return True
    best = max((found.share for found in others()), default=0.0)
    return here.share >= max(LEAST_SHARE, ALMOST_BEST * best)


def _aims(camera: Camera, points: Floats) -> list[Vector3]:
    """Return the middles of the unhidden points: of all, of the left half and of the right half."""
    eye, _ = camera.camera_pose()
    open_to = points[_unhidden(camera, points, eye)]
    if not len(open_to):
        return []
    middle = _mean(open_to)
    along = (middle[0] - eye[0], middle[1] - eye[1])
    left = along[0] * (open_to[:, 1] - eye[1]) - along[1] * (open_to[:, 0] - eye[0]) > 0.0
    return [middle, *(_mean(half) for half in (open_to[left], open_to[~left]) if len(half))]


def _shown_from(camera: Camera, points: Floats, target: Vector3) -> Survey | None:
    head = camera.look_at(target)
    if head is None:
        return None
    eye, axes = camera.camera_pose()
    forward, left, up = ((points - eye) @ axes).T
    half = WITHIN * math.tan(FOVY_RAD / 2.0)
    inside = (forward > 0.0) & (np.abs(up) <= half * forward) & (np.abs(left) <= half * COLUMNS / ROWS * forward)
    return Survey(head, target, inside & _unhidden(camera, points, eye))


def _unhidden(camera: Camera, points: Floats, eye: Floats) -> Mask:
    """Return the mask, shape (n,), of points in range that nothing hides."""
    distance = np.linalg.norm(points - eye, axis=1)
    near = (distance >= NEAREST_M) & (distance <= FARTHEST_M)
    return np.asarray(near & camera.unhidden(points))


def _mean(points: Floats) -> Vector3:
    x, y, z = points.mean(axis=0)
    return (float(x), float(y), float(z))
