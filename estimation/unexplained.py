"""Things a look shows in a region that no anchor explains: the detector has overlooked them, or does not know them.

A depth reading that ends in the air of a region has hit something. If nothing that is believed to stand there explains
it, the region's contents are not known, however much of it has been seen; each further look in which the detector says
nothing about it makes it less likely to be a thing that the detector would report, as far as it would have reported one
from there. Readings that ended side by side have hit the same thing.
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
    """What was hit in a region and is not explained.

    Attributes:
        hits: How many readings ended in each voxel, over all looks, shape (n,).
        thing: P(what was hit there is of a type that the detector reports), shape (n,); 0 where nothing was.
    """

    hits: NDArray[np.int64]
    thing: Array

    @classmethod
    def nothing(cls, grid: Grid) -> "Unexplained":
        """Return what is unexplained of a region before the first look."""
        return cls(np.zeros(len(grid.centres), dtype=np.int64), np.zeros(len(grid.centres)))

    def after(
        self,
        hits: NDArray[np.int64],
        explained: Mask,
        grid: Grid,
        p_reported: Callable[[Array], float],
        is_thing: float,
    ) -> "Unexplained":
        """Return what is left after a look.

        Args:
            hits: Readings that ended in each voxel, shape (n,).
            explained: Voxels of which the look has explained or refuted what was hit there, shape (n,).
            grid: The voxels.
            p_reported: Tells with which probability the look would have reported a thing, given its middle, shape (3,).
            is_thing: P(what was not hit before is of a type that the detector reports), before its word.
        """
        hits = np.where(explained, 0, self.hits + hits)
        thing = np.where(self.hits > 0, self.thing, is_thing) * (hits > 0)
        for cluster in _clusters(hits, grid):
            middle = grid.centres[cluster].mean(axis=0)
            thing[cluster] = after_miss(float(thing[cluster].min()), p_reported(middle))
        return Unexplained(hits, thing)

    def prob_overlooked(self, grid: Grid, config: EstimatorConfig) -> float:
        """Return P(a thing of a type that the detector reports is among it); few readings are errors at edges."""
        clusters = [c for c in _clusters(self.hits, grid) if self.hits[c].sum() >= config.least_hits]
        return 1.0 - float(np.prod([1.0 - self.thing[cluster[0]] for cluster in clusters]))


def _clusters(hits: NDArray[np.int64], grid: Grid) -> list[NDArray[np.int64]]:
    """Return the voxels, as indices, of each cluster of those that were hit and touch by face, edge or corner."""
    if not hits.any():
        return []
    from scipy import ndimage  # takes a while, and few runs hit anything that is not explained

    label, count = ndimage.label(hits.reshape(grid.shape) > 0, structure=np.ones((3, 3, 3)))
    return [np.flatnonzero(label.ravel() == index + 1) for index in range(count)]


def near_arms(points_base: Array, robot: RobotState, radius_m: float) -> Mask:
    """Return which points, shape (n, 3), base frame, are near an arm, a hand, or where a hand holds something."""
    near = np.zeros(len(points_base), dtype=bool)
    for hand in HANDS if len(near) else ():
        joints = arm.joints_base(robot, hand)
        for start, end in pairwise(joints):
            along = end - start
            share = np.clip((points_base - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
            near |= np.linalg.norm(points_base - start - share[:, None] * along, axis=1) <= radius_m
    return near
