"""Unexplained hits in a region: depth readings that ended in its air, but not on a believed object.

Such readings have hit something that the detector has overlooked or does not know. So the contents of the region are
not known, however much of the region has been seen. Each further look without a detection makes it less likely that the
hit object is of a type that the detector reports. The greater P(detected) was in that look, the less likely it is.
Readings that ended side by side have hit the same object.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from skolem.estimation import arm
from skolem.estimation.attributes import after_miss
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.coverage import Array, Grid, Mask
from skolem.traces.messages import HANDS, RobotState


@dataclass(frozen=True, slots=True)
class Unexplained:
    """The unexplained hits in a region.

    Attributes:
        hits: Number of unexplained readings that ended in each voxel, over all looks, shape (n,).
        thing: P(the hit object is of a type that the detector reports), shape (n,); 0 for a voxel without hits.
    """

    hits: NDArray[np.int64]
    thing: Array

    @classmethod
    def nothing(cls, grid: Grid) -> "Unexplained":
        """Return the hits before the first look: none."""
        return cls(np.zeros(len(grid.centres), dtype=np.int64), np.zeros(len(grid.centres)))

    def after(
        self,
        hits: NDArray[np.int64],
        explained: Mask,
        grid: Grid,
        p_reported: Callable[[Array], float],
        is_thing: float,
    ) -> "Unexplained":
        """Return the unexplained hits after a look.

        Args:
            hits: Number of readings of the look that ended in each voxel, shape (n,).
            explained: Mask of the voxels whose hits the look has explained or refuted, shape (n,).
            grid: The voxels.
            p_reported: Function from the middle of an object, shape (3,), to P(the look detects the object).
            is_thing: Prior P(a newly hit object is of a type that the detector reports).
        """
        hits = np.where(explained, 0, self.hits + hits)
        thing = np.where(self.hits > 0, self.thing, is_thing) * (hits > 0)
        for cluster in _clusters(hits, grid):
            middle = grid.centres[cluster].mean(axis=0)
            thing[cluster] = after_miss(float(thing[cluster].min()), p_reported(middle))
        return Unexplained(hits, thing)

    def prob_overlooked(self, grid: Grid, config: EstimatorConfig) -> float:
        """Return P(the hits are of an object that the detector reports); a few readings count as errors at edges."""
        clusters = [c for c in _clusters(self.hits, grid) if self.hits[c].sum() >= config.least_hits]
        return 1.0 - float(np.prod([1.0 - self.thing[cluster[0]] for cluster in clusters]))


def _clusters(hits: NDArray[np.int64], grid: Grid) -> list[NDArray[np.int64]]:
    """Return the indices of the voxels in each cluster of hit voxels that touch by face, edge or corner."""
    if not hits.any():
        return []
    from scipy import ndimage  # slow to import, and few runs have unexplained hits

    label, count = ndimage.label(hits.reshape(grid.shape) > 0, structure=np.ones((3, 3, 3)))
    return [np.flatnonzero(label.ravel() == index + 1) for index in range(count)]


def near_arms(points_base: Array, robot: RobotState, radius_m: float) -> Mask:
    """Return the mask, shape (n,), of points, shape (n, 3), base frame, within `radius_m` of an arm or its hand."""
    near = np.zeros(len(points_base), dtype=bool)
    for hand in HANDS if len(near) else ():
        joints = arm.joints_base(robot, hand)
        for start, end in pairwise(joints):
            along = end - start
            share = np.clip((points_base - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
            near |= np.linalg.norm(points_base - start - share[:, None] * along, axis=1) <= radius_m
    return near
