"""Questions on a depth image: whether an object would be in sight, and whether its place is solid or empty.

If an object would be in sight, a missed detection is evidence against the object. The evidence is weaker if the image
shows something solid in the object's place, since the detector more likely overlooks an object there than before a
bare wall. And if the image shows the wall behind the place of a detection, the detection is likelier false.
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
HEIGHTS = (0.2, 0.5, 0.8)  # heights of the sampled points, as shares of the object's height
SIDES = (-0.6, 0.0, 0.6)  # their distances from the axis across the line of sight, as shares of the object's radius
ENDS = ((0.0, 1.0), (-1.0, 1.0))  # heights and sides of the corners, which must be in the image
NODES = (-(3.0**0.5), 0.0, 3.0**0.5)  # Gauss-Hermite, exact for polynomials up to degree 5
WEIGHTS = (1, 4, 1)  # in sixths
MIN_KNOWN = 0.5  # least share of the points with a depth reading


@dataclass(frozen=True, slots=True)
class DepthImage:
    """A coarse depth image as arrays; the space between the camera and the readings is empty.

    Attributes:
        origin: Position of the camera, shape (3,), metres, base frame.
        axes: Rotation base_R_camera, shape (3, 3); the camera looks along x, y is left, z is up.
        focal_px: Focal length, pixels.
        depth: Distance along the camera's axis, shape (rows, columns), metres; 0 in a pixel without a reading.
        hits: Ends of the readings, shape (m, 3), metres, base frame.
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
        """Return the distances of points along the camera's axis, and the depth readings in their directions.

        Args:
            points_base: Points, shape (n, 3), metres, base frame.

        Returns:
            Two arrays of shape (n,), metres. The reading is that of the nearest pixel. It is 0 if the pixel has none,
            and NaN for points outside of the image or behind the camera.
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
    """Return the rotation matrix, shape (3, 3), of a unit quaternion xyzw."""
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

    It is the mean over 3 x 3 places along the axes of the position's covariance.

    Args:
        image: The depth image.
        base_T_object: Mean pose of the object.
        covariance: Its covariance over (x, y, theta), object frame, shape (3, 3).
        z: Height of its base, metres.
        kind: Its shape and size.
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
    """Return P(an object is in sight), and P(it is in sight and the image shows something unexplained in its place).

    Both are means over the places of `prob_visible`.

    Args:
        image: The depth image.
        base_T_object: Mean pose of the object.
        covariance: Its covariance over (x, y, theta), object frame, shape (3, 3).
        z: Height of its base, metres.
        kind: Its shape and size.
        config: Reads `seen_share`, `depth_margin_m` and `sight_m`.
        explained: Function from the ends of readings, shape (n, 3), base frame, to the mask, shape (n,), of readings
            that have hit something else.
    """
    places = list(_in_sight(image, base_T_object, covariance, z, kind, config))
    solid = (weight for place, weight in places if is_solid(image, place, kind, config, explained))
    return _share(weight for _, weight in places), _share(solid)


def shows_behind(image: DepthImage, base_T_object: Pose4, kind: ObjectType, config: EstimatorConfig) -> bool:
    """Return whether the readings towards an upright object end behind its axis, so that it is not there.

    Readings towards its foot do not count.

    Args:
        image: The depth image.
        base_T_object: Pose of the object's base.
        kind: Its shape and size.
        config: Reads `seen_share` and `depth_margin_m`.
    """
    place, margin = np.array(base_T_object[:3]), config.depth_margin_m
    points = _outline(place, image.origin[:2], outline_radius(kind), kind.size_m[2])
    forward, depth = image.read(points[points[:, 2] >= place[2] + margin])
    behind = depth > forward + margin
    return bool(behind.sum() >= max(1.0, config.seen_share * len(behind)))


def outline_radius(kind: ObjectType) -> float:
    """Return the radius, in metres, of the smallest upright cylinder around an object, with the same axis."""
    x, y, _ = kind.size_m
    return x / 2.0 if kind.shape == "cylinder" else 0.5 * float(np.hypot(x, y))


def _in_sight(
    image: DepthImage, base_T_object: Pose2, covariance: Array, z: float, kind: ObjectType, config: EstimatorConfig
) -> Iterator[tuple[Array, int]]:
    """Yield the places, with their weights, at which an object would be in sight."""
    for place, weight in _places(base_T_object, covariance, z):
        if is_visible(image, place, kind, config):
            yield place, weight


def _share(weights: Iterable[int]) -> float:
    return sum(weights) / 36.0


def _places(base_T_object: Pose2, covariance: Array, z: float) -> Iterator[tuple[Array, int]]:
    """Yield possible places of an object's base, shape (3,), base frame, and the weight of each, in 36ths."""
    spread, axes = np.linalg.eigh(turned(covariance, base_T_object[2])[:2, :2])
    steps = axes * np.sqrt(np.maximum(spread, 0.0))
    for i, wi in zip(NODES, WEIGHTS, strict=True):
        for j, wj in zip(NODES, WEIGHTS, strict=True):
            yield np.array([*(np.array(base_T_object[:2]) + steps @ (i, j)), z]), wi * wj


def is_visible(image: DepthImage, place: Array, kind: ObjectType, config: EstimatorConfig) -> bool:
    """Return whether an object would be in sight if its base were at `place`, shape (3,), metres, base frame."""
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
    """Return whether enough readings towards an object at `place` ended on it and have no other explanation.

    Readings towards its foot do not count. The arguments are those of `is_visible` and `prob_visible_and_solid`.
    """
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
    """Return points, (n, 3), of an upright cylinder in the plane through its axis and across the line of sight."""
    sight = place[:2] - camera_xy
    across = np.array([-sight[1], sight[0], 0.0]) / max(float(np.hypot(*sight)), 1e-9)
    up = np.array([0.0, 0.0, height])
    return np.array([place + s * radius * across + h * up for h in heights for s in sides])
