"""Grounding: a circuit becomes a formula about the objects of a universe.

A variable of a circuit stands for each of them in turn. What is near a stranger, or heavier than one, is not known:
such an atom counts as false in the lower bound of the probability and as true in the upper one, or the other way round
under a negation.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from skolem.reasoner.rulebook.vocabulary import Vocabulary, comparison
from skolem.reasoner.terms import Compound, Term
from skolem.reasoner.worlds.circuits import (
    Complement,
    Counted,
    Earlier,
    Either,
    EitherOver,
    Identical,
    Leaf,
    Node,
    Product,
    Renamed,
    parts,
)
from skolem.reasoner.worlds.diagrams import FALSE
from skolem.reasoner.worlds.universe import Individual, Stranger, Universe
from skolem.traces.errors import InternalError
from skolem.traces.messages import Meaning

Bound = Literal["low", "high"]
Env = Mapping[Term, Individual]


def strangers_asked(node: Node) -> int:
    """Return the greatest number of strangers of one kind that a circuit may speak of at once."""
    inner = max((strangers_asked(part) for part in parts(node)), default=0)
    match node:
        case EitherOver():
            return inner + 1
        case Counted(_, _, least, most):
            return inner + max(least, 1 if most is None else most + 1)
    return inner


def names_of(node: Node, vocabulary: Vocabulary) -> dict[str, Meaning]:
    """Return the properties that a circuit mentions, comparisons with numbers among them, by name."""
    found: dict[str, Meaning] = {}
    for part in parts(node):
        found |= names_of(part, vocabulary)
    match node:
        case Leaf(relation, (_,)) if relation in vocabulary.meanings:
            found[relation] = vocabulary.meanings[relation]
        case Leaf(relation, (_, Compound("number", (int(thousandths),)))) if relation in vocabulary.exceeds:
            found[comparison(relation, thousandths)] = vocabulary.exceeding(relation, thousandths)
    return found


def compares(node: Node, vocabulary: Vocabulary) -> bool:
    """Return whether a circuit compares the weights of two objects."""
    match node:
        case Leaf("heavier", _):
            return True
        case Leaf(relation, (_, other)) if relation in vocabulary.exceeds:
            return not (isinstance(other, Compound) and other.name == "number")
    return any(compares(part, vocabulary) for part in parts(node))


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A node with what is worked out of it once.

    Attributes:
        node: The node.
        number: Its number; equal nodes have equal numbers.
        free: The variables that occur free in it.
        parts: The plans of the nodes directly inside it.
    """

    node: Node
    number: int
    free: frozenset[Term]
    parts: tuple["Plan", ...]


class Grounder:
    """Formulas of circuits in a universe, for one bound of the probability."""

    def __init__(self, universe: Universe, bound: Bound) -> None:
        self._universe, self._diagram, self._bound = universe, universe.diagram, bound
        self._plans: dict[Node, Plan] = {}
        self._done: dict[tuple[int, bool, tuple[Individual, ...]], int] = {}

    def formula(self, node: Node, env: Env) -> int:
        """Return the formula of a node whose variables stand for individuals."""
        return self._made(self._plan(node), env, True)

    def _plan(self, node: Node) -> Plan:
        if node not in self._plans:
            inner = tuple(map(self._plan, parts(node)))
            free = _free(node, frozenset[Term]().union(*(plan.free for plan in inner)))
            self._plans[node] = Plan(node, len(self._plans), free, inner)
        return self._plans[node]

    def _made(self, plan: Plan, env: Env, positive: bool) -> int:
        """Return the formula of a node; `positive`: it stands under an even number of negations."""
        own = {variable: one for variable, one in env.items() if variable in plan.free}
        key = (plan.number, positive, tuple(own[variable] for variable in sorted(own, key=str)))
        if key not in self._done:
            self._done[key] = self._formula(plan, own, positive)
        return self._done[key]

    def _formula(self, plan: Plan, env: Env, positive: bool) -> int:
        diagram, inner = self._diagram, plan.parts
        match plan.node:
            case Leaf(relation, args):
                return self._leaf(relation, args, env, positive)
            case Identical(left, right):
                one, other = self._individual(left, env), self._individual(right, env)
                return self._universe.exists(one) if one is not None and one == other else FALSE
            case Product():
                return diagram.all_of(self._made(part, env, positive) for part in inner)
            case Either():
                return diagram.some_of(self._made(part, env, positive) for part in inner)
            case Complement():
                return diagram.negation(self._made(inner[0], env, not positive))
            case EitherOver(variable, _):
                return diagram.some_of(self._items(variable, inner[0], env, positive, 1))
            case Counted(variable, _, least, most):
                return self._counted(variable, inner[0], env, positive, least, most)
            case Renamed(variable, meant, _):
                return self._made(inner[0], {**env, variable: env[meant]} if meant in env else env, positive)
            case Earlier():
                raise InternalError("Was(..) needs the belief about the first moment, which no belief offers yet")

    def _counted(self, variable: Term, inner: Plan, env: Env, positive: bool, least: int, most: int | None) -> int:
        """Return the formula of a number; what is not known may lie on the wrong side of both of its limits."""
        cap = max(least, 0 if most is None else most + 1)
        items = tuple(self._items(variable, inner, env, positive, cap))
        if most is None:
            return self._diagram.number(items, least, None)
        others = tuple(self._items(variable, inner, env, not positive, cap))
        if items == others:
            return self._diagram.number(items, least, most)
        enough = self._diagram.number(items, least, None)
        return self._diagram.all_of((enough, self._diagram.negation(self._diagram.number(others, most + 1, None))))

    def _items(self, variable: Term, inner: Plan, env: Env, positive: bool, cap: int) -> Iterator[int]:
        """Yield for each object the formula that it exists and the node holds; `cap` for each kind of stranger."""
        universe, diagram = self._universe, self._diagram
        named = sorted(
            {one for one in env.values() if isinstance(one, Stranger)}, key=lambda s: (s.region, s.cell, s.index)
        )
        for one in (*universe.objects(), *named):
            exists = universe.exists(one)
            if exists != FALSE:
                yield diagram.all_of((exists, self._made(inner, {**env, variable: one}, positive)))
        for region, cell in universe.classes() if cap else ():
            used = sum(s.region == region and s.cell == cell for s in named)
            holds = self._made(inner, {**env, variable: Stranger(region, cell, used + 1)}, positive)
            if holds != FALSE:
                yield from (diagram.all_of((universe.more_than(region, cell, used + i), holds)) for i in range(cap))

    # ------------------------------------------------------------ atoms

    def _individual(self, term: Term, env: Env) -> Individual | None:
        return env[term] if term in env else self._universe.known(term)

    def _leaf(self, relation: str, args: Sequence[Term], env: Env, positive: bool) -> int:
        universe, words = self._universe, self._universe.vocabulary
        match args:
            case (term, Compound("number", (int(thousandths),))) if relation in words.exceeds:
                one = self._individual(term, env)
                return FALSE if one is None else universe.has(one, comparison(relation, thousandths))
        objects = [self._individual(arg, env) for arg in args]
        found: int | None
        match objects:
            case [one] if relation in words.meanings:
                return FALSE if one is None else universe.has(one, relation)
            case [one, other] if relation == "on":
                return FALSE if one is None or other is None else universe.rests(one, other)
            case [one, other] if relation in words.near_m:
                found = FALSE if one is None or other is None else universe.beside(one, other, words.near_m[relation])
            case [one, other] if relation == "heavier" or relation in words.exceeds:
                found = FALSE if one is None or other is None else universe.heavier(one, other)
            case [one, other, to] if relation == "nearer":
                found = FALSE if one is None or other is None or to is None else universe.nearer(one, other, to)
            case _:
                raise InternalError(f"{Compound(relation, tuple(args))} cannot be evaluated: no such relation")
        if found is not None:
            return found
        if positive != (self._bound == "high"):
            return FALSE
        return self._diagram.all_of(universe.exists(one) for one in objects if one is not None)


def _free(node: Node, inside: frozenset[Term]) -> frozenset[Term]:
    """Return the variables that occur free in a node, given those of the nodes inside it."""
    match node:
        case Leaf(_, args):
            return frozenset(arg for arg in args if _is_variable(arg))
        case Identical(left, right):
            return frozenset(arg for arg in (left, right) if _is_variable(arg))
        case EitherOver() | Counted():
            return inside - {node.variable}
        case Renamed(variable, meant, _) if variable in inside:
            return inside - {variable} | {meant}
    return inside


def _is_variable(term: Term) -> bool:
    return isinstance(term, Compound) and term.name == "var"
