"""Looks at a region: which way to turn the head so that most of what is still unseen comes into view."""

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
ENOUGH_SHARE = 0.3  # of what is unseen: a look that shows so much is worth taking wherever one stands
ALMOST_BEST = 0.7  # ... as is one that shows so much of what the best stance shows
LEAST_SHARE = 0.04  # a look that shows less is none
SAME_HEAD_RAD = 0.04  # a look that would not turn the head by more was just taken: it shows nothing new
AHEAD = (0.0, 0.0)  # pan and tilt while the base drives: where it arrives no look has been taken yet


class Camera(Protocol):
    """A camera that can be turned."""

    def look_at(self, point_world: Vector3, /) -> tuple[float, float] | None:
        """Turn it so that the optical axis goes through a point; None, and nothing turned, beyond its limits."""
        ...

    def camera_pose(self) -> tuple[Floats, Floats]:
        """Return its position, shape (3,), and rotation, shape (3, 3); x is forward, y left, z up."""
        ...

    def unhidden(self, points_world: Floats, /) -> Mask:
        """Return before which points, shape (n, 3), nothing stands."""
        ...


@dataclass(frozen=True, slots=True)
class Survey:
    """A look and what it shows.

    Attributes:
        head: Pan and tilt.
        target: The point in the middle of the image.
        shown: Which of the points come into view, shape (n,).
    """

    head: tuple[float, float]
    target: Vector3
    shown: Mask

    @property
    def share(self) -> float:
        """How much of what is unseen the look shows."""
        return float(self.shown.mean())


def unseen_points(region: RegionBelief, world_T_support: Pose4, top: float) -> Floats:
    """Return the points of a region that are known to be unseen, shape (n, 3), world; the support is `top` high."""
    points = [
        compose4(world_T_support, (x / 1000.0, y / 1000.0, top + z / 1000.0, 0.0))[:3] for x, y, z in region.unseen_mm
    ]
    return np.reshape(np.array(points, dtype=np.float64), (-1, 3))


def survey(camera: Camera, points: Floats) -> Survey | None:
    """Turn the head from where the robot stands and return the best of a few looks; None if none shows anything.

    Args:
        camera: What looks, and all that may be in its way.
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
    """Return whether the head is turned that way already: what the picture should have shown did not appear."""
    return bool(np.abs(np.subtract(found.head, head)).max() < SAME_HEAD_RAD)


def is_worth_it(here: Survey, others: Callable[[], Iterable[Survey]]) -> bool:
    """Return whether a look from here shows enough, compared, if need be, with what other stances show."""
    if here.share >= ENOUGH_SHARE:
        return True
    best = max((found.share for found in others()), default=0.0)
    return here.share >= max(LEAST_SHARE, ALMOST_BEST * best)


def _aims(camera: Camera, points: Floats) -> list[Vector3]:
    """Return the middles of what nothing hides: of all of it, of its left and of its right half."""
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
    """Return which points are in range with nothing before them, shape (n,)."""
    distance = np.linalg.norm(points - eye, axis=1)
    near = (distance >= NEAREST_M) & (distance <= FARTHEST_M)
    return np.asarray(near & camera.unhidden(points))


def _mean(points: Floats) -> Vector3:
    x, y, z = points.mean(axis=0)
    return (float(x), float(y), float(z))
