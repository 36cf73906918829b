"""Measurements of the belief: accuracy and consistency beside EKF and filterpy's UKF, growth, association, robustness.

Times are CPU time of this process, so that other work of the machine matters little; compare ratios.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.estimator_crowds import association, robustness
from benchmarks.estimator_growth import growth
from benchmarks.estimator_logs import Log, simulated
from benchmarks.estimator_peers import Ekf, Estimator, Ukf
from benchmarks.estimator_runs import recorded
from benchmarks.estimator_scores import (
    AXES,
    NEES,
    SQUARE_M2,
    Comparison,
    Smoother,
    band,
    compared,
    errors,
    means,
    no_worse,
    rms,
    why_outside,
    why_worse,
)
from benchmarks.tables import Table, Target
from skolem.estimation.events import Began
from skolem.estimation.se2 import between

Array = NDArray[np.float64]
SEEDS, STEPS = 50, 60  # size of the simulated logs
UKF_SEEDS, UKF_STEPS = 6, 24  # for filterpy's filter at 50 objects, which is slow
BAD_HEADING_SD = 0.3  # rad, heading of the base at the start
IDEAL = 3.0  # NEES of a planar pose
FASTER = 10.0  # times as fast as filterpy's filter
OURS, EKF, UKF = "factor graph", "EKF", "UKF (filterpy)"
MAKERS: dict[str, Callable[[Began], Estimator]] = {OURS: Smoother, EKF: Ekf, UKF: Ukf}
FEW, VAGUE, MANY, SHORT = "5", "5, heading vague", "50", f"50, {UKF_STEPS} steps"
BOTH = ("base", "relative")


@dataclass(frozen=True, slots=True)
class Score:
    """The result of one estimator on one log.

    Attributes:
        update_ms: Median CPU time of a drive and a look.
        query_ms: Median CPU time of a query for mean and covariance of the base, and of one object relative to it.
        base, relative: The rows of `errors` for each step with a sighting, shape (n, 5).
    """

    update_ms: float
    query_ms: float
    base: Array
    relative: Array


Results = dict[tuple[str, str], list[Score]]  # by case and estimator


def scored(make: Callable[[Began], Estimator], log: Log, steps: int | None = None) -> Score:
    """Return the result of an estimator on the first steps of a log."""
    estimator, update_s, query_s, base, relative = make(log.began), [], [], [], []
    for step in log.steps[:steps]:
        start = time.process_time()
        estimator.take(step.moved)
        estimator.take(step.looked)
        update_s.append(time.process_time() - start)
        if step.looked.sightings:
            anchor = step.looked.sightings[0].anchor
            start = time.process_time()
            world_T_base, base_T_object = estimator.base(), estimator.relative(anchor)
            query_s.append(time.process_time() - start)
            base.append(errors(*world_T_base, step.world_T_base))
            relative.append(errors(*base_T_object, between(step.world_T_base, log.world_T_object[anchor])))
    return Score(1e3 * float(np.median(update_s)), 1e3 * float(np.median(query_s)), np.array(base), np.array(relative))


def tables() -> Iterator[Table]:
    """Measure everything and yield one table after another."""
    yield accuracy()
    yield growth()
    yield association()
    yield robustness()
    yield recorded()


def accuracy() -> Table:
    """Compare accuracy, consistency and time with those of the peers on the same simulated logs."""
    results = _results()
    low, high = band(SEEDS)
    return Table(
        "Estimator: accuracy and consistency",
        f"{SEEDS} simulated logs of {STEPS} drives and looks each ({UKF_SEEDS} where it says {UKF_STEPS} steps), every "
        "estimator on the same ones. NEES: squared normalised error of a planar pose, 3 if errors are as large as the "
        f"belief says; mean over all steps, and 'last' after the last one. 95 % band {low:.2f} to {high:.2f}, as of "
        "one independent sample a log. Update: median CPU time of one drive and one look. Query: the same of asking "
        "for mean and covariance of the base and of one thing as seen from it; filters keep their covariance up to "
        "date as part of the update, a factor graph works it out when asked, so the ratio is of both together.",
        (
            "objects",
            "estimator",
            "update ms",
            "query ms",
            *("base RMSE m", "base NEES", "last"),
            *("relative RMSE m", "relative NEES", "last"),
        ),
        [(case, name, *_figures(scores)) for (case, name), scores in results.items()],
        (_inside(results), no_worse(_beside_peers(results)), _faster(results)),
        tuple(_why(results)),
    )


def _results() -> Results:
    few = [simulated(5, STEPS, seed) for seed in range(SEEDS)]
    vague = [simulated(5, STEPS, seed, BAD_HEADING_SD) for seed in range(SEEDS)]
    many = [simulated(50, STEPS, seed) for seed in range(SEEDS)]
    results = {(FEW, name): [scored(make, log) for log in few] for name, make in MAKERS.items()}
    results |= {(VAGUE, name): [scored(make, log) for log in vague] for name, make in MAKERS.items()}
    results |= {(MANY, name): [scored(MAKERS[name], log) for log in many] for name in (OURS, EKF)}
    some = many[:UKF_SEEDS]
    return results | {(SHORT, name): [scored(make, log, UKF_STEPS) for log in some] for name, make in MAKERS.items()}


def _outside(results: Results) -> list[tuple[str, str]]:
    """Return the cases in which our mean NEES, of the base or the relative poses, is outside the band."""
    low, high = band(SEEDS)
    cases = [(case, which) for case in (FEW, VAGUE, MANY) for which in BOTH]
    return [(case, which) for case, which in cases if not low <= _nees(results[case, OURS], which).mean() <= high]


def _inside(results: Results) -> Target:
    cases, outside = 3 * len(BOTH), len(_outside(results))
    text = f"mean NEES of base and relative pose within the 95 % band, {SEEDS} seeds each"
    return Target(text, not outside, f"{cases - outside} of {cases} inside")


def _beside_peers(results: Results) -> list[Comparison]:
    pairs = [(case, name, which) for case, name in results if name != OURS for which in BOTH]
    return [
        compared(
            f"{case} objects, {which}, {name}",
            _nees(results[case, OURS], which),
            _nees(results[case, name], which),
            IDEAL,
        )
        for case, name, which in pairs
    ]


def _faster(results: Results) -> Target:
    ours, theirs = (_ms(results[SHORT, name]) for name in (OURS, UKF))
    ratio, update = sum(theirs) / sum(ours), theirs[0] / ours[0]
    text = f"update and query at least {FASTER:.0f} times faster than those of filterpy's UKF at 50 objects"
    return Target(text, ratio >= FASTER, f"{ratio:.0f} x; the update alone {update:.0f} x")


def _why(results: Results) -> Iterator[str]:
    """Yield the known causes of each missed target."""
    for case, which in _outside(results):
        peers = {name: float(_nees(scores, which).mean()) for (c, name), scores in results.items() if c == case}
        found, axes = peers.pop(OURS), np.vstack([getattr(score, which)[:, AXES] for score in results[case, OURS]])
        yield why_outside(f"{case} objects, {which}", found, band(SEEDS), peers, axes)
    yield from why_worse(_beside_peers(results))
    if not _faster(results).met:
        (ours, query), (theirs, _) = (_ms(results[SHORT, name]) for name in (OURS, UKF))
        yield f"Of our {ours + query:.2f} ms, {query:.2f} ms are the query; of filterpy's {theirs:.2f} ms nearly none."


def _nees(scores: Sequence[Score], which: str) -> Array:
    return means([getattr(score, which) for score in scores], NEES)


def _ms(scores: Sequence[Score]) -> tuple[float, float]:
    """Return the time of an update and of a query."""
    return float(np.median([s.update_ms for s in scores])), float(np.median([s.query_ms for s in scores]))


def _figures(scores: Sequence[Score]) -> list[str]:
    figures = [f"{ms:.2f}" for ms in _ms(scores)]
    for which in BOTH:
        last = float(np.mean([getattr(score, which)[-1, NEES] for score in scores]))
        rmse = rms(means([getattr(score, which) for score in scores], SQUARE_M2))
        figures += [f"{rmse:.4f}", f"{_nees(scores, which).mean():.2f}", f"{last:.2f}"]
    return figures
