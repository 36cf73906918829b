"""Measurement of one growing run in a separate process, so that the memory is that of the run alone."""

import multiprocessing
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from benchmarks.estimator_logs import Step, course, steps_a_round
from benchmarks.estimator_scores import NEES, Smoother, errors
from benchmarks.tables import Table, Target
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Consolidated

OBJECTS, STEPS, BLOCK = 1000, 10_000, 50  # size of the run; drives between consolidations
PARTS = 10  # rows of the result
JUDGED_EVERY = 20  # steps
KEPT = 500  # steps kept in memory, to measure the size of a log
MOST_FACTORS, MOST_GROWTH = 2.0, 1.25  # per object; factor of memory after the first round, when everything was seen


@dataclass(frozen=True, slots=True)
class Part:
    """The measurements over one part of the run.

    Attributes:
        steps: Number of steps so far.
        median_ms, mean_ms: CPU time of a step.
        factors: Number of factors in the graph at its end.
        largest: Number of variables of the largest factor.
        most_seen: Most objects seen between two consolidations.
        resident_mb: Memory of the process at its end.
        base_nees: Mean NEES of the base.
    """

    steps: int
    median_ms: float
    mean_ms: float
    factors: int
    largest: int
    most_seen: int
    resident_mb: float
    base_nees: float


def growth() -> Table:
    """Measure one growing run whose past is consolidated from time to time."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as alone:
        parts, step_kb = alone.submit(grown, OBJECTS, STEPS).result()
    rounds = STEPS / steps_a_round(OBJECTS)
    return Table(
        "Estimator: growth",
        f"{OBJECTS} objects on a ring, {STEPS} drives with a look each ({rounds:.1f} rounds), the past summed up every "
        f"{BLOCK} drives. The pose graph runs alone in a process of its own and each step is made when it is asked "
        "for; resident memory is that of this process, libraries included. Largest: variables of the factor that has "
        "most. Time: CPU time of a drive, a look and the share of the summing up.",
        ("steps", "median ms", "mean ms", "factors", "largest", "resident MB", "base NEES"),
        [
            (
                part.steps,
                f"{part.median_ms:.1f}",
                f"{part.mean_ms:.1f}",
                part.factors,
                part.largest,
                f"{part.resident_mb:.1f}",
                f"{part.base_nees:.2f}",
            )
            for part in parts
        ],
        _targets(parts),
        (
            f"This is the memory of the graph. A belief also keeps every event, as it can be rebuilt from them: about "
            f"{step_kb:.0f} kB a drive and a look here, without depth images; {STEPS * step_kb / 1e3:.0f} MB for this "
            "run. That part is a log and grows with the run.",
            *_why(parts),
        ),
    )


def _targets(parts: list[Part]) -> tuple[Target, ...]:
    factors, largest = max(part.factors for part in parts), max(part.largest for part in parts)
    first, last = _after_a_round(parts), parts[-1]
    most_seen = max(part.most_seen for part in parts)
    return (
        Target(f"at most {MOST_FACTORS:.0f} factors an object", factors <= MOST_FACTORS * OBJECTS, f"{factors}"),
        Target(
            f"no factor of more variables than the base and what {BLOCK} drives show, {most_seen} things at most",
            largest <= max(most_seen + 1, EstimatorConfig().coupled),
            f"{largest}",
        ),
        Target(
            f"resident memory at the end at most {MOST_GROWTH:.2f} times that after the first round",
            last.resident_mb <= MOST_GROWTH * first.resident_mb,
            f"{last.resident_mb:.0f} MB, {first.resident_mb:.0f} MB after {first.steps} steps",
        ),
    )


def _after_a_round(parts: list[Part]) -> Part:
    return next((part for part in parts if part.steps >= steps_a_round(OBJECTS)), parts[0])


def _why(parts: list[Part]) -> Iterator[str]:
    """Yield the causes if the run becomes slower or larger than it should."""
    first, last = parts[0], parts[-1]
    if last.mean_ms > MOST_FACTORS * first.mean_ms:
        yield (
            f"A step takes {last.mean_ms / first.mean_ms:.1f} times as long at the end, as every round sees the same "
            "objects in other groups: the summaries, each of a bounded number of objects, overlap more and more, and "
            "a correction travels farther through them."
        )
    if not all(target.met for target in _targets(parts)):
        more = last.factors - _after_a_round(parts).factors
        yield (
            f"Since the first round the graph has got {more} more factors; the smoother keeps an empty place for each "
            "one that was ever taken out, and larger cliques for summaries that overlap."
        )


def grown(objects: int, steps: int) -> tuple[list[Part], float]:
    """Return the measurements of each part of a run, and the memory of a step in a log, kB."""
    run, part = course(objects, 0), steps // PARTS
    smoother = Smoother(run.began)
    parts = [_gone_on(smoother, islice(run.steps, part), part * i) for i in range(PARTS)]
    before, log = resident_mb(), list(islice(run.steps, KEPT))
    return parts, 1e3 * (resident_mb() - before) / len(log)


def _gone_on(smoother: Smoother, steps: Iterator[Step], before: int) -> Part:
    """Return the measurements of further steps; `before` is the number of earlier steps, a multiple of `BLOCK`."""
    spent, nees, seen = [], [], [set[str]()]
    for i, step in enumerate(steps, start=1):
        start = time.process_time()
        smoother.take(step.moved)
        smoother.take(step.looked)
        if i % BLOCK == 0:
            smoother.take(Consolidated())
        spent.append(1e3 * (time.process_time() - start))
        seen[-1].update(sighting.anchor for sighting in step.looked.sightings)
        if i % BLOCK == 0:
            seen.append(set())
        if i % JUDGED_EVERY == 0 and step.looked.sightings:
            nees.append(errors(*smoother.base(), step.world_T_base)[NEES])
    return Part(
        before + i,
        float(np.median(spent)),
        float(np.mean(spent)),
        *_factors(smoother),
        max(map(len, seen)),
        resident_mb(),
        float(np.mean(nees)),
    )


def _factors(smoother: Smoother) -> tuple[int, int]:
    """Return the number of factors, and the number of variables of the largest."""
    graph = smoother.graph.smoother.getFactorsUnsafe()
    sizes = [len(graph.at(i).keys()) for i in range(graph.size()) if graph.exists(i)]
    return len(sizes), max(sizes)


def resident_mb() -> float:
    """Return the resident memory of this process, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
