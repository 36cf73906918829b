"""Grounding: a circuit becomes a formula about the objects of a universe.

A variable of a circuit stands for each of them in turn. What is near a stranger, or heavier than one, is not known:
such an atom counts as false in the lower bound of the probability and as true in the upper one, or the other way round
under a negation.
"""

from collections.abc import Iterator, Mapping
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
Env = Mapping[str, Individual]  # by the text of the variable


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
        free: The texts of the variables that occur free in it, sorted.
        parts: The plans of the nodes directly inside it.
        terms: The texts of its arguments or, of a quantifier, of its variable.
        earlier: Whether its relations are those at the start.
    """

    node: Node
    number: int
    free: tuple[str, ...]
    parts: tuple["Plan", ...]
    terms: tuple[str, ...]
    earlier: bool


class Grounder:
    """Formulas of circuits in a universe, for one bound of the probability.

    Attributes:
        bounded: Whether a formula depends on what is not known.
    """

    def __init__(self, universe: Universe, bound: Bound) -> None:
        self._universe, self._diagram, self._bound = universe, universe.diagram, bound
        self._plans: dict[tuple[Node, bool], Plan] = {}
        self._done: dict[tuple[object, ...], int] = {}
        self.bounded = False

    def formula(self, node: Node, variable: Term | None = None, one: Individual | None = None) -> int:
        """Return the formula of a node; its variable, if it has one, stands for an object."""
        env = {} if variable is None or one is None else {str(variable): one}
        return self._made(self._plan(node), env, True)

    def _plan(self, node: Node, earlier: bool = False) -> Plan:
        if (node, earlier) not in self._plans:
            inner = tuple(self._plan(part, earlier or isinstance(node, Earlier)) for part in parts(node))
            free = sorted(_free(node, frozenset[str]().union(*(plan.free for plan in inner))))
            terms = tuple(map(str, _terms(node)))
            self._plans[node, earlier] = Plan(node, len(self._plans), tuple(free), inner, terms, earlier)
        return self._plans[node, earlier]

    def _made(self, plan: Plan, env: Env, positive: bool) -> int:
        """Return the formula of a node; `positive`: it stands under an even number of negations."""
        key = (plan.number, positive, *(env.get(variable) for variable in plan.free))
        found = self._done.get(key)
        if found is None:
            found = self._done[key] = self._formula(plan, env, positive)
        return found

    def _formula(self, plan: Plan, env: Env, positive: bool) -> int:
        diagram, inner = self._diagram, plan.parts
        match plan.node:
            case Leaf():
                return self._leaf(plan.node, plan, env, positive)
            case Identical():
                one, other = (self._individual(term, env) for term in plan.terms)
                return self._universe.exists(one) if one is not None and one == other else FALSE
            case Product():
                first = self._made(inner[0], env, positive)
                return FALSE if first == FALSE else diagram.all_of((first, self._made(inner[1], env, positive)))
            case Either():
                return diagram.some_of(self._made(part, env, positive) for part in inner)
            case Complement():
                return diagram.negation(self._made(inner[0], env, not positive))
            case EitherOver():
                return diagram.some_of(self._items(plan, env, positive, 1))
            case Counted(_, _, least, most):
                return self._counted(plan, env, positive, least, most)
            case Renamed():
                variable, meant = plan.terms
                return self._made(inner[0], {**env, variable: env[meant]} if meant in env else env, positive)
            case Earlier():
                return self._made(inner[0], env, positive)

    def _counted(self, plan: Plan, env: Env, positive: bool, least: int, most: int | None) -> int:
        """Return the formula of a number; what is not known may lie on the wrong side of both of its limits."""
        cap = max(least, 0 if most is None else most + 1)
        items = tuple(self._items(plan, env, positive, cap))
        if most is None:
            return self._diagram.number(items, least, None)
        others = tuple(self._items(plan, env, not positive, cap))
        if items == others:
            return self._diagram.number(items, least, most)
        enough = self._diagram.number(items, least, None)
        return self._diagram.all_of((enough, self._diagram.negation(self._diagram.number(others, most + 1, None))))

    def _items(self, plan: Plan, env: Env, positive: bool, cap: int) -> Iterator[int]:
        """Yield for each object the formula that it exists and the node holds; `cap` for each kind of stranger."""
        universe, diagram, (inner,), (variable,) = self._universe, self._diagram, plan.parts, plan.terms
        bound = {env[name] for name in plan.free if name in env}
        named = sorted((one for one in bound if isinstance(one, Stranger)), key=lambda s: (s.region, s.cell, s.index))
        for one in (*universe.objects(), *named):
            exists = universe.exists(one)
            if exists == FALSE:
                continue
            holds = self._made(inner, {**env, variable: one}, positive)
            if holds != FALSE:
                yield diagram.all_of((exists, holds))
        for region, cell in universe.classes() if cap else ():
            taken = {s.index for s in named if (s.region, s.cell) == (region, cell)}
            used, another = len(taken), next(i for i in range(1, len(taken) + 2) if i not in taken)
            holds = self._made(inner, {**env, variable: Stranger(region, cell, another)}, positive)
            if holds != FALSE:
                yield from (diagram.all_of((universe.more_than(region, cell, used + i), holds)) for i in range(cap))

    # ------------------------------------------------------------ atoms

    def _individual(self, term: str, env: Env) -> Individual | None:
        found = env.get(term)
        return self._universe.known(term) if found is None else found

    def _leaf(self, leaf: Leaf, plan: Plan, env: Env, positive: bool) -> int:
        universe, words, relation = self._universe, self._universe.vocabulary, leaf.relation
        terms, was = plan.terms, plan.earlier
        match leaf.args:
            case (_, Compound("number", (int(thousandths),))) if relation in words.exceeds:
                one = self._individual(terms[0], env)
                return FALSE if one is None else universe.has(one, comparison(relation, thousandths))
        objects = [self._individual(term, env) for term in terms]
        found: int | None
        match objects:
            case [one] if relation in words.meanings:
                return FALSE if one is None else universe.has(one, relation)
            case [one, other] if relation == "on":
                return FALSE if one is None or other is None else universe.rests(one, other, was)
            case [one, other] if relation in words.near_m:
                distance_m = words.near_m[relation]
                found = FALSE if one is None or other is None else universe.beside(one, other, distance_m, was)
            case [one, other] if relation == "heavier" or relation in words.exceeds:
                found = FALSE if one is None or other is None else universe.heavier(one, other)
            case [one, other, to] if relation == "nearer":
                found = FALSE if one is None or other is None or to is None else universe.nearer(one, other, to, was)
            case _:
                raise InternalError(f"{Compound(relation, leaf.args)} cannot be evaluated: no such relation")
        if found is not None:
            return found
        self.bounded = True
        if positive != (self._bound == "high"):
            return FALSE
        return self._diagram.all_of(universe.exists(one) for one in objects if one is not None)


def _terms(node: Node) -> tuple[Term, ...]:
    """Return the arguments of a node, or the variables that it binds or renames."""
    match node:
        case Leaf(_, args):
            return args
        case Identical(left, right):
            return (left, right)
        case EitherOver() | Counted():
            return (node.variable,)
        case Renamed():
            return (node.variable, node.meant)
    return ()


def _free(node: Node, inside: frozenset[str]) -> frozenset[str]:
    """Return the texts of the variables that occur free in a node, given those of the nodes inside it."""
    match node:
        case Leaf() | Identical():
            return frozenset(str(term) for term in _terms(node) if isinstance(term, Compound) and term.name == "var")
        case EitherOver() | Counted():
            return inside - {str(node.variable)}
        case Renamed() if str(node.variable) in inside:
            return inside - {str(node.variable)} | {str(node.meant)}
    return inside


def unary_mask(node: Node, variable: Term, universe: Universe) -> int | None:
    """Return the cells of the objects of which a node is true; None if it is about other objects too."""
    whole, vocabulary = universe.cells.present, universe.vocabulary
    match node:
        case Leaf(relation, (one,)) if one == variable and relation in vocabulary.meanings:
            return universe.cells.masks[relation]
        case Leaf(relation, (one, Compound("number", (int(thousandths),)))) if one == variable:
            return universe.cells.masks[comparison(relation, thousandths)]
        case Product(left, right) | Either(left, right):
            masks = [unary_mask(part, variable, universe) for part in (left, right)]
            if masks[0] is None or masks[1] is None:
                return None
            return masks[0] & masks[1] if isinstance(node, Product) else masks[0] | masks[1]
        case Complement(inner):
            mask = unary_mask(inner, variable, universe)
            return None if mask is None else whole & ~mask
        case Earlier(inner):
            return unary_mask(inner, variable, universe)
    return None
