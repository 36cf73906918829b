"""The descriptions of a goal: P(Den) of every object, and the properties that make each description true."""

from collections.abc import Iterable, Mapping
from itertools import product
from typing import Final

from skolem.reasoner.language.descriptions import Lambda
from skolem.reasoner.planning.denotation import STRANGER, WithStranger, evaluate, evaluate_at
from skolem.reasoner.protocols import GroundBeliefs, OpenBeliefs
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.vocabulary import comparison
from skolem.reasoner.worlds.circuits import (
    Circuit,
    Either,
    EitherOver,
    Leaf,
    Node,
    Product,
    compared_in,
    compile_description,
)
from skolem.traces.messages import Meaning

MOST_ALTERNATIVES: Final = 32  # sets of properties kept per description, smallest first


class Denotations:
    """The descriptions of a goal, evaluated once per version of the belief.

    Attributes:
        circuits: The circuit of each description, by its constant.
        meanings: The meaning of each property by name: those of the words, and the comparisons with numbers.
        alternatives: The result of `alternatives` for each description, by its constant.
    """

    def __init__(self, expressions: Mapping[str, Lambda], rulebook: Rulebook) -> None:
        self.circuits = {name: compile_description(found, rulebook) for name, found in expressions.items()}
        self.alternatives = {name: alternatives(circuit) for name, circuit in self.circuits.items()}
        self._vocabulary = rulebook.vocabulary
        compared = {name: found for circuit in self.circuits.values() for name, found in circuit.compared.items()}
        own = {name: self._vocabulary.exceeding(*found) for name, found in sorted(compared.items())}
        self.meanings: Mapping[str, Meaning] = {**self._vocabulary.meanings, **own}
        self._version: int | None = None
        self._tables: dict[str, dict[str, float]] = {}

    def probabilities(self, expression: str, belief: GroundBeliefs) -> Mapping[str, float]:
        """Return P(Den) for every anchor."""
        if belief.version != self._version:
            self._version, self._tables = belief.version, {}
        if expression not in self._tables:
            self._tables[expression] = evaluate(self.circuits[expression], belief, self._vocabulary)
        return self._tables[expression]

    def probability(self, expression: str, anchor: str, belief: GroundBeliefs) -> float:
        """Return P(Den); 0 for an unknown anchor."""
        return self.probabilities(expression, belief).get(anchor, 0.0)

    def probability_of_new(self, expression: str, region: str, belief: OpenBeliefs) -> float:
        """Return P(Den) of an arbitrary object in the region that is not met yet."""
        return evaluate_at(STRANGER, self.circuits[expression], WithStranger(belief, region), self._vocabulary)

    def conjuncts(self, expression: str, anchor: str, belief: GroundBeliefs) -> dict[str, float]:
        """Return the probability of each property in the description, for explanations."""
        return {name: belief.prob_property(anchor, self.meanings[name]) for name in self.circuits[expression].props}


# ---------------------------------------------------------------- which properties make it true


def alternatives(circuit: Circuit) -> tuple[tuple[str, ...], ...]:
    """Return the minimal sets of properties of the described object that make its description true, smallest first.

    Relations to other objects count as true: no observation of one object settles those.
    """
    return tuple(tuple(sorted(words)) for words in _alternatives(circuit.root, circuit) if words)


def _alternatives(node: Node, circuit: Circuit) -> list[frozenset[str]]:
    match node:
        case Leaf(relation, args):
            compared = compared_in(node, circuit.variable)
            if compared is not None:
                return [frozenset({comparison(*compared)})]
            return [frozenset({relation}) if args == (circuit.variable,) else frozenset()]
        case EitherOver(_, inner):
            return _alternatives(inner, circuit)
        case Product(left, right):
            pairs = product(_alternatives(left, circuit), _alternatives(right, circuit))
            return _minimal(a | b for a, b in pairs)
        case Either(left, right):
            return _minimal([*_alternatives(left, circuit), *_alternatives(right, circuit)])
        case _:
            return [frozenset()]


def _minimal(sets: Iterable[frozenset[str]]) -> list[frozenset[str]]:
    """Return the sets that are no supersets of other non-empty ones, in a fixed order."""
    ordered = sorted(set(sets), key=lambda words: (len(words), sorted(words)))
    kept = [words for words in ordered if not any(other and other < words for other in ordered)]
    return kept[:MOST_ALTERNATIVES]
