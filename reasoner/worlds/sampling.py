"""Integrals over the poses: points that fill the unit cube evenly, and an interval for the mean of what they show.

The points are a scrambled Sobol sequence under several random digital shifts (Owen, "Monte Carlo theory, methods and
examples", chapters 15 to 17). They are keyed by a text, the goal: the same goal has the same points in every belief,
so an answer changes only with the belief. Each shift gives an independent estimate without bias, and their spread gives
an interval by Student's t.
"""

import hashlib
import math
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

Array = NDArray[np.float64]
SHIFTS: Final = 32  # independent estimates
FIRST: Final = 4096  # points in all before the first answer
MOST: Final = 262_144  # points in all at most
LEVEL: Final = 0.999  # of the interval
STUDENT: Final = 3.6335  # quantile of Student's t with SHIFTS - 1 degrees of freedom at (1 + LEVEL) / 2
RARE: Final = math.log(2.0 / (1.0 - LEVEL))  # an event that N independent points all miss has at most RARE / N
_BITS: Final = 30  # of a coordinate


@lru_cache(16)
def uniforms(key: str, dimension: int, start: int, stop: int) -> Array:
    """Return points of the open unit cube, shape (SHIFTS (stop - start), dimension), shift by shift.

    Args:
        key: The text that determines the points.
        dimension: Their dimension, at least 1.
        start: The number of points of each shift to leave out; 0 or as many as are returned.
        stop: The number of points of each shift up to the last one; a power of 2.
    """
    from scipy.stats import qmc  # slow to import, and few goals need it

    seed = int.from_bytes(hashlib.sha256(f"{key}/{dimension}".encode()).digest()[:16])
    generator = Generator(PCG64(SeedSequence(seed)))
    shifts = generator.integers(0, 1 << _BITS, size=(SHIFTS, 1, dimension), dtype=np.int64)
    sequence = qmc.Sobol(dimension, scramble=True, bits=_BITS, rng=generator)
    if start:
        sequence.fast_forward(start)
    base = (sequence.random(stop - start) * (1 << _BITS)).astype(np.int64)
    points: Array = ((base[None] ^ shifts) + 0.5) / (1 << _BITS)
    return points.reshape(-1, dimension)


def interval(estimates: Array, points: int) -> tuple[float, float]:
    """Return an interval that contains the mean at `LEVEL`.

    Args:
        estimates: The estimate of each shift, shape (SHIFTS,).
        points: The number of points in all.
    """
    mean = float(estimates.mean())
    half = STUDENT * float(estimates.std(ddof=1)) / math.sqrt(SHIFTS) + RARE / points
    return max(0.0, mean - half), min(1.0, mean + half)


def arrangements(truth: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Return the distinct rows of a table, shape (n, relations), and for each row the number of its like."""
    packed = np.packbits(truth, axis=1)
    width = -packed.shape[1] % 8
    codes = np.ascontiguousarray(np.pad(packed, ((0, 0), (0, width)))).view(np.uint64)
    if codes.shape[1] == 1:
        _, first, number = np.unique(codes[:, 0], return_index=True, return_inverse=True)
    else:
        _, first, number = np.unique(codes, axis=0, return_index=True, return_inverse=True)
    return truth[first], number.ravel()
