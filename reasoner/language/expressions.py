"""The goal language as values: what is believed, conjuncts and goals, with their text and their terms.

A goal asks that some objects exist of which several statements are believed with given probabilities:

    exists o. B(Den(lambda x. Green(x), o), 0.9) & B(In(o, table1), 0.9)

Every value prints as text that `parser` reads back as an equal value.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import combinations, groupby
from typing import Final, Literal

from skolem.reasoner.language.descriptions import (
    SPATIAL,
    Atom,
    Expression,
    Lambda,
    Name,
    Object,
    Variable,
    argument_term,
    constant_of,
    number_text,
    object_term,
)
from skolem.reasoner.terms import ANY, Compound, Term, compound, nll
from skolem.traces.messages import Evaluation

QUANTITIES: Final[dict[str, "QuantityName"]] = {
    "Color": "colour",
    "Colour": "colour",
    "Pose": "pose",
    "Weight": "weight",
}
RESERVED_WORDS: Final = frozenset({"B", "KRD", "Den", "Holds", "And", "Or", "Exists", "Was", *QUANTITIES, *SPATIAL})
DIMENSIONS: Final = {"pose": 3, "colour": 3, "weight": 1}
QuantityName = Literal["pose", "colour", "weight"]


@dataclass(frozen=True, slots=True)
class Den:
    """The description denotes the object."""

    description: Lambda
    argument: Object

    def __str__(self) -> str:
        return f"Den({self.description}, {self.argument})"


@dataclass(frozen=True, slots=True)
class Holds:
    """The object has every one of the properties."""

    words: tuple[str, ...]
    argument: Object

    def __str__(self) -> str:
        return f"Holds(({', '.join(self.words)}{',' if len(self.words) == 1 else ''}), {self.argument})"


@dataclass(frozen=True, slots=True)
class Sentence:
    """A statement about the world that names no variable of the goal: `exactly 2 x. Can(x) & On(x, table1)`."""

    body: Expression

    def __str__(self) -> str:
        return str(self.body)


@dataclass(frozen=True, slots=True)
class Together:
    """All parts hold in one world: `B(Den(lambda x. Can(x), o) & On(o, table1), 0.9)`."""

    parts: tuple[Den | Holds | Atom, ...]

    def __str__(self) -> str:
        return " & ".join(map(str, self.parts))


Phi = Den | Holds | Atom | Sentence | Together


@dataclass(frozen=True, slots=True)
class Believed:
    """B(phi, p): phi is believed with probability at least p."""

    phi: Phi
    p: float

    def __str__(self) -> str:
        return f"B({self.phi}, {number_text(self.p)})"


@dataclass(frozen=True, slots=True)
class Estimated:
    """B(phi, mu, Sigma, Delta, p): a quantity is known to within Sigma, with mixture weight at least p.

    Attributes:
        quantity: pose (x, y [m], theta [rad], in the frame of the base), colour (hue, saturation, value, 0..1) or
            weight (ln kg).
        argument: The object that has the quantity.
        mean: mu; None, written `any`, when only certainty is asked for.
        sd: Sigma, diagonal, written as standard deviations.
        tolerance: Delta: how far the believed mean may be from mu, per component.
        p: Least mixture weight.
    """

    quantity: QuantityName
    argument: Object
    mean: tuple[float, ...] | None
    sd: tuple[float, ...]
    tolerance: tuple[float, ...]
    p: float

    def __str__(self) -> str:
        word = next(word for word, quantity in QUANTITIES.items() if quantity == self.quantity)
        vectors = ", ".join(_vector_text(vector) for vector in (self.mean, self.sd, self.tolerance))
        return f"B({word}({self.argument}), {vectors}, {number_text(self.p)})"


@dataclass(frozen=True, slots=True)
class Designated:
    """KRD(o): a rigid designator of the object is known."""

    argument: Object

    def __str__(self) -> str:
        return f"KRD({self.argument})"


Conjunct = Believed | Estimated | Designated


def parts_of(phi: Phi) -> tuple[Den | Holds | Atom | Sentence, ...]:
    """Return the parts of what is believed together; of anything else, that alone."""
    return phi.parts if isinstance(phi, Together) else (phi,)


@dataclass(frozen=True)
class Goal:
    """A goal: objects exist for which every conjunct is believed; a variable means one object throughout.

    Attributes:
        variables: All variables, in order of appearance.
        conjuncts: What is believed.
        distinct: Groups of variables that mean different objects; each stands side by side in `variables`.
        evaluation: What a probability is: `worlds`, the share of the possible worlds in which the belief is true; or
            `independent`, the paper's product of the probabilities of its parts.
    """

    variables: tuple[str, ...]
    conjuncts: tuple[Conjunct, ...]
    distinct: tuple[tuple[str, ...], ...] = ()
    evaluation: Evaluation = "worlds"

    def __str__(self) -> str:
        group_of = {name: group for group in self.distinct for name in group}
        heads = [
            f"exists {'distinct ' if group else ''}{', '.join(names)}. "
            for group, names in groupby(self.variables, lambda name: group_of.get(name, ()))
        ]
        return "".join(heads) + " & ".join(map(str, self.conjuncts))

    @cached_property
    def expressions(self) -> dict[str, Lambda]:
        """The distinct descriptions by their constants e1, e2, .. in order of appearance."""
        found = dict.fromkeys(phi.description for phi in self._phis() if isinstance(phi, Den))
        return {f"e{index}": description for index, description in enumerate(found, 1)}

    @cached_property
    def sentences(self) -> dict[str, Sentence]:
        """The sentences by their constants s1, s2, .. in order of appearance."""
        found = dict.fromkeys(phi for phi in self._phis() if isinstance(phi, Sentence))
        return {f"s{index}": sentence for index, sentence in enumerate(found, 1)}

    @cached_property
    def fluents(self) -> tuple[Term, ...]:
        """The conjuncts as fluents, each once, sorted by text."""
        constants: dict[Lambda | Sentence, str] = {value: name for name, value in self.expressions.items()}
        constants |= {value: name for name, value in self.sentences.items()}
        differ = {
            compound("differ", *(compound("var", name) for name in pair))
            for group in self.distinct
            for pair in combinations(group, 2)
        }
        return tuple(sorted({*(_fluent(conjunct, constants) for conjunct in self.conjuncts), *differ}, key=str))

    def _phis(self) -> Iterator[Den | Holds | Atom | Sentence]:
        for conjunct in self.conjuncts:
            if isinstance(conjunct, Believed):
                yield from parts_of(conjunct.phi)


# ---------------------------------------------------------------- terms


def _fluent(conjunct: Conjunct, constants: Mapping[Lambda | Sentence, str]) -> Term:
    match conjunct:
        case Designated(argument):
            return compound("krd", object_term(argument))
        case Believed(phi, p):
            return compound("b", _believed_term(phi, constants), nll(p))
        case Estimated(quantity, argument, mean, sd, tolerance, p):
            value = ANY if mean is None else _thousandths("v", mean)
            quantity_term = compound(quantity, object_term(argument))
            return compound("bn", quantity_term, value, _thousandths("sd", sd), _thousandths("tol", tolerance), nll(p))


def _believed_term(phi: Phi, constants: Mapping[Lambda | Sentence, str]) -> Term:
    match phi:
        case Together(parts):
            first, *others = (_believed_term(part, constants) for part in reversed(parts))
            return reduce(lambda rest, part: compound("together", part, rest), others, first)
        case Sentence():
            return compound("holds_of_the_world", constants[phi])
        case Den(description, argument):
            return compound("den", constants[description], object_term(argument))
        case Holds(words, argument):
            return compound("holds", Compound("", tuple(map(constant_of, words))), object_term(argument))
        case Atom(word, (Variable() | Name() as argument,)):
            return compound("prop", constant_of(word), object_term(argument))
        case Atom(word, args):
            return Compound(constant_of(word), tuple(map(argument_term, args)))


def _thousandths(functor: str, vector: tuple[float, ...]) -> Compound:
    return Compound(functor, tuple(round(1000 * component) for component in vector))


def _vector_text(vector: tuple[float, ...] | None) -> str:
    if vector is None:
        return ANY
    text = ", ".join(map(number_text, vector))
    return text if len(vector) == 1 else f"({text})"
