"""Comparison of the belief and the filters on the same logs from PyBullet, rendering and detector included."""

import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.estimator_peers import Ekf, Estimator, Ukf
from benchmarks.estimator_recorded import TOUR_LOOKS, Errors, along, judged, record, touring
from benchmarks.estimator_scores import (
    NEES,
    SQUARE_M2,
    Comparison,
    Smoother,
    band,
    compared,
    means,
    no_worse,
    rms,
    why_outside,
    why_worse,
)
from benchmarks.tables import ROOT, Table, Target
from skolem.estimation.events import Began
from skolem.tools.loop.setup import prepare
from skolem.traces.file.reader import Trace

Array = NDArray[np.float64]
SEEDS = 50  # tours of each scenario
TOURS = ("sim1_green", "real2_green")  # cans on three tables; a can and two boxes, with worse sensors and wheels
WHOLE = (("sim1_green", 2), ("sim2_heavy_soda", 1), ("real2_green", 2))  # whole runs: scenario, seeds
OURS = "factor graph"
MAKERS: dict[str, Callable[[Began], Estimator]] = {OURS: Smoother, "EKF": Ekf, "UKF (filterpy)": Ukf}
IDEAL = {"base": 3, "places": 2, "headings": 1}  # ideal NEES: the degrees of freedom

Results = dict[tuple[str, str], list[Errors]]  # by group of runs and estimator


def recorded() -> Table:
    """Measure tours of drives and looks in PyBullet, and a few whole runs by their traces."""
    tours = _tours()
    bands = "; ".join(f"{what} {low:.2f} to {high:.2f}" for what, (low, high) in _bands().items())
    return Table(
        "Estimator: runs in PyBullet",
        "Logs of what the robot did and saw in PyBullet, rendering and detector included, against the truth after "
        f"every look. A tour: {TOUR_LOOKS} times a drive and a look at a table, {SEEDS} seeds of each scenario, not a "
        "run of the whole robot; of those, which take long, there are a few, read from their traces. Every estimator "
        "gets the same events, the belief's word for which detection is of which thing included; the filters know "
        "only drives and looks, and of things those that were told of, so they have no rows for whole runs. Base: "
        "over (x, y, theta) in the world, 'last' after the last look. Places: (x, y) of cans and boxes as seen from "
        "the base. Headings: those of boxes and tables as seen from the base, of a cylinder none shows. NEES is "
        f"ideally 3, 2 and 1. 95 % bands of {SEEDS} tours, as of one independent sample a tour: {bands}.",
        (
            *("runs", "number", "estimator"),
            *("base RMSE mm", "base NEES", "last"),
            *("places RMSE mm", "places NEES"),
            *("headings RMSE deg", "headings NEES"),
        ),
        [(*_named(key, runs), *_figures(runs)) for key, runs in (tours | _whole()).items()],
        (*(_inside(tours, what) for what in IDEAL), no_worse(_beside_peers(tours))),
        tuple(_why(tours)),
    )


def _tours() -> Results:
    results: Results = {}
    for scenario in TOURS:
        setup = prepare(ROOT / "scenarios" / f"{scenario}.yaml")
        recordings = [touring(setup, seed) for seed in range(SEEDS)]
        for name, make in MAKERS.items():
            results[f"tours of {scenario}", name] = [judged(make, each, setup.types) for each in recordings]
    return results


def _whole() -> Results:
    results: Results = {}
    with tempfile.TemporaryDirectory() as folder:
        for scenario, seeds in WHOLE:
            path = ROOT / "scenarios" / f"{scenario}.yaml"
            types = prepare(path).types
            for seed in range(seeds):
                trace = Path(folder) / f"{scenario}-{seed}.mcap"
                record(path, seed, "pybullet", trace)
                run = judged(Smoother, along(Trace(trace)), types)
                results.setdefault((f"whole runs of {scenario}", OURS), []).append(run)
    return results


def _bands() -> dict[str, tuple[float, float]]:
    return {what: band(SEEDS, ideal) for what, ideal in IDEAL.items()}


def _nees(runs: Sequence[Errors], what: str) -> Array:
    """Return the mean NEES of each run, shape (n,)."""
    return means([getattr(run, what) for run in runs], NEES)


def _outside(tours: Results, what: str) -> list[str]:
    """Return the groups in which our mean NEES is outside the band."""
    low, high = _bands()[what]
    ours = {group: float(_nees(runs, what).mean()) for (group, name), runs in tours.items() if name == OURS}
    return [group for group, nees in ours.items() if not low <= nees <= high]


def _inside(tours: Results, what: str) -> Target:
    ours = {group: _nees(runs, what).mean() for (group, name), runs in tours.items() if name == OURS}
    found = [f"{nees:.2f} in {group}" for group, nees in ours.items()]
    return Target(f"mean NEES of {what} within the 95 % band", not _outside(tours, what), "; ".join(found))


def _beside_peers(tours: Results) -> list[Comparison]:
    return [
        compared(f"{what} in {group}, {name}", _nees(tours[group, OURS], what), _nees(runs, what), ideal)
        for (group, name), runs in tours.items()
        for what, ideal in IDEAL.items()
        if name != OURS
    ]


def _why(tours: Results) -> Iterator[str]:
    """Yield the known causes of each mean NEES that is outside its band or worse than a peer's."""
    for what, inside in _bands().items():
        for group in _outside(tours, what):
            peers = {name: float(_nees(runs, what).mean()) for (g, name), runs in tours.items() if g == group}
            # squared normalised errors along each axis; a heading has one axis, so this is the NEES itself
            rows = np.vstack([getattr(run, what) for run in tours[group, OURS]])
            axes = rows[:, NEES:] if what == "headings" else rows[:, NEES + 1 :]
            yield why_outside(f"{what} in {group}", peers.pop(OURS), inside, peers, axes)
    yield from why_worse(_beside_peers(tours))


def _named(key: tuple[str, str], runs: Sequence[Errors]) -> tuple[object, ...]:
    group, name = key
    return group, len(runs), name


def _figures(runs: Sequence[Errors]) -> list[str]:
    base, places, headings = (np.vstack([getattr(run, what) for run in runs]) for what in IDEAL)
    return [
        f"{1e3 * rms(base[:, SQUARE_M2]):.1f}",
        f"{_nees(runs, 'base').mean():.2f}",
        f"{np.mean([run.base[-1, NEES] for run in runs]):.2f}",
        f"{1e3 * rms(places[:, SQUARE_M2]):.1f}",
        f"{_nees(runs, 'places').mean():.2f}",
        f"{math.degrees(rms(headings[:, 0])):.2f}",
        f"{_nees(runs, 'headings').mean():.2f}",
    ]
