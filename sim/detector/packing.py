"""Packing: the outlines of known types that together make up the tops of a cluster of touching objects.

A top is level, at the height of its type, and has the type's outline. The outline that the points of that height fill
best is laid first, the outermost of equally good ones; its points are taken away, and the search goes on. So rows and
blocks of touching objects come apart, which have no waist.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.sim.detector.fitting import distance_to
from skolem.traces.messages import ObjectType

LEVEL_M = 0.010  # points this near the height of a type may be of its top: three sds of doubled depth noise at 1.4 m
STEP_M = 0.008  # between tried places: as far as pixels lie apart on a top
HEADINGS = 45  # of the narrowest rectangle around a top, over a quarter turn
FILLED = 0.65  # least share of an outline's area that its points cover: edges lose some of their pixels
AS_GOOD = 0.93  # of the best share; outlines in this range are equally good
MARGIN_M = 0.004  # points this far outside an outline are taken away with it
MAX_PARTS = 12
MAX_POINTS = 400  # of a top with which outlines are compared, evenly chosen
BESIDE_M, MAX_LEFT = 0.02, 0.15  # greatest share of a cluster's points that are farther than this from every outline

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Part:
    """The part of a cluster that an outline covers.

    Attributes:
        mask: Its points, shape (n,).
        xy_theta: Pose of the outline, shape (3,), metres and radians.
    """

    mask: NDArray[np.bool_]
    xy_theta: Array


def packed(feet: Array, heights: Array, area: Array, types: dict[str, ObjectType]) -> list[Part]:
    """Return the parts of a cluster, one for each object; none if no packing explains it.

    Boxes side by side may be laid lengthwise or across; the way with better filled outlines and fewer points outside
    them is taken.

    Args:
        feet: The points' feet on the support, shape (n, 2), metres.
        heights: Their heights above the support, shape (n,), metres.
        area: Horizontal area that each point stands for, shape (n,), square metres.
        types: The types that are sought, in the order of their names.
    """
    laid, quality = _laid(feet, heights, area, types, 0)
    if any(kind.shape == "box" for kind, _ in laid):
        laid, _ = max((laid, quality), _laid(feet, heights, area, types, 1), key=lambda way: way[1])
    if len(laid) < 2:
        return []
    distance = np.array([distance_to(kind)(feet, pose) for kind, pose in laid])
    if np.mean(distance.min(axis=0) > BESIDE_M) > MAX_LEFT:
        return []
    nearest = distance.argmin(axis=0)
    return [Part(nearest == index, pose) for index, (_, pose) in enumerate(laid)]


def _laid(
    feet: Array, heights: Array, area: Array, types: dict[str, ObjectType], turn: int
) -> tuple[list[tuple[ObjectType, Array]], float]:
    """Return outlines with their poses that cover a cluster's tops, and their quality.

    The quality is the share of the outlines that is filled less the share of the points that are left outside. A box
    lies across the direction of the others only if it does not fit along it; `turn` says which direction that is.
    """
    free = np.ones(len(feet), dtype=bool)
    shares: list[float] = []
    heading = {
        name: _heading(feet[np.abs(heights - kind.size_m[2]) < LEVEL_M]) if kind.shape == "box" else 0.0
        for name, kind in types.items()
    }
    across = {name: angle + math.pi / 2.0 for name, angle in heading.items()}
    first, second = (across, heading) if turn else (heading, across)
    laid: list[tuple[ObjectType, Array]] = []
    while len(laid) < MAX_PARTS:
        left = np.where(free, area, 0.0)
        best = _best(feet, heights, left, types, first) or _best(feet, heights, left, types, second)
        if best is None:
            break
        share, kind, pose = best
        shares.append(share)
        laid.append((kind, pose))
        free &= distance_to(kind)(feet, pose) > MARGIN_M
    return laid, float(np.mean(shares) - free.mean()) if shares else 0.0


def _best(
    feet: Array, heights: Array, area: Array, types: dict[str, ObjectType], heading: dict[str, float]
) -> tuple[float, ObjectType, Array] | None:
    """Return share filled, type and pose of the outline to be laid next, or None if no outline is filled."""
    found: tuple[float, ObjectType, Array] | None = None
    for name, kind in types.items():
        top = (np.abs(heights - kind.size_m[2]) < LEVEL_M) & (area > 0.0)
        if area[top].sum() < FILLED * _area(kind):
            continue
        every = int(np.count_nonzero(top)) // MAX_POINTS + 1
        poses = _poses(feet[top], heading[name])
        share = _shares(feet[top][::every], every * area[top][::every], kind, poses)
        good = np.flatnonzero(share >= max(FILLED, AS_GOOD * float(share.max())))
        if len(good) and (found is None or float(share.max()) > found[0]):
            out = np.linalg.norm(poses[good, :2] - feet[top].mean(axis=0), axis=1)
            found = float(share.max()), kind, poses[good[int(np.argmax(out))]]
    return found


def _poses(feet: Array, theta: float) -> Array:
    """Return the poses at which an outline is tried, shape (m, 3): on a grid over the points."""
    low, high = feet.min(axis=0), feet.max(axis=0)
    x, y = np.meshgrid(*(np.arange(low[axis], high[axis] + STEP_M, STEP_M) for axis in (0, 1)), indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, theta)])


def _heading(feet: Array) -> float:
    """Return the heading of the rectangle of least area around points: boxes side by side lie along it."""
    if not len(feet):
        return 0.0
    tried = np.arange(HEADINGS) * (math.pi / 2.0 / HEADINGS)
    c, s = np.cos(tried)[:, None], np.sin(tried)[:, None]
    x, y = feet.T
    return float(tried[int(np.argmin(np.ptp(c * x + s * y, axis=1) * np.ptp(c * y - s * x, axis=1)))])


def _shares(feet: Array, area: Array, kind: ObjectType, poses: Array) -> Array:
    """Return the share of the outline's area that points inside it cover, for each pose, shape (m,)."""
    offset = feet[None, :, :] - poses[:, None, :2]
    half = np.array(kind.size_m[:2]) / 2.0
    if kind.shape == "cylinder":
        inside = np.einsum("mnk,mnk->mn", offset, offset) < half[0] ** 2
    else:
        c, s = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
        along = np.abs(c * offset[..., 0] + s * offset[..., 1])
        across = np.abs(c * offset[..., 1] - s * offset[..., 0])
        inside = (along < half[0]) & (across < half[1])
    return np.asarray(np.minimum(np.einsum("mn,n->m", inside, area) / _area(kind), 1.0))


def _area(kind: ObjectType) -> float:
    """Return the area of a type's outline, square metres."""
    width, depth, _ = kind.size_m
    return math.pi / 4.0 * width * depth if kind.shape == "cylinder" else width * depth
