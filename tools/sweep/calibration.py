"""Calibration over runs: how often claims of the belief are true, and how large its errors are.

The estimator gets the recorded observations of each run again. Whenever the probability of a claim changes, it is
compared with the recorded truth of the same step, which the robot never reads.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from skolem.reasoner.planning.denotations import Denotations
from skolem.tools.loop.mind import Mind
from skolem.tools.loop.verdict import Truth
from skolem.tools.recorded.geometry import RecalledGeometry
from skolem.tools.recorded.replaying import given_in
from skolem.tools.recorded.rethinking import Given
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun
from skolem.traces import Trace, messages
from skolem.traces.messages import ObjectType, TrueState
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import compose2, flat, inverse2

Array = NDArray[np.float64]
BINS: Final = 10  # of equal width, over 0..1
SAME_M: Final = 0.15  # an object that the robot found stands for the nearest true one, at most so far away
TABLE_M: Final = 0.40  # the same for a table
CLAIMS: Final = ("exists", "type", "colour word", "weight word", "On", "Den", "ExistsIn")
ERRORS: Final = ("base", "objects", "headings")


@dataclass(slots=True)
class Bin:
    """Claims with probabilities in one interval.

    Attributes:
        claims: Their number.
        promised: Sum of their probabilities.
        hits: How many of them are true.
    """

    claims: int = 0
    promised: float = 0.0
    hits: int = 0


@dataclass(slots=True)
class Errors:
    """Errors of one kind at the ends of runs.

    Attributes:
        nees: Sum of the squared Mahalanobis lengths of the errors (normalised estimation error squared).
        freedom: Sum of their degrees of freedom, by which a right covariance makes it on average.
    """

    nees: float = 0.0
    freedom: int = 0

    def band(self, confidence: float) -> tuple[float, float]:
        """Return the interval that holds the mean NEES of right covariances, for independent errors."""
        tail = (1.0 - confidence) / 2.0
        low, high = chdtri(self.freedom, 1.0 - tail), chdtri(self.freedom, tail)
        return float(low) / self.freedom, float(high) / self.freedom


@dataclass(slots=True)
class Calibration:
    """What claims and errors of some runs say about the belief.

    Attributes:
        claims: The claims of each kind, by probability.
        errors: The errors of each kind.
    """

    claims: dict[str, list[Bin]] = field(
        default_factory=lambda: {kind: [Bin() for _ in range(BINS)] for kind in CLAIMS}
    )
    errors: dict[str, Errors] = field(default_factory=lambda: {kind: Errors() for kind in ERRORS})

    def claim(self, kind: str, p: float, true: bool) -> None:
        """Count one claim."""
        found = self.claims[kind][min(BINS - 1, int(p * BINS))]
        found.claims += 1
        found.promised += p
        found.hits += true

    def error(self, kind: str, off: Sequence[float], covariance: Array) -> None:
        """Count one error: a vector, and its believed covariance."""
        found, vector = self.errors[kind], np.asarray(off, np.float64)
        found.nees += float(vector @ np.linalg.solve(covariance, vector))
        found.freedom += len(vector)

    def ece(self, kind: str) -> float | None:
        """Return the expected calibration error of a kind of claim; None without claims.

        That is the mean distance between promise and share, weighted by the number of claims (Naeini, Cooper and
        Hauskrecht, AAAI 2015).
        """
        total = sum(found.claims for found in self.claims[kind])
        return sum(abs(found.promised - found.hits) for found in self.claims[kind]) / total if total else None


def calibration_of(traces: Iterable[Path]) -> Calibration:
    """Return the calibration over complete runs; a run that was cut short by an error counts up to there.

    Raises:
        InputError: If the rules of a trace are not sound for this version.
        TraceError: If a trace cannot be read.
    """
    found, rulebooks = Calibration(), Rulebooks()
    for path in traces:
        _add(found, path, rulebooks)
    return found


def _add(found: Calibration, path: Path, rulebooks: Rulebooks) -> None:
    run = RecordedRun(path)
    states = {state.step: state for state in Trace(path).of(TrueState)}
    given = given_in(run, rulebooks)
    mind = Mind(given.goal, given.rulebook, given.prior, given.limits, RecalledGeometry())
    judge = _Judge(mind, given, states[min(states)] if states else None)
    claimed: dict[tuple[str, ...], float] = {}
    last: tuple[messages.Belief, TrueState] | None = None
    for recorded in run.steps():
        if (state := states.get(recorded.step)) is not None:
            last = mind.belief.snapshot(recorded.step), state
            for kind, about, p, true in judge.claims(*last):
                if claimed.get((kind, *about)) != p:
                    claimed[kind, *about] = p
                    found.claim(kind, p, true)
        if recorded.action is None or recorded.met is None:
            break
        mind.update(recorded.action, *recorded.met)
    if last is not None:
        _errors(found, *last, judge.meant(*last), given.prior.types)


Claim = tuple[str, tuple[str, ...], float, bool]  # kind, what it is about, probability, whether it is true


class _Judge:
    """Compares what a mind believes with the truth."""

    def __init__(self, mind: Mind, given: Given, first: TrueState | None) -> None:
        self._first = first
        self._mind, self._types = mind, given.prior.types
        self._told = {item.anchor for item in given.prior.objects}
        self._words = given.rulebook.vocabulary.meanings
        self._expressions = tuple(given.goal.expressions)
        self._true = Denotations(given.goal, given.rulebook)

    def meant(self, belief: messages.Belief, state: TrueState) -> dict[str, str]:
        """Return the true object that each anchor stands for; anchors that stand for none are left out.

        An anchor of the prior stands for the true object of its name. Of the anchors that the robot made, the nearest
        to a true object that is left stands for it.
        """
        true = {item.id: item for item in state.objects}
        named = {anchor: anchor for anchor in belief.anchors if anchor in self._told and anchor in true}
        pairs = []
        for anchor in (anchor for anchor in belief.anchors if anchor not in self._told):
            known = belief.objects[anchor]
            graspable = self._types[likeliest(known.type)].graspable
            for name in true.keys() - named.values():
                off = math.dist(known.world_T_object[:3], true[name].world_T_object[:3])
                fits = self._types[true[name].type].graspable == graspable
                if fits and off <= (SAME_M if graspable else TABLE_M):
                    pairs.append((off, anchor, name))
        for _, anchor, name in sorted(pairs):
            if anchor not in named and name not in named.values():
                named[anchor] = name
        return named

    def claims(self, now: messages.Belief, state: TrueState) -> Iterator[Claim]:
        """Yield the claims of the present belief; of types and words the likeliest, of words once they were sensed."""
        belief, truth = self._mind.belief, Truth(state, self._types, self._first)
        meant = self.meant(now, state)
        kinds = {item.id: item.type for item in state.objects}
        for anchor in now.anchors:
            known, name = now.objects[anchor], meant.get(anchor)
            yield "exists", (anchor,), known.exists, name is not None
            for expression in self._expressions:
                p = self._mind.denotations.probability(expression, anchor, belief)
                yield "Den", (expression, anchor), p, name is not None and self._is_meant(expression, name, truth)
            if name is None:
                continue
            kind = likeliest(known.type)
            yield "type", (anchor,), known.type[kind], kinds[name] == kind
            for quantity, sensed in (("colour", known.colour_seen), ("weight", known.weighed)):
                if sensed:
                    words = [word for word, meaning in self._words.items() if meaning.quantity == quantity]
                    p, word = max((belief.prob_property(anchor, self._words[word]), word) for word in words)
                    yield f"{quantity} word", (anchor,), p, truth.prob_property(name, self._words[word]) == 1.0
            if known.support in meant and known.in_hand is None:
                p = belief.prob_on(anchor, known.support)
                yield "On", (anchor, known.support), p, truth.prob_on(name, meant[known.support]) == 1.0
        yield from self._of_regions(state, truth, meant)

    def _of_regions(self, state: TrueState, truth: Truth, meant: Mapping[str, str]) -> Iterator[Claim]:
        """Yield the claims that something meant, and not known yet, is in a region."""
        belief = self._mind.belief
        unknown = {item.id: item.on for item in state.objects if item.id not in meant.values()}
        for region in belief.regions():
            top = meant.get(belief.region_support(region))
            there = [name for name, on in unknown.items() if on == top]
            for expression in self._expressions:
                match = self._mind.denotations.probability_of_new(expression, region, belief)
                true = any(self._is_meant(expression, name, truth) for name in there)
                yield "ExistsIn", (expression, region), belief.prob_exists_in(region, match), true

    def _is_meant(self, expression: str, name: str, truth: Truth) -> bool:
        return self._true.probability(expression, name, truth) == 1.0


def _errors(
    found: Calibration,
    belief: messages.Belief,
    state: TrueState,
    meant: Mapping[str, str],
    types: Mapping[str, ObjectType],
) -> None:
    """Count the errors of the base and of what can be lifted and stands somewhere, each in its own frame."""
    found.error("base", compose2(inverse2(belief.world_T_base), state.world_T_base), _square(belief.base_covariance))
    true = {item.id: item for item in state.objects}
    for anchor, name in sorted(meant.items()):
        known, item = belief.objects[anchor], true[name]
        if item.in_hand is not None or known.in_hand is not None or not types[item.type].graspable:
            continue
        off = compose2(inverse2(flat(known.world_T_object)), flat(item.world_T_object))
        covariance = _square(known.covariance)
        found.error("objects", off[:2], covariance[:2, :2])
        if types[item.type].shape == "box":
            turn = math.remainder(off[2], math.pi)  # a box looks the same after half a turn
            found.error("headings", (turn,), covariance[2:, 2:])


def _square(upper: Sequence[float]) -> Array:
    a, b, c, d, e, f = upper
    return np.array([[a, b, c], [b, d, e], [c, e, f]])
