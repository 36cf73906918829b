"""The probability that a description, a sentence or several statements hold, over the possible worlds of a belief.

The answer is an interval: of width 0 where it is exact, and wider where points stand for the poses, where something
about strangers is not known, or where a formula is too large.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.protocols import GroundBeliefs, WorldBeliefs
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.terms import Compound, Term
from skolem.reasoner.worlds.circuits import Circuit, Leaf, Node, Product
from skolem.reasoner.worlds.counting import Counting, TooManyCasesError
from skolem.reasoner.worlds.diagrams import FALSE, Many, Number, Rel
from skolem.reasoner.worlds.grounding import Grounder, compares, names_of, strangers_asked, unary_mask
from skolem.reasoner.worlds.sampling import FIRST, MOST, SHIFTS, arrangements, interval, uniforms
from skolem.reasoner.worlds.universe import Universe
from skolem.traces.errors import InternalError

Array = NDArray[np.float64]
TOO_LARGE: Final = "it depends on too many combinations of objects"
STRANGERS: Final = "what is near objects that nobody has met, or weighs more than they do, is not known"


@dataclass(frozen=True, slots=True)
class Interval:
    """A probability between two bounds.

    Attributes:
        low: Lower bound.
        high: Upper bound; the same if the answer is exact.
        points: Number of sampled points; 0 if none were needed. The bounds hold at `sampling.LEVEL` then.
        reason: Why the bounds are apart, if it is not for the points.
    """

    low: float
    high: float
    points: int = 0
    reason: str | None = None

    @property
    def middle(self) -> float:
        """The middle of the interval."""
        return (self.low + self.high) / 2.0

    def decides(self, p: float) -> bool:
        """Return whether the probability is at least `p`, or less, whatever it is within the bounds."""
        return self.low >= p or self.high < p


@dataclass(frozen=True, slots=True)
class Claim:
    """What is to hold in a world: nodes of which each variable stands for an anchor.

    Attributes:
        parts: Each node, its variable and its anchor; a node without a variable has none, and the anchor must exist.
    """

    parts: tuple[tuple[Node, Term | None, str | None], ...]


class Evaluator:
    """The probabilities of descriptions and statements; each is computed once in a version of the belief."""

    def __init__(self, circuits: Mapping[str, Circuit], vocabulary: Vocabulary, key: str) -> None:
        """Begin.

        Args:
            circuits: The descriptions and sentences, by constant.
            vocabulary: The words.
            key: The text that determines the sampled points: that of the goal.
        """
        self._circuits, self._vocabulary, self._key = circuits, vocabulary, key
        self._belief: GroundBeliefs | None = None  # that of the tables, in that version
        self._version = 0
        self._tables: dict[tuple[str, bool], Mapping[str, Interval]] = {}
        self._claims: dict[tuple[tuple[Term, ...], bool], Interval] = {}

    # ------------------------------------------------------------ questions

    def table(self, expression: str, belief: GroundBeliefs, strangers: bool = True) -> Mapping[str, Interval]:
        """Return P(Den) of a description for every anchor, with at most `sampling.FIRST` points.

        Args:
            expression: The constant of the description.
            belief: The belief.
            strangers: Whether there may be objects that nobody has met; otherwise the known ones are all.
        """
        self._renew(belief)
        if (expression, strangers) not in self._tables:
            circuit = self._circuits[expression]
            anchors = belief.anchors()
            claims = [Claim(((circuit.root, circuit.variable, anchor),)) for anchor in anchors]
            found = self._intervals(claims, belief, strangers, None)
            self._tables[expression, strangers] = dict(zip(anchors, found, strict=True))
        return self._tables[expression, strangers]

    def probability(
        self, expression: str, anchor: str, belief: GroundBeliefs, at_least: float | None = None, strangers: bool = True
    ) -> Interval:
        """Return P(Den) of a description for one anchor; 0 for an unknown one.

        Args:
            expression: The constant of the description.
            anchor: The anchor.
            belief: The belief.
            at_least: The probability that decides; points are added until it is decided. None: any answer will do.
            strangers: As for `table`.
        """
        first = self.table(expression, belief, strangers).get(anchor, Interval(0.0, 0.0))
        if at_least is None or first.decides(at_least) or not first.points:
            return first
        return self.together((Compound("den", (expression, anchor)),), belief, at_least, strangers)

    def sentence(
        self, name: str, belief: GroundBeliefs, at_least: float | None = None, strangers: bool = True
    ) -> Interval:
        """Return the probability that a sentence holds; the arguments are those of `probability`."""
        return self.together((Compound("holds_of_the_world", (name,)),), belief, at_least, strangers)

    def together(
        self,
        phis: Sequence[Term],
        belief: GroundBeliefs,
        at_least: float | None = None,
        strangers: bool = True,
    ) -> Interval:
        """Return the probability that several ground statements hold in one world.

        Args:
            phis: den(E, o), holds((K, ..), o), prop(K, o), holds_of_the_world(S), and atoms such as on(o, s).
            belief: The belief.
            at_least: As for `probability`.
            strangers: As for `table`.

        Raises:
            InternalError: If a statement is of another form.
        """
        self._renew(belief)
        key = tuple(phis), strangers
        before = self._claims.get(key)
        if before is None or (at_least is not None and before.points and not before.decides(at_least)):
            (self._claims[key],) = self._intervals([self._claim(phis)], belief, strangers, at_least)
        return self._claims[key]

    # ------------------------------------------------------------ what is asked

    def _renew(self, belief: GroundBeliefs) -> None:
        if self._belief is not belief or self._version != belief.version:
            self._belief, self._version, self._tables, self._claims = belief, belief.version, {}, {}

    def _claim(self, phis: Sequence[Term]) -> Claim:
        return Claim(tuple(self._part(phi) for phi in phis))

    def _part(self, phi: Term) -> tuple[Node, Term | None, str | None]:
        match phi:
            case Compound("den", (str(expression), str(anchor))):
                circuit = self._circuits[expression]
                return circuit.root, circuit.variable, anchor
            case Compound("holds_of_the_world", (str(name),)):
                return self._circuits[name].root, None, None
            case Compound("prop", (str(word), str(anchor))):
                return Leaf(word, (anchor,)), None, None
            case Compound("holds", (Compound("", words), str(anchor))):
                leaves: list[Node] = [Leaf(str(word), (anchor,)) for word in words]
                return reduce(Product, leaves), None, None
            case Compound(relation, args):
                return Leaf(relation, args), None, None
        raise InternalError(f"{phi} is no statement about the world")

    # ------------------------------------------------------------ the answer

    def _intervals(
        self, claims: Sequence[Claim], belief: GroundBeliefs, strangers: bool, at_least: float | None
    ) -> list[Interval]:
        """Return the interval of each claim; `at_least` is for a single one."""
        nodes = list(dict.fromkeys(node for claim in claims for node, _, _ in claim.parts))
        meanings = {name: m for node in nodes for name, m in names_of(node, self._vocabulary).items()}
        most = sum(strangers_asked(node) for node in nodes)
        compared = any(compares(node, self._vocabulary) for node in nodes)
        universe = Universe(belief, self._vocabulary, meanings, most, strangers, compared)
        exact = [_unary(claim, universe) for claim in claims]
        if None not in exact:
            return [Interval(p, p) for p in exact if p is not None]
        lows, highs = _formulas(claims, universe)
        values = _Values(universe, belief, self._key)
        return [values.interval(low, high, at_least) for low, high in zip(lows, highs, strict=True)]


def _unary(claim: Claim, universe: Universe) -> float | None:
    """Return the probability of a claim about the properties of one known object; None for any other claim."""
    match claim.parts:
        case ((node, variable, anchor),) if variable is not None and anchor is not None and not universe.compared:
            mask = unary_mask(node, variable, universe)
            return None if mask is None else universe.share(anchor, mask)
    return None


def _formulas(claims: Sequence[Claim], universe: Universe) -> tuple[list[int], list[int]]:
    """Return the formulas for the lower and for the upper bound of each claim."""
    low = Grounder(universe, "low")
    lows = [_formula(claim, universe, low) for claim in claims]
    if not low.bounded:
        return lows, lows
    high = Grounder(universe, "high")
    return lows, [_formula(claim, universe, high) for claim in claims]


def _formula(claim: Claim, universe: Universe, grounder: Grounder) -> int:
    found = []
    for node, variable, anchor in claim.parts:
        one = None if anchor is None else universe.known(anchor)
        if anchor is not None and one is None:
            return FALSE
        found += [grounder.formula(node, variable, one)] + ([] if one is None else [universe.exists(one)])
    return universe.diagram.all_of(found)


class _Values:
    """Intervals of the formulas of a universe; formulas share the points."""

    def __init__(self, universe: Universe, belief: GroundBeliefs, key: str) -> None:
        self._universe, self._belief, self._key = universe, belief, key
        self._exact = Counting(universe.diagram)
        self._sampled: _Sample | None = None

    def interval(self, low: int, high: int, at_least: float | None) -> Interval:
        """Return the interval from the bound of one formula to that of another, which is implied by it."""
        reason = STRANGERS if low != high else None
        try:
            if not (self._universe.diagram.relational[low] or self._universe.diagram.relational[high]):
                bounds = [float(self._exact.probability(formula)) for formula in dict.fromkeys((low, high))]
                return Interval(bounds[0], max(bounds), 0, reason)
            return self._with_relations(low, high, reason, at_least)
        except TooManyCasesError:
            return Interval(0.0, 1.0, 0, TOO_LARGE)

    def _with_relations(self, low: int, high: int, reason: str | None, at_least: float | None) -> Interval:
        used = sorted({*self._relations(low), *self._relations(high)})
        if len(used) == 1 and (p := self._universe.chance(used[0])) is not None:
            rows = np.zeros((2, len(self._universe.uncertain)), dtype=np.bool_)
            rows[0, used[0]] = True
            counting = Counting(self._universe.diagram, rows)
            bounds = [float(_each(counting.probability(f), 2) @ (p, 1.0 - p)) for f in dict.fromkeys((low, high))]
            return Interval(bounds[0], max(bounds), 0, reason)
        sample = self._sample(used, at_least)
        while True:
            found = sample.interval(low, high, reason)
            if at_least is None or found.decides(at_least) or not sample.double():
                return found

    def _sample(self, used: Sequence[int], at_least: float | None) -> "_Sample":
        """Return the points; those for a single decision are over its own relations alone."""
        if at_least is not None:
            return _Sample(self._universe, self._belief, self._key, used)
        if self._sampled is None:
            every = range(len(self._universe.uncertain))
            self._sampled = _Sample(self._universe, self._belief, self._key, every)
        return self._sampled

    def _relations(self, formula: int) -> set[int]:
        diagram, found, seen, waiting = self._universe.diagram, set[int](), set[int](), [formula]
        while waiting:
            item = waiting.pop()
            if item in seen or not diagram.relational[item]:
                continue
            seen.add(item)
            match diagram.formulas[item]:
                case Rel(index, _):
                    found.add(index)
                case Many(_, items) | Number(items, _, _, _):
                    waiting += items
        return found


class _Sample:
    """Arrangements of the poses at points, with the sums of what formulas are worth in them."""

    def __init__(self, universe: Universe, belief: GroundBeliefs, key: str, used: Sequence[int]) -> None:
        assert isinstance(belief, WorldBeliefs), "only such beliefs have relations that depend on poses"
        self._universe, self._key, self._used = universe, key, list(used)
        self._model = belief.relations([universe.uncertain[index].message for index in used])
        self._points = 0  # of each shift
        self._blocks: list[tuple[int, Counting, NDArray[np.intp]]] = []
        self.double()

    def double(self) -> bool:
        """Take as many points again, or the first ones; return whether the limit allowed it."""
        stop = FIRST // SHIFTS if self._points == 0 else 2 * self._points
        if stop * SHIFTS > MOST:
            return False
        truth = self._model.truth(uniforms(self._key, max(1, self._model.dimension), self._points, stop))
        rows, number = arrangements(truth)
        whole = np.zeros((len(rows), len(self._universe.uncertain)), dtype=np.bool_)
        whole[:, self._used] = rows
        block = stop - self._points
        self._blocks.append((block, Counting(self._universe.diagram, whole), number))
        self._points = stop
        return True

    def interval(self, low: int, high: int, reason: str | None) -> Interval:
        """Return the interval from the lower bound of one formula to the upper bound of another."""
        bounds = [interval(self._estimates(formula), self._points * SHIFTS) for formula in dict.fromkeys((low, high))]
        return Interval(bounds[0][0], bounds[-1][1], self._points * SHIFTS, reason)

    def _estimates(self, formula: int) -> Array:
        """Return the mean of a formula's value over the points of each shift, shape (SHIFTS,)."""
        total = np.zeros(SHIFTS)
        for size, counting, number in self._blocks:
            values = _each(counting.probability(formula), counting.arrangements)[number]
            total += values.reshape(SHIFTS, size).sum(axis=1)
        return total / self._points


def _each(value: float | Array, count: int) -> Array:
    return np.broadcast_to(np.asarray(value, dtype=np.float64), (count,))
