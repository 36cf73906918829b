"""Things a look shows in a region that no anchor explains: the detector has overlooked them, or does not know them.

A depth reading that ends in the air of a region has hit something. If nothing that is believed to stand there explains
it, the region's contents are not known, however much of it has been seen; each further look in which the detector says
nothing about it makes it less likely to be a thing that the detector would report.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from skolem.estimation import arm
from skolem.estimation.attributes import after_miss
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.coverage import Array, Mask
from skolem.traces.messages import HANDS, RobotState


@dataclass(frozen=True, slots=True)
class Unexplained:
    """What was hit in a region and is not explained.

    Attributes:
        hit: Voxels in which readings ended, shape (n,).
        looks: In how many looks, since there was nothing unexplained.
    """

    hit: Mask
    looks: int = 0

    def after(self, hit: Mask, explained: Mask) -> "Unexplained":
        """Return what is left after a look that hit voxels without an explanation and explained or refuted others."""
        left = (self.hit & ~explained) | hit
        return Unexplained(left, self.looks + int(hit.any()) if left.any() else 0)

    def prob_overlooked(self, config: EstimatorConfig, found: float) -> float:
        """Return P(it is a thing of a type that the detector reports)."""
        p = config.solid_is_thing if self.looks else 0.0
        for _ in range(self.looks):
            p = after_miss(p, found)
        return p


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
