"""Measurements of the detector on a table with many things of one type, which hide much of the table and each other."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence

from benchmarks.detector import NOISE, Tally, judge
from benchmarks.detector_scenes import HUES, Scene, Thing
from benchmarks.tables import Table, Target
from skolem.estimation.visibility import outline_radius as radius
from skolem.reasoner.planning.queries import load_rules
from skolem.traces.messages import NoiseModel, ObjectType

KINDS, COUNTS = ("bottle", "carton", "soda"), (12, 18, 24, 30)
SCENES = 5  # number for each kind, count and noise
DEEP_M, WIDE_M = np.linspace(0.82, 1.38, 5), np.linspace(-0.48, 0.48, 6)  # places of 30 things, 14 and 19 cm apart
JITTER_M = 0.03  # greatest shift from such a place, on each axis
GAP_M = 0.02  # least gap between outlines
TABLE_M = 0.68
NEAR_M = 0.04  # a detection farther from every thing is false: centres are at least 8 cm apart
ENOUGH = 0.95  # recall and precision in every row


def crowd(kind: str, count: int, number: int, types: dict[str, ObjectType]) -> Scene:
    """Return so many things of one type and one colour, at random ones of 30 places, each shifted and turned at random.

    Args:
        kind: Their type.
        count: Their number, at most 30.
        number: Number of the scene; with kind and count it determines every draw.
        types: Gives the size of the type.
    """
    draws = Generator(PCG64(SeedSequence([number, count, *kind.encode()])))
    places = [(float(x), float(y)) for x in DEEP_M for y in WIDE_M]
    chosen = [places[int(index)] for index in np.sort(draws.permutation(len(places))[:count])]
    hsv = (HUES[int(draws.integers(len(HUES)))], 0.9, 0.8)
    things: list[Thing] = []
    for place in chosen:
        x, y = _shifted(place, 2.0 * radius(types[kind]) + GAP_M, things, draws)
        things.append(Thing(kind, (x, y, TABLE_M, float(draws.uniform(-math.pi / 2.0, math.pi / 2.0))), hsv))
    return Scene(f"{count} of {kind}", number, tuple(things), tuple(range(count)), TABLE_M)


def _shifted(
    place: tuple[float, float], apart_m: float, others: list[Thing], draws: Generator
) -> tuple[float, float]:
    """Return a random place near a given one, at least a distance from the centres of others."""
    while True:
        x, y = (float(value) for value in draws.uniform(-JITTER_M, JITTER_M, 2) + place)
        if all(math.dist((x, y), other.world_T_object[:2]) >= apart_m for other in others):
            return x, y


def measured(
    kinds: tuple[str, ...] = KINDS, counts: tuple[int, ...] = COUNTS, scales: tuple[int, ...] = (1, 2)
) -> dict[tuple[str, int, int], Tally]:
    """Return the results for each type, number of things and factor on the noise, in order."""
    types = {name: kind for name, kind in sorted(load_rules().vocabulary.types.items()) if kind.graspable}
    tallies: dict[tuple[str, int, int], Tally] = {}
    for kind in kinds:
        for count in counts:
            for number in range(SCENES):
                scene = crowd(kind, count, number, types)
                for scale in scales:
                    judge(scene, types, tallies.setdefault((kind, count, scale), Tally()), noise_times(scale), NEAR_M)
    return tallies


def noise_times(scale: int) -> NoiseModel:
    """Return the noise of the scenes with depth and calibration errors a number of times as large."""
    return NOISE.model_copy(
        update={
            "depth_sd_scale": scale * NOISE.depth_sd_scale,
            "extrinsics_sd_m": scale * NOISE.extrinsics_sd_m,
            "extrinsics_sd_rad": scale * NOISE.extrinsics_sd_rad,
        }
    )
