"""The symbolic robot's camera: rays against boxes and upright cylinders, no pixels.

The camera sits where the PR2's Kinect does. An object is seen if it is near enough, wholly inside the image, and mostly
unhidden; a table is seen if enough of the edges of its top are.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.robot.rotations import rotation
from skolem.sim.space.pinhole import FOVY_RAD, Frame, pixel_rays
from skolem.traces.messages import DepthView, ObjectType, Pose4
from skolem.traces.messages.poses import compose4, inverse4

Floats = NDArray[np.float64]

COLUMNS, ROWS = 80, 60
ASPECT = COLUMNS / ROWS
PAN_AXIS_M = (-0.06707, 0.0, 1.172125)  # in base_footprint with the torso at 0
TILT_AXIS_M = (0.068, 0.0, 0.0)  # in the panned frame
LENS_M = (-0.147067, 0.0125, 0.291953)  # in the tilted frame
PAN_LIMIT_RAD = 3.007
TILT_LIMITS_RAD = (-0.471, 1.396)
FAR_M = 4.5  # no readings beyond
SIGHT_M = 2.4  # beyond it the detector cannot separate objects from their support
SEEN_SHARE = 0.75  # least share of an object's outline in sight
OUTLINE_POINTS = 9
EDGE_SHARE = 0.3  # least share of the edges of a table's top: two corners and the edge between them
EDGE_POINTS = 9  # points tried along each edge
HEAD_TURNS = 20  # fixed-point steps of `head_towards`, enough for 1e-6 rad
TOP_THICKNESS_M = 0.04  # of a table; one can see below it


@dataclass(frozen=True, slots=True)
class Solid:
    """A body in the base frame.

    Attributes:
        id: Its name.
        type: Its shape and size; a table is the slab of its top.
        base_T_solid: Pose of the centre of its base face.
    """

    id: str
    type: ObjectType
    base_T_solid: Pose4


def camera(torso: float, pan: float, tilt: float) -> Frame:
    """Return base_T_camera: x forward, y left, z up; a positive tilt looks down."""
    c, s = math.cos(tilt), math.sin(tilt)
    panned = rotation(pan)
    tilted = panned @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    origin = np.array(PAN_AXIS_M) + (0.0, 0.0, torso) + panned @ TILT_AXIS_M + tilted @ LENS_M
    return Frame(origin, tilted)


def head_towards(torso: float, point_base: Floats) -> tuple[float, float] | None:
    """Return pan and tilt that turn the camera's axis through a point, or None beyond the neck's limits.

    Args:
        torso: Lift [m].
        point_base: Shape (3,), metres, base frame.
    """
    pan = tilt = 0.0
    for _ in range(HEAD_TURNS):
        x, y, z = point_base - camera(torso, pan, tilt).origin
        pan, tilt = math.atan2(y, x), math.atan2(-z, math.hypot(x, y))
    if abs(pan) > PAN_LIMIT_RAD or not TILT_LIMITS_RAD[0] <= tilt <= TILT_LIMITS_RAD[1]:
        return None
    return pan, tilt


def cast(frame: Frame, directions: Floats, solids: Sequence[Solid]) -> Floats:
    """Return the distance along each direction to the floor or a solid.

    Args:
        frame: Where the rays start, base frame.
        directions: Shape (n, 3), base frame; their length is the unit of the answer.
        solids: The solids.

    Returns:
        Shape (n,), in lengths of the directions; infinite where nothing is hit.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        floor = -frame.origin[2] / directions[:, 2]
        nearest = np.where(floor > 0.0, floor, np.inf)
        for solid in solids:
            nearest = np.minimum(nearest, _hit(frame.origin, directions, solid))
    return nearest


def depth_view(frame: Frame, solids: Sequence[Solid], believed: Frame) -> DepthView:
    """Return the exact depth view of a camera at `frame`, labelled with the frame `believed`."""
    rays = pixel_rays(COLUMNS, ROWS).reshape(-1, 3) @ frame.axes.T
    depth = cast(frame, rays, solids)
    depth[depth > FAR_M] = 0.0
    x, y, z, qx, qy, qz, qw = (
        float(v) for v in (*believed.origin, *scipy.spatial.transform.Rotation.from_matrix(believed.axes).as_quat())
    )
    return DepthView(
        base_T_camera=(x, y, z, qx, qy, qz, qw),
        fovy_rad=FOVY_RAD,
        columns=COLUMNS,
        rows=ROWS,
        depth_mm=tuple(np.round(1000.0 * depth).astype(int).tolist()),
    )


def in_sight(frame: Frame, solid: Solid, others: Sequence[Solid]) -> bool:
    """Return whether the detector could report the solid: near, wholly in the image, mostly unhidden by `others`."""
    toward = outline(frame.origin, solid) - frame.origin
    return fits(frame, solid) and bool((cast(frame, toward, others) > 1.0).mean() >= SEEN_SHARE)


def fits(frame: Frame, solid: Solid) -> bool:
    """Return whether a solid is near enough and wholly in the image, hidden or not."""
    toward = outline(frame.origin, solid) - frame.origin
    forward, left, up = (toward @ frame.axes).T
    if forward.min() <= 0.0 or np.linalg.norm(toward, axis=1).max() > SIGHT_M:
        return False
    half = math.tan(FOVY_RAD / 2.0)
    return not ((np.abs(up / forward) > half).any() or (np.abs(left / forward) > half * ASPECT).any())


def table_in_sight(frame: Frame, table: Solid, others: Sequence[Solid]) -> bool:
    """Return whether the detector could report a table: enough of its edges near, in the image, not behind `others`."""
    half = np.array(table.type.size_m[:2]) / 2.0
    along = np.linspace(-1.0, 1.0, EDGE_POINTS)
    edges = [half * (u, v) for t in along for u, v in ((t, -1.0), (t, 1.0), (-1.0, t), (1.0, t))]
    points = np.array([compose4(table.base_T_solid, (u, v, table.type.size_m[2], 0.0))[:3] for u, v in edges])
    return bool(points_in_sight(frame, points, others).mean() >= EDGE_SHARE)


def points_in_sight(frame: Frame, points_base: Floats, others: Sequence[Solid]) -> NDArray[np.bool_]:
    """Return which points, shape (n, 3), base frame, are near, in the image and not behind `others`."""
    toward = points_base - frame.origin
    forward, left, up = (toward @ frame.axes).T
    limit = math.tan(FOVY_RAD / 2.0) * forward
    seen = (np.abs(up) < limit) & (np.abs(left) < limit * ASPECT) & (np.linalg.norm(toward, axis=1) < SIGHT_M)
    return np.asarray(seen & (cast(frame, toward, others) > 1.0 - 1e-6))


def outline(eye: Floats, solid: Solid) -> Floats:
    """Return points on the left edge, the axis and the right edge of a solid as seen from `eye`, shape (9, 3)."""
    x, y, z, _ = solid.base_T_solid
    width, depth, height = solid.type.size_m
    along = np.array([x - eye[0], y - eye[1]])
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9) * min(width, depth) / 2.0
    levels = z + height * np.array([0.05, 0.5, 0.95])
    return np.array([(x + side * across[0], y + side * across[1], level) for side in (-1, 0, 1) for level in levels])


def _hit(eye: Floats, directions: Floats, solid: Solid) -> Floats:
    """Return the distance to a solid along rays, in lengths of their direction, shape (n,); infinite for a miss."""
    solid_T_base = inverse4(solid.base_T_solid)
    start = np.array(compose4(solid_T_base, (*eye.tolist(), 0.0))[:3])
    rays = directions @ rotation(solid_T_base[3]).T
    width, depth, height = solid.type.size_m
    bottom = height - TOP_THICKNESS_M if solid.type.shape == "table" else 0.0
    enter, leave = _slab(start[2], rays[:, 2], bottom, height)
    if solid.type.shape == "cylinder":
        sides = [_circle(start, rays, max(width, depth) / 2.0)]
    else:
        sides = [_slab(start[k], rays[:, k], -size / 2.0, size / 2.0) for k, size in enumerate((width, depth))]
    for first, last in sides:
        enter, leave = np.maximum(enter, first), np.minimum(leave, last)
    return np.where((enter <= leave) & (enter > 0.0), enter, np.inf)


def _slab(start: float, rays: Floats, low: float, high: float) -> tuple[Floats, Floats]:
    """Return the distances at which rays enter and leave low <= coordinate <= high, each of shape (n,)."""
    a, b = (low - start) / rays, (high - start) / rays
    return np.minimum(a, b), np.maximum(a, b)


def _circle(start: Floats, rays: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return the distances at which rays enter and leave an infinite upright cylinder about the origin, shape (n,)."""
    a = rays[:, 0] ** 2 + rays[:, 1] ** 2
    b = rays[:, 0] * start[0] + rays[:, 1] * start[1]
    root = np.sqrt(b * b - a * (start[0] ** 2 + start[1] ** 2 - radius**2))
    missed = np.isnan(root)
    return np.where(missed, np.inf, (-b - root) / a), np.where(missed, -np.inf, (-b + root) / a)
