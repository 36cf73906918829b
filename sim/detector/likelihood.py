"""The likelihood of a type for a cluster, from the errors of its height and its outline.

Nearly always a cluster is exactly one object; then its errors are those of depth, whose noise and steps grow with the
square of the distance. Sometimes it is not: a cut leaves a piece of the neighbour, or two objects form one cluster.
Then height and outline are off by centimetres and say almost nothing about the type. Both cases together make a
contaminated Gaussian (Tukey, "A survey of sampling from contaminated distributions", 1960).
"""

import math

from skolem.sim.truth.noise import RANGE_M
from skolem.traces.messages import ObjectType

HEIGHT_SD_PER_M2 = 0.00035  # metres per square metre of distance: of the height of one object's top
OUTLINE_SD_PER_M2 = 0.0007  # the same, of the mean distance of one object's points from its outline
MIXED = 0.01  # probability that a cluster is not exactly one object
MIXED_HEIGHT_SD_M, MIXED_OUTLINE_SD_M = 0.1, 0.02  # of such a cluster: wider than types differ


def type_log_likelihood(height_error_m: float, outline_error_m: float, distance_m: float) -> float:
    """Return the log-likelihood of a type for a cluster, relative to that of a cluster without errors, which is 0.

    Args:
        height_error_m: Height of the cluster's top less that of the type.
        outline_error_m: Mean distance of its points from the type's outline.
        distance_m: From the camera.
    """
    square = max(distance_m, RANGE_M[0]) ** 2
    height_sd, outline_sd = HEIGHT_SD_PER_M2 * square, OUTLINE_SD_PER_M2 * square
    peak = height_sd * outline_sd / (MIXED_HEIGHT_SD_M * MIXED_OUTLINE_SD_M)
    odds = math.log(MIXED / (1.0 - MIXED) * peak)

    def log_density(height_m: float, outline_m: float) -> float:
        one = -0.5 * ((height_m / height_sd) ** 2 + (outline_m / outline_sd) ** 2)
        mixed = -0.5 * ((height_m / MIXED_HEIGHT_SD_M) ** 2 + (outline_m / MIXED_OUTLINE_SD_M) ** 2)
        less, more = sorted((one, odds + mixed))
        return more + math.log1p(math.exp(less - more))

    return log_density(height_error_m, outline_error_m) - log_density(0.0, 0.0)


def likeness(seen: ObjectType, kind: ObjectType, distance_m: float) -> float:
    """Return the log-likelihood of `kind` for an object of type `seen`, measured without errors at a distance."""
    return type_log_likelihood(seen.size_m[2] - kind.size_m[2], (seen.size_m[0] - kind.size_m[0]) / 2.0, distance_m)
