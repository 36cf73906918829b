"""Scores of estimators: errors, errors relative to the believed covariance, and paired comparisons."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from benchmarks.tables import Target
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Began, Event
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.se2 import Matrix, between, log as tangent
from skolem.traces.messages import Pose2

Array = NDArray[np.float64]
SQUARE_M2, NEES, AXES = 0, 1, slice(2, 5)  # columns of the rows of `errors`
WORSE_SES = 2.0  # a worse estimator is worse by more than so many standard errors of the mean difference


class Smoother:
    """The product's pose graph, behind the interface of the peers."""

    def __init__(self, began: Began) -> None:
        self.graph = PoseGraph(EstimatorConfig())
        self.graph.apply(began)

    def take(self, event: Event) -> None:
        """Take in one event."""
        self.graph.apply(event)

    def base(self) -> tuple[Pose2, Matrix]:
        """Return world_T_base and its covariance, base frame."""
        joint = self.graph.joint((BASE,))
        return joint.world_T_body[0], joint.covariance

    def relative(self, anchor: str) -> tuple[Pose2, Matrix]:
        """Return base_T_object and its covariance, object frame."""
        return self.graph.relative(BASE, anchor)


def errors(mean: Pose2, covariance: Matrix, truth: Pose2) -> tuple[float, ...]:
    """Return five squares: the position error in m^2, the normalised error of the pose, and the one along each axis."""
    off = tangent(between(mean, truth))
    axes = np.square(off) / np.diag(covariance)
    return (float(off[:2] @ off[:2]), float(off @ np.linalg.solve(covariance, off)), *(float(v) for v in axes))


def band(runs: int, dof: int = 3) -> tuple[float, float]:
    """Return the 95 % interval of the mean squared normalised error over independent runs of a consistent estimator."""
    return float(chi2.ppf(0.025, dof * runs)) / runs, float(chi2.ppf(0.975, dof * runs)) / runs


@dataclass(frozen=True, slots=True)
class Comparison:
    """Our mean NEES beside a peer's, on the same runs.

    Attributes:
        what: The quantity and the peer.
        ours, theirs: Means over the runs.
        ideal: The ideal value of both.
        error: Standard error of the mean of the paired differences.
    """

    what: str
    ours: float
    theirs: float
    ideal: float
    error: float

    @property
    def is_worse(self) -> bool:
        """Whether ours is farther from the ideal by more than `WORSE_SES` standard errors."""
        return abs(self.ours - self.ideal) > abs(self.theirs - self.ideal) + WORSE_SES * self.error

    def __str__(self) -> str:
        return f"{self.what}: {self.ours:.2f} beside {self.theirs:.2f}, +- {self.error:.2f}"


def compared(what: str, ours: Array, theirs: Array, ideal: float) -> Comparison:
    """Return the comparison of two arrays with the mean NEES of each run, shapes (n,)."""
    error = float(np.std(ours - theirs, ddof=1)) / math.sqrt(len(ours))
    return Comparison(what, float(ours.mean()), float(theirs.mean()), ideal, error)


def no_worse(comparisons: Sequence[Comparison]) -> Target:
    """Return the target that no peer is nearer to the ideal."""
    worse = [comparison for comparison in comparisons if comparison.is_worse]
    text = "NEES no farther from ideal than a peer's on the same logs, by more than two standard errors"
    return Target(text, not worse, "; ".join(map(str, worse)) or "nowhere worse")


def why_worse(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield a paragraph about each comparison in which a peer is nearer to the ideal."""
    for comparison in comparisons:
        if comparison.is_worse:
            side, sure = ("below", "less") if comparison.ours < comparison.ideal else ("above", "more")
            yield (
                f"{comparison}; below ideal the belief claims less than it knows, above it more: ours is {side}, it "
                f"claims {sure}. Both take in the same drives and sightings with the same noise, so the difference is "
                "that of where they linearise and, in runs, of things met anew, which only ours takes in."
            )


def rms(squares: Array) -> float:
    """Return the root of the mean of squares."""
    return math.sqrt(float(squares.mean()))


def why_outside(what: str, found: float, inside: tuple[float, float], peers: dict[str, float], axes: Array) -> str:
    """Return a paragraph about a mean NEES that is outside its band.

    Args:
        what: The quantity.
        found: The mean.
        inside: The band.
        peers: Means of the peers on the same logs.
        axes: Squared normalised errors along each axis, shape (n, 1) of a heading, (n, 2) of a position or (n, 3).
    """
    low, high = inside
    names = {1: ("in heading",), 2: ("along x", "along y"), 3: ("along x", "along y", "in heading")}[axes.shape[1]]
    along = ", ".join(f"{value:.2f} {name}" for value, name in zip(axes.mean(axis=0), names, strict=True))
    size = "larger" if found > high else "smaller"
    text = f"Outside the band: {what}, {found:.2f}. Errors are {size} than the belief says; 1 being ideal, {along}."
    if not peers:
        return text
    theirs = ", ".join(f"{name} {value:.2f}" for name, value in peers.items())
    same = all(value > high if found > high else value < low for value in peers.values())
    cause = (
        "They miss it on the same side, so what they share is off, the models of the errors or the draws, and not how "
        "these are summed up."
        if same
        else "Not all of them miss it on the same side, so it is not the models of the errors alone."
    )
    return f"{text} On the same logs: {theirs}. {cause}"


def means(runs: Sequence[Array], column: int) -> Array:
    """Return the mean of one column in each run that has rows, shape (n,)."""
    return np.array([run[:, column].mean() for run in runs if len(run)])
