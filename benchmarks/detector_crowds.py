"""Measurements of the detector on a table with many things of one type, which hide much of the table and each other."""

import math

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence

from benchmarks.detector import NOISE, Tally, judge
from benchmarks.detector_scenes import HUES, Scene, Thing
from benchmarks.tables import Table, Target
from skolem.estimation.visibility import outline_radius as radius
from skolem.reasoner.planning.queries import load_rules
from skolem.traces.messages import NoiseModel, ObjectType

KINDS, COUNTS, NOISES = ("bottle", "carton", "soda"), (12, 18, 24, 30), (1, 2)
SCENES = 5  # number for each kind, count and noise
DEEP_M, WIDE_M = np.linspace(0.82, 1.38, 5), np.linspace(-0.48, 0.48, 6)  # places of 30 things, 14 and 19 cm apart
JITTER_M = 0.03  # greatest shift from such a place, on each axis
GAP_M = 0.02  # least gap between outlines
TABLE_M = 0.68
NEAR_M = 0.04  # a detection farther from every thing is false: centres are at least 8 cm apart
BLOCKS, TOUCH_M = ((1, 3), (2, 2), (2, 3), (3, 4)), 0.002  # rows and columns; gap between their outlines
BLOCK_X, BLOCK_RAD = 1.1, 0.3
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


def _shifted(place: tuple[float, float], apart_m: float, others: list[Thing], draws: Generator) -> tuple[float, float]:
    """Return a random place near a given one, at least a distance from the centres of others."""
    while True:
        x, y = (float(value) for value in draws.uniform(-JITTER_M, JITTER_M, 2) + place)
        if all(math.dist((x, y), other.world_T_object[:2]) >= apart_m for other in others):
            return x, y


def measured(types: dict[str, ObjectType]) -> dict[tuple[str, int, int], Tally]:
    """Return the results for each type, number of things and factor on the noise, in order."""
    tallies: dict[tuple[str, int, int], Tally] = {}
    for kind in KINDS:
        for count in COUNTS:
            for number in range(SCENES):
                scene = crowd(kind, count, number, types)
                for scale in NOISES:
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


def block(kind: str, rows: int, columns: int, types: dict[str, ObjectType]) -> Scene:
    """Return so many rows and columns of things of one type that touch each other, aslant on the table."""
    width, depth, _ = types[kind].size_m
    c, s = math.cos(BLOCK_RAD), math.sin(BLOCK_RAD)
    places = [
        ((i - (rows - 1) / 2.0) * (width + TOUCH_M), (j - (columns - 1) / 2.0) * (depth + TOUCH_M))
        for i in range(rows)
        for j in range(columns)
    ]
    things = tuple(
        Thing(kind, (BLOCK_X + c * u - s * v, s * u + c * v, TABLE_M, BLOCK_RAD), (0.0, 0.9, 0.8)) for u, v in places
    )
    return Scene(f"{rows} x {columns} of {kind}", 0, things, tuple(range(len(things))), TABLE_M)


def tables() -> tuple[Table, Table]:
    """Return the measurements of crowds and of blocks as tables."""
    known = dict(sorted(load_rules().vocabulary.types.items()))
    tallies = measured(known)
    low = {name: min(figure(tally) for tally in tallies.values()) for name, figure in FIGURES.items()}
    crowds = Table(
        "Detector: crowds",
        f"{SCENES} tables for each row, with things of one type and colour, 2 to 15 cm apart, at random ones of 30 "
        "places, each shifted and turned at random; they hide much of each other and of the table. Noise: factor on "
        "the depth and calibration errors of the scenarios. Place: error of the centre, which the calibration error "
        "of each look dominates; its NEES is ideally 2. Time: CPU time of a frame.",
        ("things", "number", "noise", "recall", "precision", "type right", "place mm: median", "NEES", "ms"),
        [(kind, count, f"x{scale}", *_figures(tally)) for (kind, count, scale), tally in tallies.items()],
        [
            Target(f"{name} at least {ENOUGH} in every row", value >= ENOUGH, f"{value:.3f}")
            for name, value in low.items()
        ],
    )
    touching = {(kind, f"{rows} x {columns}"): Tally() for kind in KINDS for rows, columns in BLOCKS}
    for kind in KINDS:
        for rows, columns in BLOCKS:
            judge(block(kind, rows, columns, known), known, touching[kind, f"{rows} x {columns}"])
    blocks = Table(
        "Detector: blocks",
        f"Things of one type in rows and columns, {1e3 * TOUCH_M:.0f} mm apart: one cluster, which the outlines of "
        "known types take apart. One table for each row; columns as above.",
        ("things", "block", "recall", "precision", "type right", "place mm: median", "NEES", "ms"),
        [(*key, *_figures(tally)) for key, tally in touching.items()],
        notes=(
            "The tops of boxes side by side form one area without gaps: where the lines between them run is guessed.",
        ),
    )
    return crowds, blocks


def _recall(tally: Tally) -> float:
    return tally.found / tally.asked


def _precision(tally: Tally) -> float:
    return tally.found / max(tally.found + tally.false, 1)


FIGURES = {"recall": _recall, "precision": _precision}


def _figures(tally: Tally) -> list[str]:
    if not tally.found:
        return [
            f"{_recall(tally):.3f}",
            f"{_precision(tally):.3f}",
            "-",
            "-",
            "-",
            f"{1e3 * np.median(tally.seconds):.0f}",
        ]
    return [
        f"{_recall(tally):.3f}",
        f"{_precision(tally):.3f}",
        f"{tally.right / tally.found:.3f}",
        f"{np.median(tally.errors_mm):.1f}",
        f"{np.mean(tally.squares):.2f}",
        f"{1e3 * np.median(tally.seconds):.0f}",
    ]
