"""Weighted places of an object with an uncertain place: supports, and points on their tops.

A Gaussian cannot express "not here, so beside it". So while a place is uncertain by some decimetres, the belief also
keeps a weight on each of many places. A missed detection lowers the weights of the places in sight, and the other
places gain. The Gaussian in the pose graph has its mean where most of the weight is, and the spread of the weights.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Place, Sought
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.se2 import compose, turned, upper
from skolem.estimation.tracks import Tracks
from skolem.estimation.visibility import DepthImage, is_solid, is_visible
from skolem.traces.messages import Pose2

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def is_sought(graph: PoseGraph, tracks: Tracks, anchor: str, config: EstimatorConfig) -> bool:
    """Return whether the place of a graspable object is so uncertain that the object has weighted places."""
    track = tracks[anchor]
    if track.hand or not tracks.kind(anchor).graspable:
        return False
    if track.places:
        return True
    theta, covariance = graph.mean(BASE, anchor)[2], graph.relative(BASE, anchor)[1]
    return float(np.linalg.eigvalsh(turned(covariance, theta)[:2, :2])[-1]) > config.sought_sd_m**2


def is_beside(graph: PoseGraph, tracks: Tracks, anchor: str) -> bool:
    """Return whether the mean of an object's place lies beside the top of its believed table."""
    support = tracks[anchor].support
    if support is None or tracks.kind(support).shape != "table":
        return False
    x, y, _ = graph.mean(support, anchor)
    size = tracks.kind(support).size_m
    return abs(x) > size[0] / 2.0 or abs(y) > size[1] / 2.0


def believed_places(graph: PoseGraph, tracks: Tracks, anchor: str, config: EstimatorConfig) -> tuple[Place, ...]:
    """Return the weighted places of an object by the present belief; weights sum to 1; nothing if no top is near.

    An object with a support is somewhere on the support's top. If the support is unknown, each table may be it.
    """
    track = tracks[anchor]
    if track.places:
        return track.places
    (x, y, theta), covariance = graph.relative(BASE, anchor)
    inverse = np.linalg.inv(turned(covariance, theta)[:2, :2])
    found: list[tuple[str, float, float, float]] = []
    for support in (track.support,) if track.support else _tables(tracks):
        if tracks.kind(support).shape == "table":
            for u, v in _top(tracks.kind(support).size_m, config.place_step_m):
                a, b, _ = compose(graph.mean(BASE, support), (u, v, 0.0))
                off = np.array([a - x, b - y])
                found.append((support, u, v, float(off @ inverse @ off)))
    if not found:
        return ()
    nearest = min(distance2 for *_, distance2 in found)
    if nearest > config.gate:
        return ()
    return normalised([(s, u, v, math.exp(0.5 * (nearest - distance2))) for s, u, v, distance2 in found])


def _tables(tracks: Tracks) -> Iterator[str]:
    return (anchor for anchor in tracks.likely() if tracks.kind(anchor).shape == "table")


def _top(size_m: tuple[float, float, float], step_m: float) -> Iterator[tuple[float, float]]:
    """Yield evenly spread places on a top, metres, in the frame of the top."""
    across, along = (max(1, round(size / step_m)) for size in size_m[:2])
    for i in range(across):
        for j in range(along):
            yield (((i + 0.5) / across - 0.5) * size_m[0], ((j + 0.5) / along - 0.5) * size_m[1])


def normalised(places: list[Place], least: float = 1e-5) -> tuple[Place, ...]:
    """Return places with weights that sum to 1; places with less than the share `least` of the weight are left out."""
    total = sum(weight for *_, weight in places)
    kept = [(s, u, v, w / total) for s, u, v, w in places if w >= least * total] if total > 0.0 else []
    rest = sum(weight for *_, weight in kept)
    return tuple((s, u, v, w / rest) for s, u, v, w in kept)


@dataclass(frozen=True, slots=True)
class MissedAtPlaces:
    """The effect of a missed detection on an object with weighted places.

    Attributes:
        p_reported: P(the look detects the object | it exists).
        solid: P(the object is in sight, and the picture shows something unexplained in its place).
        places: The weighted places after the look.
    """

    p_reported: float
    solid: float
    places: tuple[Place, ...]


def missed_at_places(
    places: tuple[Place, ...],
    image: DepthImage,
    graph: PoseGraph,
    tracks: Tracks,
    anchor: str,
    config: EstimatorConfig,
    explained: Callable[[Array], Mask],
) -> MissedAtPlaces:
    """Return the effect of a missed detection on an object with weighted places.

    Args:
        places: The weighted places before the look.
        image: The depth image of the look.
        graph: Poses of the supports.
        tracks: Heights of the supports, the object's type, and the detector's P(detected).
        anchor: The object.
        config: Reads `unshown` and the fields that `is_visible` reads.
        explained: Function from the ends of readings, shape (n, 3), base frame, to the mask, shape (n,), of readings
            that have hit something else.
    """
    kind, found = tracks.kind(anchor), tracks.prior.noise.found
    left: list[Place] = []
    reported = solid = 0.0
    for support, u, v, weight in places:
        at = _at(graph, tracks, support, u, v)
        silent = 1.0
        if is_visible(image, at, kind, config):
            shows = is_solid(image, at, kind, config, explained)
            reported += weight * found
            solid += weight * shows
            silent = (1.0 - found) * (1.0 if shows else config.unshown)
        left.append((support, u, v, weight * silent))
    return MissedAtPlaces(min(1.0, reported), min(1.0, solid), normalised(left) or places)


def _at(graph: PoseGraph, tracks: Tracks, support: str, u: float, v: float) -> Array:
    """Return the position of a place on a top, shape (3,), metres, base frame."""
    x, y, _ = compose(graph.mean(BASE, support), (u, v, 0.0))
    return np.array([x, y, tracks.top(support)])


def sought(places: tuple[Place, ...], graph: PoseGraph, tracks: Tracks, anchor: str, config: EstimatorConfig) -> Sought:
    """Return the event that moves an object to the place with the most weight within the width of a look."""
    points = np.array([_at(graph, tracks, support, u, v)[:2] for support, u, v, _ in places])
    weights = np.array([weight for *_, weight in places])
    squared = ((points[:, None] - points[None]) ** 2).sum(axis=2)
    near = np.exp(-0.5 * squared / config.look_width_m**2) @ weights
    best = int(np.argmax(np.round(near, 9)))
    off = points - points[best]
    spread = np.zeros((3, 3))
    spread[:2, :2] = (weights[:, None] * off).T @ off + np.eye(2) * config.place_step_m**2 / 12.0
    theta, covariance = graph.mean(BASE, anchor)[2], graph.relative(BASE, anchor)[1]
    spread = turned(spread, -theta)
    spread[2, 2] = covariance[2, 2]
    pose: Pose2 = (float(points[best, 0]), float(points[best, 1]), theta)
    return Sought(anchor=anchor, base_T_object=pose, covariance=upper(spread), support=places[best][0], places=places)
