"""Descriptions of an object by its relation to another one: `a can near a bottle`, `the table that has a red thing`."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce

from skolem.reasoner.language.descriptions import (
    And,
    Atom,
    Exists,
    Expression,
    Lambda,
    Not,
    Same,
    Variable,
    constant_of,
)


@dataclass(frozen=True, slots=True)
class Related:
    """A description that asks for another object, the witness, in a relation to the described one.

    Attributes:
        relation: The constant of the relation.
        from_witness: Whether the witness is the first argument of the relation.
        itself: What else is said of the described object; None if nothing is.
        witness: What is said of the witness; None if nothing is.
    """

    relation: str
    from_witness: bool
    itself: Lambda | None
    witness: Lambda | None


def related(description: Lambda) -> Related | None:
    """Return the relation of a description that asks for one witness in one relation; None for other descriptions."""
    parts = list(_conjuncts(description.body))
    inner = [part for part in parts if isinstance(part, Exists)]
    if len(inner) != 1:
        return None
    x, y = description.variable, inner[0].variable
    of_y = [part for part in _conjuncts(inner[0].body) if not _says_different(part, x, y)]
    relations = [part for part in of_y if _is_between(part, x, y)]
    if len(relations) != 1 or not isinstance(relations[0], Atom):
        return None
    rest = [part for part in of_y if part is not relations[0]]
    if any(_mentions(part, x) for part in rest):
        return None
    first = relations[0].args[0]
    others = [part for part in parts if part is not inner[0]]
    return Related(constant_of(relations[0].word), first == Variable(y), _lambda(x, others), _lambda(y, rest))


def _conjuncts(expression: Expression) -> Iterator[Expression]:
    if isinstance(expression, And):
        yield from _conjuncts(expression.left)
        yield from _conjuncts(expression.right)
    else:
        yield expression


def _lambda(variable: str, parts: list[Expression]) -> Lambda | None:
    return Lambda(variable, reduce(And, parts)) if parts else None


def _is_between(part: Expression, x: str, y: str) -> bool:
    return isinstance(part, Atom) and set(part.args) == {Variable(x), Variable(y)}


def _says_different(part: Expression, x: str, y: str) -> bool:
    return (
        isinstance(part, Not)
        and isinstance(part.body, Same)
        and {part.body.left, part.body.right}
        == {
            Variable(x),
            Variable(y),
        }
    )


def _mentions(part: Expression, variable: str) -> bool:
    return re.search(rf"\b{variable}\b", str(part)) is not None
