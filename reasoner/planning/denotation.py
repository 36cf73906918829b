"""Denotation as the paper computes it: the circuit of a description, evaluated on a belief.

The rules state the circuit of each subexpression; this module computes it (section "Denoting objects"):
b(R(c)) for an atom, the product for And, a + b - ab for Or, and Or over all known objects for Exists.

Existence: b(R(c)) is the probability given that c exists. Each object that a variable stands for is weighted once:
Den(lambda x. e, c) is P(c exists) times the value of e, and `exists y. e` is Or over all c of P(c exists) times e.
"""

from functools import cached_property
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.protocols import EarlierBeliefs, GroundBeliefs, OpenBeliefs
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.terms import Compound, Term
from skolem.reasoner.worlds.circuits import Circuit, Either, EitherOver, Leaf, Node, Product
from skolem.traces.errors import InternalError
from skolem.traces.messages import Meaning

STRANGER: Final = "_new0_"  # an object that is not met yet


def evaluate(circuit: Circuit, belief: GroundBeliefs, vocabulary: Vocabulary) -> dict[str, float]:
    """Return P(Den) of the description for every known anchor, in the belief's order."""
    beliefs = _Beliefs(belief, vocabulary)
    values = _value(circuit.root, ((circuit.variable, beliefs.anchors),), beliefs)
    return dict(zip(beliefs.anchors, map(float, values * beliefs.exist), strict=True))


def evaluate_at(anchor: str, circuit: Circuit, belief: GroundBeliefs, vocabulary: Vocabulary) -> float:
    """Return P(Den) of the description for one known anchor."""
    value = _value(circuit.root, ((circuit.variable, (anchor,)),), _Beliefs(belief, vocabulary))
    return float(value[0]) * belief.prob_exists(anchor)


class _Beliefs:
    """Beliefs in ground relations over the anchors; the belief is asked once for each."""

    def __init__(self, belief: GroundBeliefs, vocabulary: Vocabulary) -> None:
        self._belief, self._vocabulary = belief, vocabulary
        self._memo: dict[tuple[str, tuple[Term, ...]], float] = {}
        self.anchors = belief.anchors()
        self._known = frozenset(self.anchors)

    @cached_property
    def exist(self) -> NDArray[np.float64]:
        """P(exists) of each anchor, shape (n,)."""
        return np.array([self._belief.prob_exists(anchor) for anchor in self.anchors], dtype=np.float64)

    def ground(self, relation: str, args: tuple[Term, ...]) -> float:
        """Return b(R(c1, .., cn)); 0 for an unknown anchor.

        Raises:
            InternalError: If the vocabulary has no such relation.
        """
        key = relation, args
        if key not in self._memo:
            self._memo[key] = self._ask(relation, args)
        return self._memo[key]

    def _ask(self, relation: str, args: tuple[Term, ...]) -> float:
        words = self._vocabulary
        known = self._known.issuperset(a for a in args if isinstance(a, str))
        match args:
            case (str(anchor),) if relation in words.meanings:
                return self._belief.prob_property(anchor, words.meanings[relation]) if known else 0.0
            case (str(anchor), str(support)) if relation == "on":
                return self._belief.prob_on(anchor, support) if known else 0.0
            case (str(anchor), str(other)) if relation in words.near_m:
                return self._belief.prob_near(anchor, other, words.near_m[relation]) if known else 0.0
            case (str(anchor), Compound("number", (int(thousandths),))) if relation in words.exceeds:
                above = words.exceeding(relation, thousandths)
                return self._belief.prob_property(anchor, above) if known else 0.0
        raise InternalError(f"{Compound(relation, args)} cannot be evaluated: no such relation of such arguments")


_Axes = tuple[tuple[Term, tuple[str, ...]], ...]  # variables, each with the anchors it ranges over


def _value(node: Node, axes: _Axes, beliefs: _Beliefs) -> NDArray[np.float64]:
    """Return the value of a node with one axis per variable in `axes`, of length 1 if independent of the variable."""
    match node:
        case Leaf():
            return _leaf(node, axes, beliefs)
        case Product(left, right):
            return _value(left, axes, beliefs) * _value(right, axes, beliefs)
        case Either(left, right):
            a, b = _value(left, axes, beliefs), _value(right, axes, beliefs)
            return a + b - a * b
        case EitherOver(variable, inner):
            some: NDArray[np.float64] = (
                1.0 - _value(inner, (*axes, (variable, beliefs.anchors)), beliefs) * beliefs.exist
            )
            none: NDArray[np.float64] = np.prod(some, axis=-1)
            return 1.0 - none
    raise InternalError(f"{type(node).__name__} is beyond the paper: only the evaluation by possible worlds values it")


def _leaf(leaf: Leaf, axes: _Axes, beliefs: _Beliefs) -> NDArray[np.float64]:
    """Return b(R(..)) for every choice of anchors for the variables of an atom."""
    used = [variable for variable, _ in axes if variable in leaf.args]
    shape = tuple(len(anchors) if variable in used else 1 for variable, anchors in axes)
    places = [used.index(arg) if arg in used else None for arg in leaf.args]
    values = [
        beliefs.ground(
            leaf.relation,
            tuple(arg if i is None else chosen[i] for i, arg in zip(places, leaf.args, strict=True)),
        )
        for chosen in product(*(anchors for variable, anchors in axes if variable in used))
    ]
    return np.array(values, dtype=np.float64).reshape(shape)


class WithStranger:
    """A belief with one more object: it lies in a given region and has the priors of an arbitrary object."""

    def __init__(self, belief: OpenBeliefs, region: str) -> None:
        self._belief, self._region = belief, region

    @property
    def version(self) -> int:
        """Version of the belief."""
        return self._belief.version

    def anchors(self) -> tuple[str, ...]:
        """The known anchors and the stranger."""
        return (*self._belief.anchors(), STRANGER)

    def prob_exists(self, anchor: str) -> float:
        """P(the object exists); 1 for the stranger, since its existence is given."""
        return 1.0 if anchor == STRANGER else self._belief.prob_exists(anchor)

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """P(the object has the property); for the stranger, the prior of an arbitrary object."""
        if anchor == STRANGER:
            return self._belief.prob_property_of_new(meaning)
        return self._belief.prob_property(anchor, meaning)

    def prob_on(self, anchor: str, support: str) -> float:
        """P(the object rests on the support); the stranger rests on that of its region."""
        if anchor == STRANGER:
            return float(support == self._belief.region_support(self._region))
        return 0.0 if support == STRANGER else self._belief.prob_on(anchor, support)

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """P(the objects are near); for the stranger, P(the other is in its region), where it may be near."""
        if STRANGER not in (anchor, other):
            return self._belief.prob_near(anchor, other, distance_m)
        if anchor == other:
            return 1.0
        return self._belief.prob_on(other if anchor == STRANGER else anchor, self._belief.region_support(self._region))

    def prob_was_on(self, anchor: str, support: str) -> float:
        """P(the object rested on the support at the start); nobody has moved the stranger."""
        if STRANGER in (anchor, support) or not isinstance(self._belief, EarlierBeliefs):
            return self.prob_on(anchor, support)
        return self._belief.prob_was_on(anchor, support)

    def prob_was_near(self, anchor: str, other: str, distance_m: float) -> float:
        """P(the objects were near at the start); for the stranger, P(the other was in its region)."""
        if not isinstance(self._belief, EarlierBeliefs) or anchor == other:
            return self.prob_near(anchor, other, distance_m)
        if STRANGER not in (anchor, other):
            return self._belief.prob_was_near(anchor, other, distance_m)
        met = other if anchor == STRANGER else anchor
        return self._belief.prob_was_on(met, self._belief.region_support(self._region))
