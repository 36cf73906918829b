"""Rules with their equations substituted and the bounds of their variables, for the check of recursion."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from typing import Final

from skolem.reasoner.rulebook.parts import ANONYMOUS, VARIABLE, Atom, Comparison, Nested, Signature, Statement

WIDEST: Final = 10_000  # most numbers in an interval, and greatest bound up to which a rule may count
OTHER_WAY: Final = {"+": "-", "-": "+"}
_COUNTED: Final = re.compile(rf"(?P<name>{VARIABLE.pattern}) = #")
_STEP: Final = re.compile(rf"\((?P<name>{VARIABLE.pattern})(?P<way>[-+])[1-9]\d*\)")
_REMAINDER: Final = re.compile(r"\((?P<left>.*)\\[1-9]\d*\)")
_NUMBER: Final = re.compile(r"-?\d+")

Limit = tuple[str, str]  # a variable and the direction in which a comparison with a number bounds it: `+` upwards


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule whose equations are substituted and whose `_` have names.

    Attributes:
        statement: The rule as it stands in its file.
        head: Predicate and arguments of its head.
        body: Predicate and arguments of its positive atoms.
        limits: The bounds that its comparisons with numbers give.
        counted: Variables that an aggregate gives their value.
    """

    statement: Statement
    head: tuple[Signature, tuple[str, ...]]
    body: tuple[tuple[Signature, tuple[str, ...]], ...]
    limits: frozenset[Limit]
    counted: frozenset[str]


def read(statement: Statement, rule: Statement, constants: Mapping[str, int | None]) -> Rule:
    """Return a rule in which variables with an equation X = t are replaced by t.

    Args:
        statement: The rule as it stands in its file.
        rule: The same without pools, or one of the rules into which its pools unfold.
        constants: The numbers that `#const` names.
    """
    assert isinstance(rule.head, Atom)
    atoms = [rule.head, *(part for part in rule.body if isinstance(part, Atom) and not part.sign)]
    compared = [part for part in rule.body if isinstance(part, Comparison) and not part.sign]
    number = count(1)
    texts = [[_named(term, number) for term in part.terms] for part in compared]
    texts += [[_named(term, number) for term in atom.pool[0]] for atom in atoms]
    for i, part in enumerate(compared):
        if part.operators == ("=",):
            left, right = texts[i]
            name, value = (left, right) if VARIABLE.fullmatch(left) else (right, left)
            if VARIABLE.fullmatch(name) and name not in variables(value):
                texts = [[_replaced(term, name, value) for term in terms] for terms in texts]
    limits = frozenset(
        limit
        for part, terms in zip(compared, texts, strict=False)
        for left, operator, right in zip(terms, part.operators, terms[1:], strict=False)
        for limit in _limits(left, operator, right, constants)
    )
    said = zip(atoms, texts[len(compared) :], strict=True)
    head, *body = [(atom.signatures[0], tuple(terms)) for atom, terms in said]
    counts = (_COUNTED.match(part.text) for part in rule.body if isinstance(part, Nested))
    return Rule(statement, head, tuple(body), limits, frozenset(found["name"] for found in counts if found))


def variables(term: str) -> frozenset[str]:
    """Return the variables in a term."""
    return frozenset(VARIABLE.findall(term))


def step(term: str) -> tuple[str, str]:
    """Return ("X", "+") for a term X+n and ("X", "-") for X-n; ("", "") for any other term."""
    match = _STEP.fullmatch(term)
    return ("", "") if match is None else (match["name"], match["way"])


def is_remainder(term: str) -> bool:
    """Return whether a term is the remainder of a division by a number, which has finitely many values."""
    match = _REMAINDER.fullmatch(term)
    return match is not None and (VARIABLE.fullmatch(match["left"]) is not None or _in_brackets(match["left"]))


def _in_brackets(text: str) -> bool:
    """Return whether one pair of brackets encloses the whole text."""
    depth = 0
    for i, mark in enumerate(text):
        depth += (mark == "(") - (mark == ")")
        if depth == 0:
            return mark == ")" and i + 1 == len(text)
    return False


def _limits(left: str, operator: str, right: str, constants: Mapping[str, int | None]) -> Iterator[Limit]:
    """Yield the bounds that a comparison with a number gives."""
    if operator in ("<", "<=", ">", ">="):
        ways = "+-" if operator.startswith("<") else "-+"
        for term, other, way in ((left, right, ways[0]), (right, left, ways[1])):
            name = step(term)[0] or term
            number = int(other) if _NUMBER.fullmatch(other) else constants.get(other)
            if VARIABLE.fullmatch(name) and number is not None and abs(number) <= WIDEST:
                yield name, way


def _named(term: str, number: Iterator[int]) -> str:
    return ANONYMOUS.sub(lambda _: f"_Unnamed{next(number)}", term)


def _replaced(term: str, name: str, value: str) -> str:
    return VARIABLE.sub(lambda found: value if found[0] == name else found[0], term)
