"""Goals that can never be achieved because of what their words mean: `Can(x) & Soda(x)` says two types of one object.

What a goal says is split into ways in which it can be true, each a list of literals; it is contradictory if each way
has two literals that exclude each other. A part that says something of all objects excludes nothing, so no goal that
can be achieved is ever told of.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Final

from skolem.reasoner.language.descriptions import (
    SPATIAL,
    And,
    Argument,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Lambda,
    Name,
    Not,
    Number,
    Or,
    Same,
    Variable,
    Was,
    constant_of,
)
from skolem.reasoner.language.expressions import Believed, Den, Goal, Holds, Sentence, parts_of
from skolem.reasoner.rulebook.colours import share_colour
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.traces.messages import HsvUnion, HsvVolume, Meaning, TypeIs, WeightInterval

MOST_WAYS: Final = 64  # what would make more is not judged


@dataclass(frozen=True, slots=True)
class Literal:
    """An atom that must or must not hold, of the goal's variables and of names.

    Attributes:
        atom: A relation, or that two are one object.
        positive: Whether it must hold.
        time: When places must be so.
    """

    atom: Atom | Same
    positive: bool
    time: str

    def __str__(self) -> str:
        return str(self.atom if self.positive else Not(self.atom))


_Ways = Sequence[tuple[Literal, ...]]
_Names = Mapping[str, Argument]
_ANY: Final[_Ways] = ((),)  # nothing is known to be needed


def contradictions(goal: Goal, vocabulary: Vocabulary) -> list[str]:
    """Return a text for each conjunct that can never be believed with its bound, alone or with a later one.

    Args:
        goal: A well-formed goal.
        vocabulary: The meaning of its words.
    """
    believed = [each for each in goal.conjuncts if isinstance(each, Believed)]
    ways = [
        _joined(_ways_of(part, f"_{i}_{k}") for k, part in enumerate(parts_of(each.phi)))
        for i, each in enumerate(believed)
    ]
    faults, sound = [], []
    for conjunct, its_ways in zip(believed, ways, strict=True):
        reason = _reason(its_ways, vocabulary)
        if reason:
            faults.append(f"{conjunct}: it can never be true, since {reason}")
        else:
            sound.append((conjunct, its_ways))
    for i, (one, its_ways) in enumerate(sound):
        for other, others in sound[i + 1 :]:
            reason = _reason(_joined([its_ways, others]), vocabulary) if one.p + other.p > 1.0 else ""
            if reason:
                faults.append(f"{one} and {other}: both can never be believed, since {reason}")
                break
    return faults


# ---------------------------------------------------------------- ways to be true


def _ways_of(part: Den | Holds | Atom | Sentence, suffix: str) -> _Ways:
    """Return the ways of a part; the variables that it binds end with `suffix`, to be apart from those of others."""
    match part:
        case Den(Lambda(variable, body, kind), argument):
            return _ways(body, True, "now" if kind == "lambda" else "was", {variable: argument}, suffix)
        case Holds(words, argument):
            return (tuple(Literal(Atom(word, (argument,)), True, "") for word in words),)
        case Sentence(body):
            return _ways(body, True, "now", {}, suffix)
    return _ways(part, True, "now", {}, suffix)


def _ways(said: Expression, positive: bool, time: str, names: _Names, suffix: str) -> _Ways:
    """Return the ways in which an expression is true or, unless `positive`, false."""

    def of(part: Expression, holds: bool = positive, bound: str = "") -> _Ways:
        inner = {**names, bound: Variable(bound + suffix)} if bound else names
        return _ways(part, holds, time, inner, suffix)

    match said:
        case Atom(word, arguments):
            when = time if len(arguments) > 1 else ""
            return ((Literal(Atom(word, tuple(_named(each, names) for each in arguments)), positive, when),),)
        case Same(left, right):
            return ((Literal(_same(_named(left, names), _named(right, names)), positive, ""),),)
        case Not(body):
            return of(body, not positive)
        case Was(body):
            return _ways(body, positive, "was", names, suffix)
        case And(left, right) | Or(left, right):
            both = isinstance(said, And) == positive
            return _joined([of(left), of(right)]) if both else _any_of(of(left), of(right))
        case Exists(variable, body):
            return of(body, True, variable) if positive else _ANY
        case Every(variable, condition, body):
            return _ANY if positive else _joined([of(condition, True, variable), of(body, False, variable)])
        case Count(kind, number, variable, body):
            some = number > 0 and kind != "at most" if positive else kind == "at most"
            return of(body, True, variable) if some else _ANY


def _named(argument: Argument, names: _Names) -> Argument:
    return names.get(argument.name, argument) if isinstance(argument, Variable) else argument


def _same(left: Argument, right: Argument) -> Same:
    assert not isinstance(left, Number)
    assert not isinstance(right, Number)
    return Same(left, right)


def _joined(parts: Iterable[_Ways]) -> _Ways:
    """Return the ways in which all parts are true, without parts that would make them too many."""
    found = _ANY
    for ways in parts:
        if len(found) * len(ways) <= MOST_WAYS:
            found = [one + other for one, other in product(found, ways)]
    return found


def _any_of(left: _Ways, right: _Ways) -> _Ways:
    return [*left, *right] if len(left) + len(right) <= MOST_WAYS else _ANY


# ---------------------------------------------------------------- what excludes what


def _reason(ways: _Ways, vocabulary: Vocabulary) -> str:
    """Return why none of the ways can be; empty if one of them can."""
    reasons = [next(_clashes(way, vocabulary), "") for way in ways]
    return reasons[0] if all(reasons) else ""


def _clashes(way: Sequence[Literal], vocabulary: Vocabulary) -> Iterator[str]:
    for literal in way:
        if isinstance(literal.atom, Same) and _is_false(literal.atom, literal.positive):
            yield f"{literal} is never true"
    for one, other in combinations(way, 2):
        if _exclude(one, other, vocabulary):
            remedy = f"; of where it stood before, say Was({one})" if _is_place(one.atom) and one.positive else ""
            yield f"{one} and {other} exclude each other{remedy}"


def _is_false(same: Same, positive: bool) -> bool:
    if not positive:
        return same.left == same.right
    return same.left != same.right and isinstance(same.left, Name) and isinstance(same.right, Name)


def _exclude(one: Literal, other: Literal, vocabulary: Vocabulary) -> bool:
    if not isinstance(one.atom, Atom) or not isinstance(other.atom, Atom):
        return one.atom == other.atom and one.positive != other.positive
    if _said(one.atom) == _said(other.atom):
        return one.positive != other.positive and one.time == other.time
    if one.atom.args[0] != other.atom.args[0] or not (one.positive and other.positive):
        return False
    if _is_place(one.atom) and _is_place(other.atom):
        supports = one.atom.args[1], other.atom.args[1]
        return one.time == other.time and all(isinstance(each, Name) for each in supports)
    first, second = _meaning(one.atom, vocabulary), _meaning(other.atom, vocabulary)
    return first is not None and second is not None and _disjoint(first, second)


def _said(atom: Atom) -> tuple[str, tuple[Argument, ...]]:
    return constant_of(atom.word), atom.args


def _is_place(atom: Atom | Same) -> bool:
    return isinstance(atom, Atom) and atom.word in SPATIAL


def _meaning(atom: Atom, vocabulary: Vocabulary) -> Meaning | None:
    """Return what an atom says of its first object alone; None if it says something of others too."""
    word = constant_of(atom.word)
    match atom.args:
        case (_,):
            return vocabulary.meanings[word]
        case (_, Number(value)) if word in vocabulary.exceeds:
            return vocabulary.exceeding(word, round(1000 * value))
    return None


def _disjoint(one: Meaning, other: Meaning) -> bool:
    match one, other:
        case TypeIs(), TypeIs():
            return one.type != other.type
        case WeightInterval(), WeightInterval():
            return _ends_before(one, other) or _ends_before(other, one)
        case HsvVolume() | HsvUnion(), HsvVolume() | HsvUnion():
            return not any(share_colour(a, b) for a in one.boxes for b in other.boxes)
    return False


def _ends_before(one: WeightInterval, other: WeightInterval) -> bool:
    return one.below_kg is not None and one.below_kg <= other.at_least_kg
