"""The detector: it finds supports, tables and clusters in a coloured point cloud, and fits every graspable type.

Its only inputs are the cloud and the types. It does not report an object that the border of the image cuts, whose top
is hidden behind something nearer, that stands on no support in view, or that no type explains. Objects that touch each
other are separated where the outlines of types make up their tops, or where their cluster has a waist.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.detector.cloud import Cloud
from skolem.sim.detector.fitting import Fit, fit_type
from skolem.sim.detector.likelihood import type_log_likelihood
from skolem.sim.detector.packing import packed
from skolem.sim.detector.supports import Support, area_per_point, find_supports
from skolem.sim.detector.tables import TableFit, find_tables
from skolem.sim.space.pinhole import ROWS, focal_px
from skolem.sim.truth.noise import extrinsic_covariance
from skolem.traces.messages import Detection, NoiseModel, ObjectType, Upper3x3
from skolem.traces.messages.likeliest import likeliest

MAX_DISTANCE_M = 2.4  # from the camera; beyond it depth errors hide the step between an object and its support
CLEARANCE_M = 0.015  # points this near a support count as the support
HEADROOM_M = 0.05  # a cluster this much taller than the tallest type is of no type
EDGE_M = 0.03  # objects may stick out over the visible part of their support
VOXEL_M = 0.012  # objects closer than one to two voxels are one cluster
MIN_POINTS = 30
TOP_BAND_M, MAX_HIDDEN = 0.02, 0.3  # with a greater hidden share the true top may be higher
MAX_SPLITS = 2  # a cluster that no type explains is cut at its waist, and its halves again: up to four objects
WAIST_BINS = 9  # over the middle half of a cluster
MAX_OUTSIDE = 0.1  # share of a cluster's points outside the best type's outline
MAX_HEIGHT_ERROR_M, MAX_OUTLINE_ERROR_M = 0.025, 0.0125  # of the best type; beyond them no type explains a cluster


@dataclass(frozen=True, slots=True)
class Seen:
    """The objects and supports found in a cloud.

    Attributes:
        detections: Detections of graspable objects, in canonical order.
        supports: Highest first.
        camera_base: Shape (3,), metres, base frame.
        tables: Detections of tables, in canonical order.
    """

    detections: tuple[Detection, ...]
    supports: tuple[Support, ...]
    camera_base: NDArray[np.float64]
    tables: tuple[Detection, ...] = ()


def detect(cloud: Cloud, types: dict[str, ObjectType], noise: NoiseModel) -> Seen:
    """Return the graspable objects and the tables in a cloud.

    Args:
        cloud: Points in the base frame, z nearly up, without the robot's own body.
        types: Every type; graspable ones and tables are looked for.
        noise: Gives the camera's calibration error.
    """
    whole, is_near = cloud, np.linalg.norm(cloud.points_base - cloud.camera_base, axis=1) < MAX_DISTANCE_M
    cloud = whole.only(is_near)
    known = {name: kind for name, kind in types.items() if kind.shape == "table"}
    least_m2 = min((kind.size_m[0] * kind.size_m[1] for kind in known.values()), default=0.0)
    supports = find_supports(
        whole.points_base, whole.camera_base, focal_px(ROWS), noise.depth_sd_scale, least_m2, MAX_DISTANCE_M
    )
    tables = find_tables(whole, supports, known)
    sought = {name: kind for name, kind in sorted(types.items()) if kind.graspable}
    detections = [
        detection
        for support, cluster in _clusters(cloud, supports, sought)
        for detection in _explained(cluster, support, sought, noise)
    ]
    reported = [table_detection(fit, types[fit.kind], cloud.camera_base, noise) for fit in tables]
    return Seen(canonical_order(detections), supports, cloud.camera_base, canonical_order(reported))


def table_detection(fit: TableFit, kind: ObjectType, camera_base: NDArray[np.float64], noise: NoiseModel) -> Detection:
    """Return the detection of a table; its likelihoods are those of the table types that were tried."""
    x, y, theta = (float(value) for value in fit.xy_theta)
    red, green, blue = (float(value) for value in fit.seen.rgb.mean(axis=0))
    return Detection(
        base_T_object=(x, y, fit.top_m - kind.size_m[2], theta),
        covariance=pose_covariance(fit.covariance, (x, y, fit.top_m, theta), camera_base, noise),
        type_log_likelihood=fit.log_likelihood,
        rgb=(red, green, blue),
        points=len(fit.seen.points_base),
    )


def canonical_order(detections: list[Detection]) -> tuple[Detection, ...]:
    """Return detections sorted by best type, pose and colour, rounded to 1e-9."""

    def key(detection: Detection) -> tuple[object, ...]:
        best = likeliest(detection.type_log_likelihood)
        return (best, *(round(value, 9) for value in (*detection.base_T_object, *detection.rgb)))

    return tuple(sorted(detections, key=key))


def pose_covariance(
    fit_covariance: NDArray[np.float64],
    base_T_object: tuple[float, float, float, float],
    camera_base: NDArray[np.float64],
    noise: NoiseModel,
) -> Upper3x3:
    """Return the upper triangle of the covariance of a seen pose over (x, y, theta), object frame.

    It is the sum of the fit's covariance and that of the calibration error at this place, turned from the base frame's
    axes to the object's. A cylinder's heading has the variance of a uniform one. A box's heading is reported modulo
    half a turn (a square box's: a quarter), and has the variance of the reported value.
    """
    x, y, z, theta = base_T_object
    total = fit_covariance + extrinsic_covariance(noise, np.array([x, y, z]) - camera_base)
    c, s = np.cos(theta), np.sin(theta)
    object_R_base = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    turned = object_R_base @ total @ object_R_base.T
    a, b, d, e, f, g = (float(value) for value in turned[np.triu_indices(3)])
    return (a, b, d, e, f, g)


def _clusters(
    cloud: Cloud, supports: tuple[Support, ...], sought: dict[str, ObjectType]
) -> list[tuple[Support, Cloud]]:
    """Return the connected clusters of points over each support; a point belongs to the highest support below it."""
    tallest = max((kind.size_m[2] for kind in sought.values()), default=0.0)
    free = np.ones(len(cloud.points_base), dtype=bool)
    heights = [support.height(cloud.points_base) for support in supports]
    covered = [support.covers(cloud.points_base, EDGE_M) for support in supports]
    for height, inside in zip(heights, covered, strict=True):
        free &= ~(inside & (np.abs(height) < CLEARANCE_M))
    found = []
    for support, height, inside in zip(supports, heights, covered, strict=True):
        over = free & inside & (height > CLEARANCE_M)
        free &= ~over
        band = cloud.only(over & (height < tallest + 2.0 * HEADROOM_M))
        found += [(support, cluster) for cluster in _connected(band) if _is_whole(cluster, support, tallest)]
    return found


def _is_whole(cluster: Cloud, support: Support, tallest_m: float) -> bool:
    """Return whether a cluster is large enough, wholly in the image, not too tall, and shows its top."""
    if len(cluster.points_base) < MIN_POINTS or cluster.at_border.any():
        return False
    height = support.height(cluster.points_base)
    hidden = cluster.under_nearer[height > height.max() - TOP_BAND_M].mean()
    return bool(height.max() < tallest_m + HEADROOM_M and hidden < MAX_HIDDEN)


def _connected(cloud: Cloud) -> list[Cloud]:
    """Return the clusters of a cloud whose voxels touch, by face, edge or corner."""
    if not len(cloud.points_base):
        return []
    voxel = np.floor((cloud.points_base - cloud.points_base.min(axis=0)) / VOXEL_M).astype(np.int64)
    grid = np.zeros(voxel.max(axis=0) + 1, dtype=bool)
    grid[tuple(voxel.T)] = True
    label, count = scipy.ndimage.label(grid, structure=np.ones((3, 3, 3)))
    of_point = label[tuple(voxel.T)]
    return [cloud.only(of_point == index + 1) for index in range(count)]


def _explained(
    cluster: Cloud, support: Support, sought: dict[str, ObjectType], noise: NoiseModel, splits: int = MAX_SPLITS
) -> list[Detection]:
    """Return the detections in a cluster: one if a type explains it, else those in its halves."""
    whole = _detection(cluster, support, sought, noise)
    if whole is not None or splits == 0:
        return [] if whole is None else [whole]
    if splits == MAX_SPLITS and (apart := _packed(cluster, support, sought, noise)):
        return apart
    half = _beyond_waist(cluster.points_base)
    parts = (cluster.only(half), cluster.only(~half))
    if min(len(part.points_base) for part in parts) < MIN_POINTS:
        return []
    halves = [_explained(part, support, sought, noise, splits - 1) for part in parts]
    return halves[0] + halves[1] if all(halves) else []


def _packed(cluster: Cloud, support: Support, sought: dict[str, ObjectType], noise: NoiseModel) -> list[Detection]:
    """Return the detections in a cluster whose tops the outlines of types make up; none if a part is not explained."""
    feet, heights = support.foot(cluster.points_base)[:, :2], support.height(cluster.points_base)
    area = area_per_point(cluster.points_base, cluster.camera_base, focal_px(ROWS))
    parts = packed(feet, heights, area, sought)
    found = [_detection(cluster.only(part.mask), support, sought, noise, part.xy_theta) for part in parts]
    explained = [detection for detection in found if detection is not None]
    return explained if len(explained) == len(parts) else []


def _beyond_waist(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the mask, shape (n,), of points (n, 3) beyond the waist: the thinnest part along the longest direction."""
    feet = points[:, :2] - points[:, :2].mean(axis=0)
    along = feet @ np.linalg.eigh(feet.T @ feet)[1][:, -1]
    low, high = along.min(), along.max()
    edges = np.linspace(low + (high - low) / 4.0, high - (high - low) / 4.0, WAIST_BINS + 1)
    counts = np.histogram(along, edges)[0]
    thinnest = np.flatnonzero(counts == counts.min())
    waist = float(edges[int(thinnest[len(thinnest) // 2])] + (edges[1] - edges[0]) / 2.0)
    return np.asarray(along > waist)


def _detection(
    cluster: Cloud,
    support: Support,
    sought: dict[str, ObjectType],
    noise: NoiseModel,
    start: NDArray[np.float64] | None = None,
) -> Detection | None:
    """Return the detection of a cluster, or None if no type explains it; its fits may be given a start pose."""
    feet, heights = support.foot(cluster.points_base)[:, :2], support.height(cluster.points_base)
    fits = {name: fit_type(feet, heights, cluster.camera_base[:2], kind, start) for name, kind in sought.items()}
    distance_m = float(np.linalg.norm(cluster.points_base.mean(axis=0) - cluster.camera_base))
    likelihood = {
        name: type_log_likelihood(fit.height_error_m, fit.outline_error_m, distance_m) for name, fit in fits.items()
    }
    best = fits[likeliest(likelihood)]
    if not _explains(best):
        return None
    x, y, theta = (float(value) for value in best.xy_theta)
    base_T_object = (x, y, support.z_at(x, y), theta)
    red, green, blue = (float(value) for value in cluster.rgb.mean(axis=0))
    return Detection(
        base_T_object=base_T_object,
        covariance=pose_covariance(best.covariance, base_T_object, cluster.camera_base, noise),
        type_log_likelihood=likelihood,
        rgb=(red, green, blue),
        points=len(cluster.points_base),
    )


def _explains(fit: Fit) -> bool:
    """Return whether a type explains a cluster by its height, its outline and the share of points outside."""
    off = np.hypot(fit.height_error_m / MAX_HEIGHT_ERROR_M, fit.outline_error_m / MAX_OUTLINE_ERROR_M)
    return bool(off <= 1.0 and fit.outside <= MAX_OUTSIDE)
