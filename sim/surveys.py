"""Looks at a region: which way to turn the head so that most of what is still unseen comes into view."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.believed import BelievedWorld, Standing
from skolem.sim.cloud import COLUMNS, FOVY_RAD, ROWS
from skolem.sim.poses import Vector3, compose4
from skolem.traces.messages import RegionBelief

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

NEAREST_M, FARTHEST_M = 0.5, 2.2  # from the camera
WITHIN = 0.92  # of the image: the base and the head err a little


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


def unseen_points(region: RegionBelief, support: Standing) -> Floats:
    """Return the points of a region that are known to be unseen, shape (n, 3), world."""
    top = support.type.size_m[2]
    points = [
        compose4(support.world_T_object, (x / 1000.0, y / 1000.0, top + z / 1000.0, 0.0))[:3]
        for x, y, z in region.unseen_mm
    ]
    return np.reshape(np.array(points, dtype=np.float64), (-1, 3))


def survey(world: BelievedWorld, points: Floats) -> Survey | None:
    """Turn the head from where the robot stands and return the best of a few looks; None if none shows anything.

    Args:
        world: The robot and all that may be in the way.
        points: Shape (n, 3), world.
    """
    best: Survey | None = None
    if not len(points) or world.look_at(_mean(points)) is None:
        return None
    for aim in _aims(world, points):
        found = _shown_from(world, points, aim)
        if found is not None and found.shown.any():
            found = _shown_from(world, points, _mean(points[found.shown])) or found
        if found is not None and found.shown.any() and (best is None or found.shown.sum() > best.shown.sum()):
            best = found
    return best


def _aims(world: BelievedWorld, points: Floats) -> list[Vector3]:
    """Return the middles of what nothing hides: of all of it, of its left and of its right half."""
    eye, _ = world.robot.camera_pose()
    open_to = points[_unhidden(world, points, eye)]
    if not len(open_to):
        return []
    middle = _mean(open_to)
    along = (middle[0] - eye[0], middle[1] - eye[1])
    left = along[0] * (open_to[:, 1] - eye[1]) - along[1] * (open_to[:, 0] - eye[0]) > 0.0
    return [middle, *(_mean(half) for half in (open_to[left], open_to[~left]) if len(half))]


def _shown_from(world: BelievedWorld, points: Floats, target: Vector3) -> Survey | None:
    head = world.look_at(target)
    if head is None:
        return None
    eye, axes = world.robot.camera_pose()
    forward, left, up = ((points - eye) @ axes).T
    half = WITHIN * math.tan(FOVY_RAD / 2.0)
    inside = (forward > 0.0) & (np.abs(up) <= half * forward) & (np.abs(left) <= half * COLUMNS / ROWS * forward)
    return Survey(head, target, inside & _unhidden(world, points, eye))


def _unhidden(world: BelievedWorld, points: Floats, eye: Floats) -> Mask:
    """Return which points are in range with nothing before them, shape (n,)."""
    distance = np.linalg.norm(points - eye, axis=1)
    near = (distance >= NEAREST_M) & (distance <= FARTHEST_M)
    return near & (np.array(world.hits(points)) == -1)


def _mean(points: Floats) -> Vector3:
    x, y, z = points.mean(axis=0)
    return (float(x), float(y), float(z))
