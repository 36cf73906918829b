"""Descriptions as values: words, objects, expressions and lambdas, with their text and the terms of their arguments.

A description is a lambda expression (section "Denoting objects"): `lambda x. Green(x) & Can(x)`. Every value prints as
text that `parser` reads back as an equal value.
"""

import re
from dataclasses import dataclass
from types import UnionType
from typing import Final, Literal

from skolem.reasoner.terms import Term, compound

SPATIAL: Final = {"On": "on", "In": "on"}  # In(o, s) is read as: on the top region of s
CountKind = Literal["exactly", "at least", "at most"]
DescriptionKind = Literal["lambda", "the", "heaviest", "lightest", "nearest"]


def constant_of(word: str) -> str:
    """Return the constant that stands for a relation word in the rules: `SodaBox` becomes `soda_box`."""
    return SPATIAL.get(word) or re.sub(r"(?<!^)(?=[A-Z])", "_", word).lower()


def word_of(constant: str) -> str:
    """Return the relation word of a constant of the rules: `soda_box` becomes `SodaBox`."""
    return "".join(part[:1].upper() + part[1:] for part in constant.split("_"))


def number_text(value: float) -> str:
    """Return the shortest text that reads back as `value`, without a trailing `.0`."""
    return repr(float(value)).removesuffix(".0")


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable bound by a lambda or an `exists`."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Name:
    """A name of an object: an anchor."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Number:
    """A numeric constant."""

    value: float

    def __str__(self) -> str:
        return number_text(self.value)


Object = Variable | Name
Argument = Variable | Name | Number


# ---------------------------------------------------------------- descriptions


@dataclass(frozen=True, slots=True)
class Atom:
    """A relation word applied to variables, names and numbers: R(c1, .., cn)."""

    word: str
    args: tuple[Argument, ...]

    def __str__(self) -> str:
        return f"{self.word}({', '.join(map(str, self.args))})"


@dataclass(frozen=True, slots=True)
class And:
    """Both expressions hold."""

    left: "Expression"
    right: "Expression"

    def __str__(self) -> str:
        return f"{_operand(self.left, And | _Unit)} & {_operand(self.right, _Unit)}"


@dataclass(frozen=True, slots=True)
class Or:
    """At least one of two expressions holds."""

    left: "Expression"
    right: "Expression"

    def __str__(self) -> str:
        return f"{_operand(self.left, And | Or | _Unit)} | {_operand(self.right, And | _Unit)}"


@dataclass(frozen=True, slots=True)
class Exists:
    """The body holds for some object."""

    variable: str
    body: "Expression"

    def __str__(self) -> str:
        return f"exists {self.variable}. {self.body}"


@dataclass(frozen=True, slots=True)
class Not:
    """The body does not hold."""

    body: "Expression"

    def __str__(self) -> str:
        if isinstance(self.body, Same):
            return f"{self.body.left} != {self.body.right}"
        return f"not {_operand(self.body, _Unit)}"


@dataclass(frozen=True, slots=True)
class Same:
    """Both are one object; its negation is written `x != y`."""

    left: Object
    right: Object

    def __str__(self) -> str:
        return f"{self.left} = {self.right}"


@dataclass(frozen=True, slots=True)
class Count:
    """The body holds for a number of objects."""

    kind: CountKind
    number: int
    variable: str
    body: "Expression"

    def __str__(self) -> str:
        return f"{self.kind} {self.number} {self.variable}. {self.body}"


@dataclass(frozen=True, slots=True)
class Every:
    """The body holds for every object that the condition holds for."""

    variable: str
    condition: "Expression"
    body: "Expression"

    def __str__(self) -> str:
        return f"every {self.variable}. {_operand(self.condition, And | Or | _Unit)} -> {self.body}"


@dataclass(frozen=True, slots=True)
class Was:
    """The body held when the goal was stated."""

    body: "Expression"

    def __str__(self) -> str:
        return f"Was({self.body})"


Expression = Atom | And | Or | Exists | Not | Same | Count | Every | Was
_Unit = Atom | Not | Same | Was  # what needs no parentheses within any other expression


def _operand(expression: Expression, plain: type | UnionType) -> str:
    """Return the text of an operand, in parentheses unless its class is among `plain`."""
    return str(expression) if isinstance(expression, plain) else f"({expression})"


@dataclass(frozen=True, slots=True)
class Lambda:
    """A description of the objects for which the body holds. No two binders in it share a name.

    Attributes:
        variable: The variable that it binds.
        body: What holds of the object.
        kind: `lambda` for any such object; `the` for the only one; `heaviest` and `lightest` for the one of all such
            objects that weighs most or least; `nearest` for the one nearest to another object.
        to: The other object of `nearest`.
    """

    variable: str
    body: Expression
    kind: DescriptionKind = "lambda"
    to: Name | None = None

    def __str__(self) -> str:
        to = f" to {self.to}" if self.to else ""
        return f"{self.kind} {self.variable}{to}. {self.body}"


# ---------------------------------------------------------------- terms


def object_term(argument: Object) -> Term:
    """Return `var(o)` for a variable and the anchor's constant for a name."""
    return compound("var", argument.name) if isinstance(argument, Variable) else argument.name


def argument_term(argument: Argument) -> Term:
    """Return `var(x)`, an anchor's constant, or `number(thousandths)`."""
    if isinstance(argument, Number):
        return compound("number", round(1000 * argument.value))
    return object_term(argument)
