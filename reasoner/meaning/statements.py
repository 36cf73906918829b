"""Statements: sentences of a goal as numbers of objects that fit a description.

`exists x. phi` says that one or more fit, `every x. phi -> psi` that none fits `phi & not psi`. A robot can change what
stands where, so a conjunct `On(x, table1)` is kept apart from those that only an observation settles.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce

from skolem.reasoner.language.descriptions import (
    SPATIAL,
    And,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Lambda,
    Name,
    Not,
    Variable,
)


@dataclass(frozen=True, slots=True)
class Statement:
    """From `low` to `high` objects fit a description.

    Attributes:
        low: At least so many.
        high: At most so many; None for any number.
        fitting: The description.
        kind: The description without its conjuncts `On(x, support)`; None if it consists of those.
        on: The supports of those conjuncts: an object that fits stands there.
        unless_on: The supports of its conjuncts `not On(x, support)`: an object that stands there does not fit.
    """

    low: int
    high: int | None
    fitting: Lambda
    kind: Lambda | None
    on: tuple[str, ...]
    unless_on: tuple[str, ...]


def statement(sentence: Expression) -> Statement | None:
    """Return a sentence as a number of objects; None if it says something else."""
    match sentence:
        case Exists(variable, body):
            return _statement(1, None, variable, body)
        case Count("at least", number, variable, body):
            return _statement(number, None, variable, body)
        case Count("at most", number, variable, body):
            return _statement(0, number, variable, body)
        case Count("exactly", number, variable, body):
            return _statement(number, number, variable, body)
        case Every(variable, condition, body):
            return _statement(0, 0, variable, And(condition, Not(body)))
        case Not(Exists(variable, body)):
            return _statement(0, 0, variable, body)
        case Not(Every(variable, condition, body)):
            return _statement(1, None, variable, And(condition, Not(body)))
        case Not(Count("at least", number, variable, body)) if number > 0:
            return _statement(0, number - 1, variable, body)
        case Not(Count("at most", number, variable, body)):
            return _statement(number + 1, None, variable, body)
        case Not(Not(body)):
            return statement(body)
    return None


def _statement(low: int, high: int | None, variable: str, body: Expression) -> Statement:
    conjuncts = list(_conjuncts(body))
    on = {part: support for part in conjuncts if (support := _stands_on(part, variable))}
    off = [support for part in conjuncts if isinstance(part, Not) and (support := _stands_on(part.body, variable))]
    rest = [part for part in conjuncts if part not in on]
    kind = Lambda(variable, reduce(And, rest)) if rest else None
    return Statement(low, high, Lambda(variable, body), kind, tuple(on.values()), tuple(off))


def _conjuncts(expression: Expression) -> Iterator[Expression]:
    match expression:
        case And(left, right):
            yield from _conjuncts(left)
            yield from _conjuncts(right)
        case Not(Not(body)):
            yield from _conjuncts(body)
        case _:
            yield expression


def _stands_on(expression: Expression, variable: str) -> str | None:
    match expression:
        case Atom(word, (Variable(name), Name(support))) if word in SPATIAL and name == variable:
            return support
    return None
