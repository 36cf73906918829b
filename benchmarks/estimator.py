"""The belief measured: accuracy and consistency beside a plain EKF and filterpy's UKF, growth, association, robustness.

Times are CPU time of this process, so that what else the machine does matters little; compare ratios.
"""

import math
import resource
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from benchmarks.estimator_logs import Log, simulated
from benchmarks.estimator_looks import MODERATE_M, Crowd, Endured, Gross, endured, whole_look_is_right
from benchmarks.estimator_peers import Ekf, Estimator, Ukf
from benchmarks.estimator_recorded import Errors, along, record, touring
from benchmarks.tables import ROOT, Table, Target
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Began, Consolidated, Looked, Moved
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.se2 import Matrix, between
from skolem.estimation.se2 import log as tangent
from skolem.tools.session import prepare
from skolem.traces.messages import Pose2
from skolem.traces.reader import Trace

Array = NDArray[np.float64]
SEEDS, STEPS = 50, 60  # of the simulated logs
UKF_SEEDS, UKF_STEPS = 6, 24  # of filterpy's filter at 50 objects, which takes its time
BAD_HEADING_SD = 0.3  # rad, of the base at first
LONG_OBJECTS, LONG_STEPS, LONG_BLOCK = 1000, 10_000, 50  # the long run, and drives between consolidations
LOOK_SEEDS, RUN_SEEDS = 30, 30
CANS, LOOKS, CALM = 8, 24, 3
CROWDS = (
    Crowd("sparse, base known", 6, 0.20, (0.01, 0.01, 0.01), 0.02, 0.9),
    Crowd("9 cm apart, base known", 9, 0.09, (0.01, 0.01, 0.01), 0.015, 0.9),
    Crowd("9 cm apart, base sd 5 cm and .08 rad", 9, 0.09, (0.05, 0.05, 0.08), 0.01, 0.9),
    Crowd("the same, 60 % reported", 9, 0.09, (0.05, 0.05, 0.08), 0.01, 0.6),
    Crowd("9 cm apart, base sd 10 cm and .1 rad", 9, 0.09, (0.10, 0.10, 0.10), 0.01, 0.9),
)
CLEAN, BOTH, LEFT_OUT = "clean", "both", "both, left out"
ERRORS = {
    CLEAN: Gross(0.0, 0.0),
    BOTH: Gross(0.1, 0.1),
    LEFT_OUT: Gross(0.1, 0.1, left_out=True),
    "both, outliers not counted": Gross(0.1, 0.1, counted=False),
    "both, outliers from 8 cm": Gross(0.1, 0.1, MODERATE_M),
}
RECORDED = (("sim1_green", 2), ("sim2_heavy_soda", 1))  # whole runs: scenario, seeds


class Smoother:
    """The product's pose graph, behind the interface of the peers."""

    def __init__(self, began: Began) -> None:
        self.graph = PoseGraph(EstimatorConfig())
        self.graph.apply(began)

    def take(self, event: Moved | Looked) -> None:
        """Take in one event."""
        self.graph.apply(event)

    def base(self) -> tuple[Pose2, Matrix]:
        """Return world_T_base and its covariance, base frame."""
        joint = self.graph.joint((BASE,))
        return joint.world_T_body[0], joint.covariance

    def relative(self, anchor: str) -> tuple[Pose2, Matrix]:
        """Return base_T_object and its covariance, object frame."""
        return self.graph.relative(BASE, anchor)


@dataclass(frozen=True, slots=True)
class Score:
    """How one estimator did on one log.

    Attributes:
        update_ms: Median CPU time of a drive and a look.
        base, relative: Per step with a sighting, squared error in metres and squared normalised error, shape (n, 2).
    """

    update_ms: float
    base: Array
    relative: Array


def scored(make: Callable[[Began], Estimator], log: Log, steps: int | None = None) -> Score:
    """Return how an estimator does on the first steps of a log."""
    estimator, spent, base, relative = make(log.began), [], [], []
    for step in log.steps[:steps]:
        start = time.process_time()
        estimator.take(step.moved)
        estimator.take(step.looked)
        spent.append(time.process_time() - start)
        if step.looked.sightings:
            anchor = step.looked.sightings[0].anchor
            base.append(errors(*estimator.base(), step.world_T_base))
            relative.append(errors(*estimator.relative(anchor), between(step.world_T_base, log.world_T_object[anchor])))
    return Score(1e3 * float(np.median(spent)), np.array(base), np.array(relative))


def errors(mean: Pose2, covariance: Matrix, truth: Pose2) -> tuple[float, float]:
    """Return the squared error of the place, and the squared normalised error of the pose."""
    off = tangent(between(mean, truth))
    return float(off[:2] @ off[:2]), float(off @ np.linalg.solve(covariance, off))


def band(runs: int, dof: int = 3) -> tuple[float, float]:
    """Return where the mean of squared normalised errors of so many independent runs lies in 95 % of all cases."""
    return float(chi2.ppf(0.025, dof * runs)) / runs, float(chi2.ppf(0.975, dof * runs)) / runs


def tables() -> Iterator[Table]:
    """Measure everything and return one table after the other."""
    yield accuracy()
    yield growth()
    yield association()
    yield robustness()
    yield recorded()


# ---------------------------------------------------------------- accuracy and consistency


def accuracy() -> Table:
    """Compare accuracy, consistency and time with the peers' on the same simulated logs."""
    few = [simulated(5, STEPS, seed) for seed in range(SEEDS)]
    vague = [simulated(5, STEPS, seed, BAD_HEADING_SD) for seed in range(SEEDS)]
    many = [simulated(50, STEPS, seed) for seed in range(SEEDS)]
    peers: dict[str, Callable[[Began], Estimator]] = {"factor graph": Smoother, "EKF": Ekf, "UKF (filterpy)": Ukf}
    results = {("5", name): [scored(make, log) for log in few] for name, make in peers.items()}
    results |= {("5, heading vague", name): [scored(make, log) for log in vague] for name, make in peers.items()}
    results |= {("50", name): [scored(peers[name], log) for log in many] for name in ("factor graph", "EKF")}
    short = f"50, {UKF_STEPS} steps"
    results |= {(short, n): [scored(make, log, UKF_STEPS) for log in many[:UKF_SEEDS]] for n, make in peers.items()}
    low, high = band(SEEDS)
    inside = {
        (case, which): low <= float(_nees(results[case, "factor graph"], which).mean()) <= high
        for case in ("5", "5, heading vague", "50")
        for which in ("base", "relative")
    }
    ratio = _ms(results[short, "UKF (filterpy)"]) / _ms(results[short, "factor graph"])
    return Table(
        "Estimator: accuracy and consistency",
        f"{SEEDS} simulated logs of {STEPS} drives and looks each ({UKF_SEEDS} where it says {UKF_STEPS} steps), every "
        "estimator on the same ones. NEES: squared normalised error of a planar pose, 3 if errors are as large as the "
        f"belief says; mean over all steps, and 'last' after the last one. 95 % band {low:.2f} to {high:.2f}, as of "
        "one independent sample a log. "
        "Time: median CPU time of one drive and one look.",
        ("objects", "estimator", "ms", "base RMSE m", "base NEES", "last", "relative RMSE m", "relative NEES", "last"),
        [(case, name, *_figures(scores)) for (case, name), scores in results.items()],
        (
            Target(
                f"mean NEES of base and relative pose within the 95 % band, {SEEDS} seeds each",
                all(inside.values()),
                f"{sum(inside.values())} of {len(inside)} inside",
            ),
            _no_worse(results),
            Target(
                "an update at least 10 times faster than filterpy's UKF at 50 objects", ratio >= 10, f"{ratio:.0f} x"
            ),
        ),
    )


def _no_worse(results: dict[tuple[str, str], list[Score]]) -> Target:
    """Return whether the distance of the mean NEES from 3 exceeds no peer's by more than its standard error."""
    worse = []
    for case, name in results:
        if name != "factor graph" and (case, name) in results:
            for which in ("base", "relative"):
                ours, theirs = (_nees(results[case, n], which) for n in ("factor graph", name))
                margin = 2.0 * float(np.std(ours - theirs, ddof=1)) / math.sqrt(len(ours))
                if abs(ours.mean() - 3.0) > abs(theirs.mean() - 3.0) + margin:
                    worse.append(f"{case} objects, {which}, {name}")
    return Target("NEES no worse than the peers' on the same logs", not worse, "; ".join(worse) or "nowhere worse")


def _nees(scores: Sequence[Score], which: str) -> Array:
    return np.array([getattr(score, which)[:, 1].mean() for score in scores])


def _ms(scores: Sequence[Score]) -> float:
    return float(np.median([score.update_ms for score in scores]))


def _figures(scores: Sequence[Score]) -> list[str]:
    figures = [f"{_ms(scores):.2f}"]
    for which in ("base", "relative"):
        rmse = math.sqrt(float(np.mean([getattr(score, which)[:, 0].mean() for score in scores])))
        last = float(np.mean([getattr(score, which)[-1, 1] for score in scores]))
        figures += [f"{rmse:.4f}", f"{_nees(scores, which).mean():.2f}", f"{last:.2f}"]
    return figures


# ---------------------------------------------------------------- growth


def growth() -> Table:
    """Let one run grow, its past being summed up now and then."""
    log = simulated(LONG_OBJECTS, LONG_STEPS, 0)
    smoother, rows, part = Smoother(log.began), [], LONG_STEPS // 10
    spent, nees, first_mb = [], [], 0.0
    for i, step in enumerate(log.steps, start=1):
        start = time.process_time()
        smoother.take(step.moved)
        smoother.take(step.looked)
        if i % LONG_BLOCK == 0:
            smoother.graph.apply(Consolidated())
        spent.append(time.process_time() - start)
        if i % 20 == 0 and step.looked.sightings:
            nees.append(errors(*smoother.base(), step.world_T_base)[1])
        if i % part == 0:
            factors, first_mb = smoother.graph.smoother.getFactorsUnsafe().nrFactors(), first_mb or _peak_mb()
            ms = 1e3 * np.array(spent)
            rows.append(
                (i, f"{np.median(ms):.1f}", f"{ms.mean():.1f}", factors, f"{_peak_mb():.0f}", f"{np.mean(nees):.2f}")
            )
            spent, nees = [], []
    grown = _peak_mb() - first_mb
    return Table(
        "Estimator: growth",
        f"{LONG_OBJECTS} objects on a ring, {LONG_STEPS} drives with a look each (about five rounds), the past summed "
        f"up every {LONG_BLOCK} drives. Memory is the largest of the process, with the log that is fed to it. Time: "
        "CPU time of a drive, a look and the share of the summing up.",
        ("steps", "median ms", "mean ms", "factors", "peak MB", "base NEES"),
        rows,
        (Target("completes in bounded memory", grown < 0.5 * first_mb, f"+{grown:.0f} MB from {first_mb:.0f} MB"),),
        (
            "Time grows because every round sees the same objects in other groups: the summaries, each of a bounded "
            "number of objects, overlap more and more, and a correction travels farther through them.",
        ),
    )


def _peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


# ---------------------------------------------------------------- association and gross errors


def association() -> Table:
    """Compare pair by pair assignment with joint hypotheses."""
    rows, behind = [], []
    for crowd in CROWDS:
        figures = []
        for hypotheses in (0, EstimatorConfig().hypotheses):
            start = time.process_time()
            right = sum(whole_look_is_right(crowd, seed, hypotheses) for seed in range(LOOK_SEEDS))
            figures += [f"{right / LOOK_SEEDS:.2f}", f"{1e3 * (time.process_time() - start) / LOOK_SEEDS:.0f}"]
        behind += [crowd.name] if float(figures[2]) < float(figures[0]) else []
        rows.append((crowd.name, crowd.cans, *figures))
    return Table(
        "Estimator: association",
        f"Share of {LOOK_SEEDS} first looks at a table of cans in which every reported can is taken for itself, and "
        "the CPU time of the look with everything around it. Joint hypotheses are formed only where a detection could "
        "be of several anchors.",
        ("look", "cans", "pairs alone: right", "ms", "jointly: right", "ms"),
        rows,
        (Target("jointly right at least as often as pair by pair", not behind, "; ".join(behind) or "everywhere"),),
        (
            "Where only some of a regular grid are reported and the base is off by half a spacing, a look may fit as "
            "well when read one place further: what was told does not tell which.",
        ),
    )


def robustness() -> Table:
    """Measure what outliers and false detections do."""
    runs = {
        name: [endured(seed, CANS, LOOKS, CALM, gross) for seed in range(RUN_SEEDS)] for name, gross in ERRORS.items()
    }
    end, way = ({name: _off(found, first) for name, found in runs.items()} for first in (-1, 0))
    ghosts, lost = sum(int(run.strays[-1]) for run in runs[BOTH]), sum(run.lost for run in runs[BOTH])
    by_sight = way[BOTH] / way[LEFT_OUT]
    return Table(
        "Estimator: gross errors",
        f"{RUN_SEEDS} runs of {LOOKS} looks at {CANS} cans told to 3 cm, with drives between, and {CALM} calm looks at "
        "the end. 'Both': one detection in ten is an outlier, and a tenth as many as there are cans are of nothing. "
        "Outliers are 15 to 50 cm off on each axis; they and false detections are in view, on the table. The "
        "noise model counts an outlier as a can not found and a detection of nothing, as a calibration of the detector "
        f"would, except where it says so. '{LEFT_OUT}': the same draws, but somebody leaves the gross detections out, "
        "so what is lost there is lost to anyone. RMSE is of the places of listed cans relative to the base, in mm and "
        "as a multiple of the clean run's, after the last look and over all looks, the first included. Unlisted: "
        "cans that no listed anchor is of, mean over all looks; strays: listed anchors of nothing, in a hundred looks. "
        "Ghosts (strays), duplicates, lost and renamed cans are counted at the end, over all runs.",
        (
            "errors",
            "RMSE at the end",
            "x",
            "on the way",
            "x",
            "unlisted %",
            "strays",
            "ghosts",
            "duplicates",
            "lost",
            "renamed",
        ),
        [
            (
                name,
                f"{1e3 * end[name]:.1f}",
                f"{end[name] / end[CLEAN]:.2f}",
                f"{1e3 * way[name]:.1f}",
                f"{way[name] / way[CLEAN]:.2f}",
                f"{100.0 * float(np.isnan([run.off_m for run in found]).mean()):.1f}",
                f"{100.0 * float(np.mean([run.strays for run in found])):.1f}",
                sum(int(run.strays[-1]) for run in found),
                *(sum(getattr(run, what) for run in found) for what in ("duplicates", "lost", "renamed")),
            )
            for name, found in runs.items()
        ],
        (
            _at_most(1.2, "RMSE at most 1.2 times the clean run's, at the end", end[BOTH] / end[CLEAN]),
            _at_most(1.2, "the same on the way, first looks included", way[BOTH] / way[CLEAN]),
            _at_most(1.2, "RMSE on the way at most 1.2 times that of who leaves gross detections out", by_sight),
            Target("ghosts vanish", ghosts == 0, f"{ghosts} left in {RUN_SEEDS} runs"),
            Target("nothing true is lost", lost == 0, f"{lost} of {CANS * RUN_SEEDS}"),
        ),
        (
            "On the way the error is that of the first looks. A can whose detection is an outlier, or missing, is "
            "still where it was told: that part is lost to anyone. The rest: an outlier or a false detection near the "
            "told place of a can that is not reported in the same look may be taken for it, as before the can was seen "
            "nothing tells the two apart; it then goes on under a new name, and the wrong place is given up after a "
            "few looks.",
        ),
    )


def _at_most(limit: float, text: str, found: float) -> Target:
    return Target(text, found <= limit, f"{found:.2f}")


def _off(runs: Sequence[Endured], first: int) -> float:
    """Return the root mean square of how far off listed cans are, over the looks from `first` on, metres."""
    return math.sqrt(float(np.nanmean([np.square(run.off_m[first:]) for run in runs])))


# ---------------------------------------------------------------- recorded runs


def recorded() -> Table:
    """Measure the belief along runs in PyBullet: tours of drives and looks, and a few whole runs from their traces."""
    setup = prepare(ROOT / "scenarios" / "sim1_green.yaml")
    groups = {"tours of three tables": [touring(setup, seed) for seed in range(SEEDS)]}
    with tempfile.TemporaryDirectory() as folder:
        for scenario, seeds in RECORDED:
            for seed in range(seeds):
                path = Path(folder) / f"{scenario}-{seed}.mcap"
                record(ROOT / "scenarios" / f"{scenario}.yaml", seed, "pybullet", path)
                groups.setdefault(f"whole runs of {scenario}", []).append(along(Trace(path)))
    rows = [_recorded_row(name, runs) for name, runs in groups.items()]
    runs = [run for found in groups.values() for run in found]
    low, high = band(len(runs))
    base = float(np.mean([run.base.mean() for run in runs]))
    relative = float(np.mean([run.relative.mean() for run in runs if len(run.relative)]))
    low2, high2 = band(len(runs), 2)
    return Table(
        "Estimator: runs in PyBullet",
        "The belief fed with what the robot did and saw in PyBullet, rendering and detector included, against the "
        "truth, after every look. Base: over (x, y, theta), 3 is ideal; mean over all looks, 'last' after the last. "
        "Things: places as seen from the base, 2 is ideal. 95 % bands, as of one independent sample a run: "
        f"{low:.2f} to {high:.2f} and {low2:.2f} to {high2:.2f}.",
        ("runs", "number", "base NEES", "last", "things NEES", "things RMSE mm"),
        rows,
        (
            Target("NEES of the base within the 95 % band", low <= base <= high, f"{base:.2f}"),
            Target("NEES of things within the 95 % band", low2 <= relative <= high2, f"{relative:.2f}"),
        ),
    )


def _recorded_row(name: str, runs: Sequence[Errors]) -> tuple[object, ...]:
    things = [run for run in runs if len(run.relative)]
    places = np.concatenate([run.places_m for run in things])
    return (
        name,
        len(runs),
        f"{np.mean([run.base.mean() for run in runs]):.2f}",
        f"{np.mean([run.base[-1] for run in runs]):.2f}",
        f"{np.mean([run.relative.mean() for run in things]):.2f}",
        f"{1e3 * math.sqrt(float(np.square(places).mean())):.1f}",
    )
