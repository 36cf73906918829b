"""Sight: whether the robot can turn its camera to an object and see it from its present pose."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.standing import Standing
from skolem.sim.space.footprints import collide
from skolem.traces.messages import ObjectType, Pose4
from skolem.traces.messages.poses import Vector3, compose4

Floats = NDArray[np.float64]

NEAREST_M, FARTHEST_M = 0.5, 2.0  # from the camera: nearer there are no readings, farther their noise is too great
THING_SHARE, TABLE_SHARE = 0.6, 0.5  # least seen share of the sampled points; objects on a table hide some of it
_ACROSS, _UP = (-0.8, 0.0, 0.8), (0.2, 0.5, 0.85)  # sample points on the near side, in half widths and in heights
_OVER = (-0.35, 0.0, 0.35)  # sample points on a table, in widths
_PATCH_M = 0.05  # half the width of the patch of a table that must be seen before an object is put there


@dataclass(frozen=True, slots=True)
class View:
    """A view: the camera's target and the points that must be seen.

    Attributes:
        head: Pan and tilt.
        target: The point in the middle of the image.
        points: Points of the object at each of its g possible places, shape (g, n, 3), metres, world.
        bodies: Bodies that do not hide them: the object's own, and those believed to intersect it, since a look shows
            which of the two is elsewhere.
        share: Share of the n points that must be seen at every place.
    """

    head: tuple[float, float]
    target: Vector3
    points: Floats
    bodies: frozenset[int]
    share: float

    def is_seen(self, hits: Sequence[int]) -> bool:
        """Return whether enough of the points are seen, given the first body before each."""
        free = np.array([hit == -1 or hit in self.bodies for hit in hits]).reshape(self.points.shape[:2])
        return bool(free.mean(axis=1).min() >= self.share)


def look(world: BelievedWorld, item: Standing) -> tuple[float, float] | None:
    """Turn the head to a standing object and return pan and tilt; None if it is too near, too far or hidden."""
    return _seen(world, towards(world, item))


def look_at_spot(world: BelievedWorld, table: Standing, spot: tuple[float, float]) -> tuple[float, float] | None:
    """Turn the head to a spot on a table (table frame) and return pan and tilt; None if it cannot be seen."""
    top = table.type.size_m[2]
    target = compose4(table.world_T_object, (*spot, top, 0.0))[:3]
    offsets = [(dx, dy) for dx in (-_PATCH_M, 0.0, _PATCH_M) for dy in (-_PATCH_M, 0.0, _PATCH_M)]
    points = [compose4(table.world_T_object, (spot[0] + dx, spot[1] + dy, top, 0.0))[:3] for dx, dy in offsets]
    return _seen(world, _turn(world, target, np.array([points]), frozenset({table.body}), THING_SHARE))


def towards(world: BelievedWorld, item: Standing) -> View | None:
    """Turn the head to a standing object, hidden or not, and return the view; None if it is out of range."""
    target = centre(item.type, item.world_T_object)
    is_table = item.type.shape == "table"
    eye = world.robot.camera_pose()[0]
    points = _on_table(item) if is_table else _near_side(item, eye)
    bodies = {item.body} if is_table else {other.body for other in world.standing.values() if _is_in(other, item)}
    return _turn(world, target, points, frozenset(bodies), TABLE_SHARE if is_table else THING_SHARE)


def hiders(world: BelievedWorld, view: View, movable: Collection[str]) -> tuple[str, ...] | None:
    """Return the movable objects that hide a view, the one that hides most first; None if others hide it too.

    The head must be turned as the view says. An object behind a removed one may hide the view too.
    """
    gone: tuple[str, ...] = ()
    while True:
        with world.removed(gone):
            hits = world.hits(view.points.reshape(-1, 3))
        if view.is_seen(hits):
            return gone
        left = [a for a in movable if a not in gone and world.standing[a].body not in view.bodies]
        counts = {a: hits.count(world.standing[a].body) for a in left}
        most = max(sorted(counts), key=lambda anchor: counts[anchor], default=None)
        if most is None or counts[most] == 0:
            return None
        gone = (*gone, most)


def centre(object_type: ObjectType, world_T_object: Pose4) -> Vector3:
    """Return the point to look at: the top of a table, the middle of any other object."""
    x, y, z, _ = world_T_object
    height = object_type.size_m[2]
    return (x, y, z + (height if object_type.shape == "table" else height / 2.0))


def _is_in(other: Standing, item: Standing) -> bool:
    """Return whether `other` is the item itself or is believed to intersect it."""
    is_thing = other.type.shape != "table"
    return other is item or (is_thing and collide(other.type, other.world_T_object, item.type, item.world_T_object))


def _seen(world: BelievedWorld, view: View | None) -> tuple[float, float] | None:
    """Return pan and tilt of a view if enough of it is seen."""
    return view.head if view is not None and view.is_seen(world.hits(view.points.reshape(-1, 3))) else None


def _turn(world: BelievedWorld, target: Vector3, points: Floats, bodies: frozenset[int], share: float) -> View | None:
    """Turn the head to a point and return the view if it is in range."""
    head = world.look_at(target)
    if head is None or not NEAREST_M <= math.dist(world.robot.camera_pose()[0], target) <= FARTHEST_M:
        return None
    return View(head, target, points, bodies, share)


def _near_side(item: Standing, eye: Floats) -> Floats:
    """Return points in the plane through an object's axis that faces the eye, within its outline, shape (g, 9, 3).

    If its place is in doubt, there is one set at the mean place and one on each side of it.
    """
    x, y, z, _ = item.world_T_object
    bearing = math.atan2(eye[1] - y, eye[0] - x)
    half = min(item.type.size_m[:2]) / 2.0
    left = (-math.sin(bearing) * half, math.cos(bearing) * half)
    height = item.type.size_m[2]
    there = np.array([(x + a * left[0], y + a * left[1], z + b * height) for a in _ACROSS for b in _UP])
    aside = np.array([-math.sin(bearing), math.cos(bearing), 0.0]) * item.own_m
    return np.array([there + side * aside for side in ((0.0, -1.0, 1.0) if item.own_m > 0.0 else (0.0,))])


def _on_table(item: Standing) -> Floats:
    """Return points spread over a table's top, shape (1, 9, 3)."""
    depth, width, height = item.type.size_m
    return np.array(
        [[compose4(item.world_T_object, (a * depth, b * width, height, 0.0))[:3] for a in _OVER for b in _OVER]]
    )
