"""Recursion that ends: no predicate derives ever larger terms, or ever other numbers, from what it derived before.

clingo grounds `far(f(X)) :- far(X)` until memory is full. A predicate that depends on itself derives finitely many
atoms if every argument is made of what other predicates give, or is a part of an argument there was before. Where one
is made larger there has to be an argument that becomes smaller in each of these rules and larger in none; its place may
differ from predicate to predicate. A number may go one way if a comparison holds it there. All of this is enough, not
necessary: what cannot be told to end is refused too.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count, product
from typing import Final

from skolem.reasoner.parts import (
    ANONYMOUS,
    VARIABLE,
    Atom,
    Comparison,
    Nested,
    Signature,
    Statement,
    arguments_of,
)

_MOST: Final = 10_000  # choices of places that are tried
_COUNTED: Final = re.compile(rf"(?P<name>{VARIABLE.pattern}) = #")
_STEP: Final = re.compile(rf"\((?P<name>{VARIABLE.pattern})(?P<way>[-+])[1-9]\d*\)")

Terms = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Limit:
    """A comparison that holds the variables of a term on one side of another term.

    Attributes:
        names: The variables.
        way: `+` if they cannot go on growing, `-` if they cannot go on falling.
        other: The variables of the other term.
    """

    names: frozenset[str]
    way: str
    other: frozenset[str]


@dataclass(frozen=True, slots=True)
class _Rule:
    """A rule with its equations put in, and a name for every `_`.

    Attributes:
        statement: As it stands in its file.
        head: Its head.
        body: Its positive atoms.
        limits: Its positive comparisons.
        counted: Variables that are the number of something.
    """

    statement: Statement
    head: tuple[Signature, Terms]
    body: tuple[tuple[Signature, Terms], ...]
    limits: tuple[_Limit, ...]
    counted: frozenset[str]


@dataclass(frozen=True, slots=True)
class _Turn:
    """A rule by which a predicate depends on itself.

    Attributes:
        rule: The rule.
        before: The atoms in its body that depend on its head.
        limited: Variables that cannot go on one way: each with `+` or `-`.
        larger: Arguments of its head that are neither parts of what was before nor made of anything else.
    """

    rule: _Rule
    before: tuple[tuple[Signature, Terms], ...]
    limited: frozenset[tuple[str, str]]
    larger: Terms


def endless(statements: Iterable[Statement]) -> Iterator[tuple[Statement, str]]:
    """Yield every rule of which grounding may never end, with what is wrong and a remedy.

    Args:
        statements: Rules, each with an atom as its head.
    """
    rules: dict[Signature, list[Statement]] = {}
    for statement in statements:
        assert isinstance(statement.head, Atom), "a rule derives an atom"
        for signature in dict.fromkeys(statement.head.signatures):
            rules.setdefault(signature, []).append(statement)
    for circle in _circles(rules):
        turns = [turn for rule in _of(circle, rules) if (turn := _turn(rule, circle)).before]
        if any(turn.larger for turn in turns) and not _ends(turns, circle, rules):
            yield from ((turn.rule.statement, _fault(turn)) for turn in turns if turn.larger)


def _fault(turn: _Turn) -> str:
    (name, _), _ = turn.rule.head
    remedy = "bound it by a comparison, or let another argument become smaller each time"
    return f"{name} makes {turn.larger[0]} of what it derived before, without end; {remedy}"


def _circles(rules: Mapping[Signature, Sequence[Statement]]) -> list[frozenset[Signature]]:
    """Return the sets of predicates that depend on each other, in order of appearance."""
    uses = {
        head: {s for rule in found for part in rule.body if isinstance(part, Atom) for s in part.signatures}
        for head, found in rules.items()
    }
    reached = {signature: _reached(signature, uses) for signature in uses}
    circles = [
        frozenset(s for s in found if one in reached.get(s, ())) for one, found in reached.items() if one in found
    ]
    return list(dict.fromkeys(circles))


def _reached(start: Signature, uses: Mapping[Signature, set[Signature]]) -> set[Signature]:
    found: set[Signature] = set()
    waiting = [start]
    while waiting:
        new = uses.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


# ---------------------------------------------------------------- rules


def _of(signatures: Iterable[Signature], rules: Mapping[Signature, Sequence[Statement]]) -> list[_Rule]:
    """Return the rules of some predicates."""
    found = dict.fromkeys(rule for signature in sorted(signatures) for rule in rules.get(signature, ()))
    read = [
        _read(statement, Statement.of(tree)) for statement in found for tree in statement.tree.unpool(condition=False)
    ]
    return [rule for rule in read if rule.head[0] in signatures]


def _read(statement: Statement, rule: Statement) -> _Rule:
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
            if VARIABLE.fullmatch(name) and name not in VARIABLE.findall(value):
                texts = [[_replaced(term, name, value) for term in terms] for terms in texts]
    limits = [limit for part, terms in zip(compared, texts, strict=False) for limit in _limits(part.operators, terms)]
    said = zip(atoms, texts[len(compared) :], strict=True)
    head, *body = [(atom.signatures[0], tuple(terms)) for atom, terms in said]
    counts = (_COUNTED.match(part.text) for part in rule.body if isinstance(part, Nested))
    return _Rule(statement, head, tuple(body), tuple(limits), frozenset(found["name"] for found in counts if found))


def _named(term: str, number: Iterator[int]) -> str:
    return ANONYMOUS.sub(lambda _: f"_Unnamed{next(number)}", term)


def _replaced(term: str, name: str, value: str) -> str:
    return VARIABLE.sub(lambda found: value if found[0] == name else found[0], term)


def _limits(operators: Sequence[str], terms: Sequence[str]) -> Iterator[_Limit]:
    names = [frozenset(VARIABLE.findall(term)) for term in terms]
    for operator, left, right in zip(operators, names, names[1:], strict=False):
        if operator in ("<", "<=", ">", ">="):
            ways = "+-" if operator.startswith("<") else "-+"
            yield _Limit(left, ways[0], right)
            yield _Limit(right, ways[1], left)


def _turn(rule: _Rule, circle: frozenset[Signature]) -> _Turn:
    before = tuple(atom for atom in rule.body if atom[0] in circle)
    others = (term for signature, terms in rule.body if signature not in circle for term in terms)
    known = {name for term in others for name in VARIABLE.findall(term)} | rule.counted
    limited = frozenset((name, each.way) for each in rule.limits if each.other <= known for name in each.names)
    had = {part for _, terms in before for term in terms for part in _parts(term)}
    larger = (term for term in rule.head[1] if term not in had and _grows(term, known, limited))
    return _Turn(rule, before, limited, tuple(larger))


def _grows(term: str, known: set[str], limited: frozenset[tuple[str, str]]) -> bool:
    """Return whether a term may be another one each time: made of what was before, and not held by a comparison."""
    if term.startswith("@"):
        return False  # what a query answers comes from the belief, which is finite
    inside = arguments_of(term)
    if inside is not None:
        return any(_grows(each, known, limited) for each in inside)
    names = set(VARIABLE.findall(term)) - known
    step = _STEP.fullmatch(term)
    if step is not None:
        return bool(names) and (step["name"], step["way"]) not in limited
    return bool(names) and (VARIABLE.fullmatch(term) is not None or not names <= {name for name, _ in limited})


def _parts(term: str) -> set[str]:
    """Return a term and every term that it has as an argument, at any depth."""
    return {term}.union(*map(_parts, arguments_of(term) or ()))


# ---------------------------------------------------------------- what becomes smaller


def _ends(turns: Sequence[_Turn], circle: frozenset[Signature], rules: Mapping[Signature, Sequence[Statement]]) -> bool:
    """Return whether an argument of each predicate becomes smaller wherever one grows, and becomes larger nowhere."""
    below = {s: _smaller(_of([s], rules)) for s in sorted({s for turn in turns for s, _ in turn.rule.body})}
    names = sorted(circle)
    for tried, chosen in enumerate(product(*(range(arity) for _, arity in names))):
        if tried == _MOST:
            return False
        if all(_shrinks(turn, dict(zip(names, chosen, strict=True)), below) for turn in turns):
            return True
    return False


def _smaller(rules: Sequence[_Rule]) -> frozenset[tuple[int, int]]:
    """Return which argument of a predicate is, in all its rules, a part of which other: `(larger, smaller)`."""
    found: list[frozenset[tuple[int, int]]] = []
    for rule in rules:
        inside = [_parts(term) - {term} for term in rule.head[1]]
        found.append(
            frozenset((i, j) for i, parts in enumerate(inside) for j, t in enumerate(rule.head[1]) if t in parts)
        )
    return frozenset.intersection(*found) if found else frozenset()


def _shrinks(
    turn: _Turn, place: Mapping[Signature, int], below: Mapping[Signature, frozenset[tuple[int, int]]]
) -> bool:
    """Return whether the argument at some place becomes smaller, or at least not larger if nothing grows."""
    signature, terms = turn.rule.head
    now = terms[place[signature]]
    step = _STEP.fullmatch(now)
    holding = {atom[i] for name, atom in turn.rule.body for i, j in below[name] if atom[j] == now}
    for signature, terms in turn.before:
        was = terms[place[signature]]
        parts = _parts(was)
        counts = step is not None and step["name"] == was and (was, step["way"]) in turn.limited
        smaller = counts or now in parts - {was} or not holding.isdisjoint(parts)
        if not smaller and (turn.larger or now != was):
            return False
    return True
