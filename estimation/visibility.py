"""Whether a look would have reported an object, and whether it shows that something stands where the object should.

The first makes silence evidence against an object, the second says how much: where the picture shows something solid
of which the detector said nothing, it is likelier to have overlooked a thing than where the picture shows the wall.
And where it shows the wall behind the place of a report, the report is likelier of nothing.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.se2 import turned
from skolem.traces.messages import DepthView, ObjectType, Pose2, Pose4

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
HEIGHTS = (0.2, 0.5, 0.8)  # of sampled points, shares of the object's height
SIDES = (-0.6, 0.0, 0.6)  # of the object's radius, across the line of sight
ENDS = ((0.0, 1.0), (-1.0, 1.0))  # the same for the corners, which must be in the image
NODES = (-(3.0**0.5), 0.0, 3.0**0.5)  # Gauss-Hermite, exact for polynomials up to degree 5
WEIGHTS = (1, 4, 1)  # in sixths
MIN_KNOWN = 0.5  # share of the points whose depth must have come back


@dataclass(frozen=True, slots=True)
class DepthImage:
    """A coarse depth image as arrays: what the space between the camera and the things it saw is known to be.

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


def prob_visible(
    image: DepthImage, base_T_object: Pose2, covariance: Array, z: float, kind: ObjectType, config: EstimatorConfig
) -> float:
    """Return P(an object is in the image, near enough and not hidden).

    Averaged over 3 x 3 places along the axes of the position's covariance.

    Args:
        image: The picture.
        base_T_object: Mean.
        covariance: Over (x, y, theta), object frame, shape (3, 3).
        z: Height of its base, metres.
        kind: Shape and size.
        config: Reads `seen_share`, `depth_margin_m` and `sight_m`.
    """
    return _share(weight for _, weight in _in_sight(image, base_T_object, covariance, z, kind, config))


def prob_visible_and_solid(
    image: DepthImage,
    base_T_object: Pose2,
    covariance: Array,
    z: float,
    kind: ObjectType,
    config: EstimatorConfig,
    explained: Callable[[Array], Mask],
) -> tuple[float, float]:
    """Return P(an object would be in sight), and P(it would be, and the image shows something there of its own).

    Args:
        image: This and all but the last argument are those of `prob_visible`, averaged over as there.
        base_T_object: Mean.
        covariance: Over (x, y, theta), object frame, shape (3, 3).
        z: Height of its base, metres.
        kind: Shape and size.
        config: As there.
        explained: Tells which readings, given by where they ended, shape (n, 3), base frame, have hit something else.
    """
    places = list(_in_sight(image, base_T_object, covariance, z, kind, config))
    solid = (weight for place, weight in places if is_solid(image, place, kind, config, explained))
    return _share(weight for _, weight in places), _share(solid)


def shows_behind(image: DepthImage, base_T_object: Pose4, kind: ObjectType, config: EstimatorConfig) -> bool:
    """Return whether the readings towards an upright object, its foot aside, go on behind its axis: it is not there.

    Args:
        image: The picture.
        base_T_object: Where the object would stand; its base.
        kind: Shape and size.
        config: Reads `seen_share` and `depth_margin_m`.
    """
    place, margin = np.array(base_T_object[:3]), config.depth_margin_m
    points = _outline(place, image.origin[:2], outline_radius(kind), kind.size_m[2])
    forward, depth = image.read(points[points[:, 2] >= place[2] + margin])
    behind = depth > forward + margin
    return bool(behind.sum() >= max(1.0, config.seen_share * len(behind)))


def outline_radius(kind: ObjectType) -> float:
    """Return the radius of the smallest upright cylinder around an object on its axis, metres."""
    x, y, _ = kind.size_m
    return x / 2.0 if kind.shape == "cylinder" else 0.5 * float(np.hypot(x, y))


def _in_sight(
    image: DepthImage, base_T_object: Pose2, covariance: Array, z: float, kind: ObjectType, config: EstimatorConfig
) -> Iterator[tuple[Array, int]]:
    """Yield the places, with their weights, at which an object would have been reported."""
    for place, weight in _places(base_T_object, covariance, z):
        if is_visible(image, place, kind, config):
            yield place, weight


def _share(weights: Iterable[int]) -> float:
    return sum(weights) / 36.0


def _places(base_T_object: Pose2, covariance: Array, z: float) -> Iterator[tuple[Array, int]]:
    """Yield where an object's base may be, shape (3,), base frame, and how likely, in 36ths."""
    spread, axes = np.linalg.eigh(turned(covariance, base_T_object[2])[:2, :2])
    steps = axes * np.sqrt(np.maximum(spread, 0.0))
    for i, wi in zip(NODES, WEIGHTS, strict=True):
        for j, wj in zip(NODES, WEIGHTS, strict=True):
            yield np.array([*(np.array(base_T_object[:2]) + steps @ (i, j)), z]), wi * wj


def is_visible(image: DepthImage, place: Array, kind: ObjectType, config: EstimatorConfig) -> bool:
    """Return whether an object at a place (its base, shape (3,), base frame) would have been reported."""
    radius = outline_radius(kind)
    corners = _outline(place, image.origin[:2], radius, kind.size_m[2], *ENDS)
    points = _outline(place, image.origin[:2], radius, kind.size_m[2])
    forward, depth = image.read(points)
    if np.isnan(image.read(corners)[1]).any() or np.linalg.norm(points - image.origin, axis=1).min() > config.sight_m:
        return False
    known = depth > 0.0
    through = known & (depth >= forward - radius - config.depth_margin_m)
    return bool(known.mean() >= MIN_KNOWN and through.sum() >= config.seen_share * known.sum())


def is_solid(
    image: DepthImage, place: Array, kind: ObjectType, config: EstimatorConfig, explained: Callable[[Array], Mask]
) -> bool:
    """Return whether the readings towards an object at a place, its foot aside, ended on it and on nothing else."""
    radius, margin = outline_radius(kind), config.depth_margin_m
    points = _outline(place, image.origin[:2], radius, kind.size_m[2])
    forward, depth = image.read(points[points[:, 2] >= place[2] + margin])
    known = depth > 0.0
    towards = points[points[:, 2] >= place[2] + margin][known] - image.origin
    ends = image.origin + towards * (depth[known] / forward[known])[:, None]
    beside = np.linalg.norm(ends[:, :2] - place[:2], axis=1)
    on = (beside <= radius + margin) & (ends[:, 2] >= place[2] + margin)
    least = max(1.0, config.seen_share * len(on))
    return bool(on.sum() >= least and (on & ~explained(ends)).sum() >= least)


def _outline(
    place: Array,
    camera_xy: Array,
    radius: float,
    height: float,
    heights: Sequence[float] = HEIGHTS,
    sides: Sequence[float] = SIDES,
) -> Array:
    """Return points of an upright cylinder in the plane through its axis and across the line of sight, shape (n, 3)."""
    sight = place[:2] - camera_xy
    across = np.array([-sight[1], sight[0], 0.0]) / max(float(np.hypot(*sight)), 1e-9)
    up = np.array([0.0, 0.0, height])
    return np.array([place + s * radius * across + h * up for h in heights for s in sides])
