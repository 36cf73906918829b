"""A goal in one belief: its instantiations, whether it is achieved, and the instantiation closest to it."""

import itertools
import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field

from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.offers import RuleOffers
from skolem.reasoner.planning.patterns import Mutexes, mentions
from skolem.reasoner.planning.queries import DEFAULTS, Queries
from skolem.reasoner.planning.readings import MOST_READINGS, Binding, fitting, likeliest
from skolem.reasoner.planning.regression import Subgoal
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.protocols import BeliefQueries, Geometry
from skolem.reasoner.rulebook.book import ABOUT_DESCRIPTIONS, Rulebook
from skolem.reasoner.terms import Compound, Term, compound, nll, substitute
from skolem.traces.messages import Limits


@dataclass(frozen=True, slots=True)
class Closest:
    """The instantiation of a goal that is closest to being achieved.

    Attributes:
        probability: Product of the probabilities of its fluents.
        anchor: The object of its first belief about a known object; None if there is none.
        conjuncts: P of that object's having each property in the descriptions, by name.
    """

    probability: float = 0.0
    anchor: str | None = None
    conjuncts: dict[str, float] = field(default_factory=dict)


class PosedGoal:
    """A goal in one version of the belief.

    Attributes:
        situation: The truth of fluents.
        offers: The instances that the rules offer.
        instantiations: The goal once for each choice of objects for its variables; of very many, the likeliest.
    """

    def __init__(
        self,
        goal: Goal,
        rulebook: Rulebook,
        denotations: Denotations,
        belief: BeliefQueries,
        geometry: Geometry | None,
        mutexes: Mutexes,
        fruitless_here: Collection[Term] = (),
        limits: Limits = DEFAULTS,
    ) -> None:
        self._goal = goal
        self._belief = belief
        self._denotations = denotations
        self.situation = Situation(
            belief,
            geometry,
            lambda expression, anchor: denotations.probability(expression, anchor, belief),
            lambda expression, region: denotations.probability_of_new(expression, region, belief),
            denotations.meanings,
            fruitless_here,
            lambda phi, at_least: denotations.interval(phi, belief, at_least),
        )
        self._limits = limits
        self._queries = queries = Queries(self.situation, denotations.alternatives, limits, denotations.universe)
        self.offers = RuleOffers(rulebook, self.situation, queries, mutexes)
        self._variables: list[Term] = [compound("var", name) for name in goal.variables]
        self._choices = self._candidates()
        self.instantiations = self._instantiate()

    def achieved(self) -> Subgoal | None:
        """Return the first instantiation whose fluents all hold; None if there is none."""
        return next(self.all_achieved(), None)

    def all_achieved(self) -> Iterator[Subgoal]:
        """Yield every instantiation whose fluents all hold, also those that are too many to plan for."""
        fluents, holds = self._goal.fluents, self.situation.holds
        for binding in fitting(self._variables, self._choices, fluents, holds, _is_geometric):
            yield frozenset(substitute(f, binding) for f in fluents)

    def left_out(self) -> str:
        """Return which objects, regions and readings were not considered, as a continued sentence."""
        return self._implausible() + self._too_many()

    def _implausible(self) -> str:
        names = sorted(self._queries.left_out)
        least = f"below {self._limits.min_plausible:g} (limits.min_plausible)"
        said = f"; not considered, as P that they are or hold what is meant is {least}: {', '.join(names)}"
        return said if names else ""

    def _too_many(self) -> str:
        count = math.prod(map(len, self._choices))
        kept = f"the {MOST_READINGS:,} likeliest were considered"
        return f"; of {count:,} choices of objects for the goal's variables, {kept}" if count > MOST_READINGS else ""

    def holds_all(self, fluents: Subgoal) -> bool:
        """Return whether all fluents hold; geometric fluents are tested last, since they cost most."""
        return all(map(self.situation.holds, sorted(fluents, key=lambda f: (_is_geometric(f), str(f)))))

    def satisfied(self, fluents: Subgoal) -> Iterator[Binding]:
        """Return the bindings of Skolem constants to anchors under which all fluents hold; {} without constants.

        A constant of which it is only said that it differs from others is not bound: nothing says yet what it is.
        """
        constants = sorted({s for f in fluents if not _is_difference(f) for s in _skolems(f)}, key=str)
        choices = [self.situation.anchors()] * len(constants)
        return fitting(constants, choices, fluents, self.situation.holds, _is_geometric, distinct=True)

    def still_false(self, fluents: Subgoal) -> dict[Term, float]:
        """Return the false fluents, each with its degree; nothing if a binding of Skolem constants makes all true."""
        if next(self.satisfied(fluents), None) is not None:
            return {}
        false = [f for f in sorted(fluents, key=str) if _skolems(f) or not self.situation.holds(f)]
        return {f: 0.0 if _skolems(f) else self.situation.degree(f) for f in false}

    def closest(self) -> Closest:
        """Return the instantiation without Skolem constants that is most probable now.

        Among equally probable ones, an object that hands can move comes first, then the likelier denoted one.
        """
        known = [root for root in self.instantiations if not any(mentions(f, "sk") for f in root)]
        anchors = self.situation.anchors()
        if not known:
            return self._nearest(anchors)

        def merit(root: Subgoal) -> tuple[float, bool, float]:
            about = _subject(root, anchors)
            movable = about is not None and self._belief.graspable(about)
            return self._probability(root), movable, self._probability(root, "den")

        best = max(known, key=merit)
        anchor = _subject(best, anchors)
        return Closest(self._probability(best), anchor, {} if anchor is None else self._conjuncts(anchor))

    def _nearest(self, anchors: tuple[str, ...]) -> Closest:
        """Return the object nearest to the descriptions of a goal that has no instantiation with known objects."""
        found = [(conjuncts, anchor) for anchor in anchors if (conjuncts := self._conjuncts(anchor))]
        if not found:
            return Closest()
        conjuncts, anchor = max(found, key=lambda each: nearness(each[0], each[1], self._belief))
        return Closest(0.0, anchor, conjuncts)

    def _probability(self, root: Subgoal, kind: str = "") -> float:
        """Return the product of the probabilities in a conjunction, 0 if any other fluent is false.

        With `kind`, the product is over beliefs of that kind alone.
        """
        if not kind and not all(self.situation.holds(f) for f in root if isinstance(f, Compound) and f.name != "b"):
            return 0.0
        phis = [f.args[0] for f in sorted(root, key=str) if isinstance(f, Compound) and f.name == "b"]
        return math.prod(
            self.situation.probability(phi)
            for phi in phis
            if not kind or (isinstance(phi, Compound) and phi.name == kind)
        )

    def _conjuncts(self, anchor: str) -> dict[str, float]:
        found: dict[str, float] = {}
        for expression in self._goal.expressions:
            found |= self._denotations.conjuncts(expression, anchor, self._belief)
        return found

    def _candidates(self) -> list[list[Term]]:
        """Return the candidates for each variable of the goal, as the rules offer them.

        Anchors come in order of introduction, Skolem constants last; with equal costs the earlier choice is taken.
        """
        facts = [compound("posed", f) for f in self._goal.fluents] + [compound("open", v) for v in self._variables]
        offered = self.offers.ask(facts).get("instance", []) if self._variables else []
        places: dict[Term, int] = {anchor: i for i, anchor in enumerate(self.situation.anchors())}
        return [
            sorted((t for v, t in offered if v == variable), key=lambda t: places.get(t, len(places)))
            for variable in self._variables
        ]

    def _instantiate(self) -> tuple[Subgoal, ...]:
        """Return the goal once for each choice of candidates for its variables; of very many choices, the likeliest."""
        few = math.prod(map(len, self._choices)) <= MOST_READINGS
        costs = [
            [0 if few else self._cost(variable, choice) for choice in choices]
            for variable, choices in zip(self._variables, self._choices, strict=True)
        ]
        chosen = ([self._choices[v][i] for v, i in enumerate(indices)] for indices in likeliest(costs))
        bindings = (dict(zip(self._variables, terms, strict=True)) for terms in chosen)
        return tuple(frozenset(substitute(f, binding) for f in self._goal.fluents) for binding in bindings)

    def _cost(self, variable: Term, choice: Term) -> int:
        """Return the cost, micro-nats, of what the goal says of one variable alone, if the choice is bound to it.

        No belief costs more than one with P = `limits.min_plausible`, as which those about Skolem constants count.
        """
        dearest, cost = nll(self._limits.min_plausible), 0
        for fluent in self._goal.fluents:
            bound = substitute(fluent, {variable: choice})
            if bound == fluent or mentions(bound, "var") or not isinstance(bound, Compound) or bound.name != "b":
                continue
            known = not mentions(bound, "sk")
            cost += min(nll(self.situation.probability(bound.args[0])), dearest) if known else dearest
        return cost


def read_mutexes(rulebook: Rulebook) -> Mutexes:
    """Return the mutexes that the rules state; if other files than `mutex.lp` state some, all files are solved."""
    stating = rulebook.stating(("mutex", 2))
    every = [file.name for file, _ in rulebook.sources if file.name != ABOUT_DESCRIPTIONS]
    files = stating if stating == ("mutex",) else every
    return Mutexes((f, g) for f, g in rulebook.solve([], None, files).atoms.get("mutex", []))


def achieved_by(goal: Goal, rulebook: Rulebook, belief: BeliefQueries) -> str | None:
    """Return the object that makes the goal hold in a belief, "" if the goal names none; None if it does not hold.

    No geometry is needed: a goal is about the world, not about what the robot can do.
    """
    posed = PosedGoal(goal, rulebook, Denotations(goal, rulebook), belief, None, Mutexes([]))
    root = posed.achieved()
    return None if root is None else _subject(root, belief.anchors()) or ""


def all_achieving(goal: Goal, rulebook: Rulebook, belief: BeliefQueries) -> tuple[str, ...]:
    """Return every object that makes the goal hold in a belief, each once; a goal that names none gives `("",)`.

    Of very many ways to make it hold, the first are tried.
    """
    posed = PosedGoal(goal, rulebook, Denotations(goal, rulebook), belief, None, Mutexes([]))
    holding = itertools.islice(posed.all_achieved(), MOST_READINGS)
    return tuple(dict.fromkeys(_subject(root, belief.anchors()) or "" for root in holding))


def nearness(conjuncts: Mapping[str, float], anchor: str, belief: BeliefQueries) -> tuple[bool, float, float]:
    """Return a sort key for how near an object is to the descriptions of a goal.

    Objects that hands can move come first; then counts P of all properties but the least likely, then P of that.

    Args:
        conjuncts: P of every property in the descriptions; there is at least one.
        anchor: The object.
        belief: The belief about it.
    """
    *rest, least = sorted(conjuncts.values(), reverse=True)
    return belief.graspable(anchor), belief.prob_exists(anchor) * math.prod(rest), least


def _is_geometric(fluent: Term) -> bool:
    return isinstance(fluent, Compound) and fluent.name in ("at", "clear", "aside")


def _is_difference(fluent: Term) -> bool:
    return isinstance(fluent, Compound) and fluent.name == "differ"


def _skolems(term: Term) -> set[Term]:
    if not mentions(term, "sk"):
        return set()
    assert isinstance(term, Compound)
    return {term} if term.name == "sk" else {s for a in term.args for s in _skolems(a)}


def _subject(root: Subgoal, anchors: tuple[str, ...]) -> str | None:
    """Return the object of the first fluent, by text, that is a belief about a known object."""
    for fluent in sorted(root, key=str):
        match fluent:
            case Compound("b" | "bn", (phi, *_)) | (Compound("krd") as phi):
                if named := [a for a in _constants(phi) if a in anchors]:
                    return named[0]
    return None


def _constants(phi: Term) -> Iterator[str]:
    """Yield the constants of a statement, in order; also those of statements that it joins."""
    if isinstance(phi, Compound):
        for argument in phi.args:
            if isinstance(argument, str):
                yield argument
            elif phi.name == "together":
                yield from _constants(argument)
