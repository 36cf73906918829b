"""Literals: which properties of the described object make a description true, or false.

Only an observation or a weighing of one object settles a property. Relations to other objects, and identity, count as
settled: no look at one object alone shows them.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Final

from skolem.reasoner.language.descriptions import (
    And,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Lambda,
    Not,
    Number,
    Or,
    Same,
    Variable,
    Was,
    constant_of,
)
from skolem.reasoner.meaning.complements import complements
from skolem.reasoner.rulebook.vocabulary import Vocabulary, comparison
from skolem.traces.messages import Meaning

MOST_ALTERNATIVES: Final = 32  # sets of properties kept per description, smallest first
Alternatives = tuple[tuple[str, ...], ...]
_SETTLED: Final[list[frozenset[str]]] = [frozenset()]


@dataclass(slots=True)
class Literals:
    """The properties that descriptions speak of, as the words say or as their complements.

    Attributes:
        meanings: The meaning of each property by name: those of the words, of the comparisons with numbers, and of the
            complements that were asked for.
    """

    vocabulary: Vocabulary
    meanings: dict[str, Meaning] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.meanings.update(self.vocabulary.meanings)

    def true(self, description: Lambda) -> Alternatives:
        """Return the minimal sets of properties that make a description true of an object, smallest first."""
        return _named(self._sets(description.body, description.variable, True))

    def false(self, description: Lambda) -> Alternatives:
        """Return the minimal sets of properties that make a description false of an object, smallest first."""
        return _named(self._sets(description.body, description.variable, False))

    def _sets(self, expression: Expression, variable: str, wanted: bool) -> list[frozenset[str]]:
        """Return the sets of properties of the variable's object that give an expression the wanted truth."""

        def of(inner: Expression, wanted: bool = wanted) -> list[frozenset[str]]:
            return self._sets(inner, variable, wanted)

        match expression:
            case Atom():
                return self._atom(expression, variable, wanted)
            case Not(body):
                return of(body, not wanted)
            case And(left, right):
                return _both(of(left), of(right)) if wanted else _either(of(left), of(right))
            case Or(left, right):
                return _either(of(left), of(right)) if wanted else _both(of(left), of(right))
            case Exists(_, body) | Was(body):
                return of(body)
            case Every(_, condition, body):
                return of(Not(And(condition, Not(body))))
            case Same() | Count():
                return _SETTLED

    def _atom(self, atom: Atom, variable: str, wanted: bool) -> list[frozenset[str]]:
        match atom.args:
            case (Variable(name),) if name == variable:
                found = constant_of(atom.word)
            case (Variable(name), Number(value)) if name == variable:
                relation, thousandths = constant_of(atom.word), round(1000 * value)
                found = comparison(relation, thousandths)
                self.meanings.setdefault(found, self.vocabulary.exceeding(relation, thousandths))
            case _:
                return _SETTLED
        if wanted:
            return [frozenset({found})]
        others: Mapping[str, Meaning] = complements(found, self.meanings[found])
        self.meanings.update(others)
        return [frozenset({name}) for name in others]


def _both(left: list[frozenset[str]], right: list[frozenset[str]]) -> list[frozenset[str]]:
    return _minimal(a | b for a, b in product(left, right))


def _either(left: list[frozenset[str]], right: list[frozenset[str]]) -> list[frozenset[str]]:
    return _minimal([*left, *right])


def _named(sets: list[frozenset[str]]) -> Alternatives:
    return tuple(tuple(sorted(words)) for words in sets if words)


def _minimal(sets: Iterable[frozenset[str]]) -> list[frozenset[str]]:
    """Return the sets that are no supersets of other non-empty ones, in a fixed order."""
    ordered = sorted(set(sets), key=lambda words: (len(words), sorted(words)))
    kept = [words for words in ordered if not any(other and other < words for other in ordered)]
    return kept[:MOST_ALTERNATIVES]
