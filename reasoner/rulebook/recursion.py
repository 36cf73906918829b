"""The check that recursion ends: no predicate derives ever larger terms, or ever new numbers, from its own atoms.

clingo grounds `far(f(X)) :- far(X)` until memory is full. A predicate that depends on itself derives finitely many
atoms if every argument of the head comes from other predicates or is a part of an earlier argument. Where a rule makes
an argument larger, some argument must move in one direction in each such rule and in no rule backwards: it becomes a
part of the earlier one, or it counts up or down to a bound. Its index may differ from predicate to predicate. The
condition is sufficient, not necessary: rules that may end but cannot be shown to are refused.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

from skolem.reasoner.rulebook.counting import OTHER_WAY, WIDEST, Limit, Rule, is_remainder, read, step, variables
from skolem.reasoner.rulebook.parts import VARIABLE, Atom, Signature, Statement, arguments_of

_MOST: Final = 10_000  # choices of argument indices that are tried
_PART: Final = "part"  # the direction of an argument that becomes a part of the earlier one

Rules = Mapping[Signature, Sequence[Statement]]
Below = Mapping[Signature, frozenset[tuple[int, int]]]


@dataclass(frozen=True, slots=True)
class _Turn:
    """A rule by which a predicate depends on itself.

    Attributes:
        rule: The rule.
        before: The atoms in its body that depend on its head.
        known: Terms that come from other predicates.
        larger: Arguments of its head that are neither parts of earlier arguments nor made of known terms.
    """

    rule: Rule
    before: tuple[tuple[Signature, tuple[str, ...]], ...]
    known: frozenset[str]
    larger: tuple[str, ...]


def endless(
    statements: Iterable[Statement], constants: Mapping[str, int | None] | None = None
) -> Iterator[tuple[Statement, str]]:
    """Yield every rule whose grounding may never end, with a message that gives a remedy.

    Args:
        statements: Rules, each with an atom as its head.
        constants: The numbers that `#const` names.
    """
    rules: dict[Signature, list[Statement]] = {}
    for statement in statements:
        assert isinstance(statement.head, Atom), "a rule derives an atom"
        for signature in dict.fromkeys(statement.head.signatures):
            rules.setdefault(signature, []).append(statement)
    for circle in _circles(rules):
        turns = [turn for rule in _of(circle, rules, constants or {}) if (turn := _turn(rule, circle)).before]
        if any(turn.larger for turn in turns) and not _ends(turns, circle, rules):
            yield from ((turn.rule.statement, _fault(turn)) for turn in turns if turn.larger)


def _fault(turn: _Turn) -> str:
    (name, _), _ = turn.rule.head
    remedy = (
        f"compare what counts, a variable by itself, with a number up to {WIDEST}, or let an argument become smaller"
    )
    return f"{name} makes {turn.larger[0]} of what it derived before, and nothing tells that this ends; {remedy}"


def _circles(rules: Rules) -> list[frozenset[Signature]]:
    """Return the sets of predicates that depend on each other, in order of appearance."""
    uses = {
        head: {s for rule in found for part in rule.body if isinstance(part, Atom) for s in part.signatures}
        for head, found in rules.items()
    }
    below = {signature: reached(signature, uses) for signature in uses}
    circles = [frozenset(s for s in found if one in below.get(s, ())) for one, found in below.items() if one in found]
    return list(dict.fromkeys(circles))


def reached(start: Signature, uses: Mapping[Signature, set[Signature]]) -> set[Signature]:
    """Return the predicates that one depends on, directly or through others; itself only if it is recursive."""
    found: set[Signature] = set()
    waiting = [start]
    while waiting:
        new = uses.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


def _of(signatures: Iterable[Signature], rules: Rules, constants: Mapping[str, int | None]) -> list[Rule]:
    """Return the rules of some predicates, with pools unfolded."""
    found = dict.fromkeys(rule for signature in sorted(signatures) for rule in rules.get(signature, ()))
    every = ((statement, Statement.of(tree)) for statement in found for tree in statement.tree.unpool(condition=False))
    return [rule for each in every if (rule := read(*each, constants)).head[0] in signatures]


# ---------------------------------------------------------------- what grows


def _turn(rule: Rule, circle: frozenset[Signature]) -> _Turn:
    before = tuple(atom for atom in rule.body if atom[0] in circle)
    others = (term for signature, terms in rule.body if signature not in circle for term in terms)
    known = rule.counted.union(*map(_parts, others))
    had: frozenset[str] = frozenset().union(*(_parts(term) for _, terms in before for term in terms))
    larger = (term for term in rule.head[1] if term not in had and _grows(term, known, had, rule.limits))
    return _Turn(rule, before, known, tuple(larger))


def _grows(term: str, known: frozenset[str], had: frozenset[str], limits: frozenset[Limit]) -> bool:
    """Return whether a term may be new in each round: it depends on earlier arguments and nothing bounds it."""
    if term in known or term.startswith("@"):
        return False  # a query's answers come from the belief, which is finite
    inside = arguments_of(term)
    if inside is not None:
        return any(_grows(each, known, had, limits) for each in inside)
    names = variables(term) - known
    if not names or is_remainder(term):
        return False
    if VARIABLE.fullmatch(term):  # X, from an earlier X + 1
        ways = [way for name, way in map(step, had) if name == term]
        return not any((term, OTHER_WAY[way]) in limits for way in ways)
    counted, way = step(term)
    if counted:
        return (counted, way) not in limits
    return any((name, way) not in limits for name in names for way in OTHER_WAY)


def _parts(term: str) -> frozenset[str]:
    """Return a term and its arguments at any depth."""
    return frozenset({term}).union(*map(_parts, arguments_of(term) or ()))


# ---------------------------------------------------------------- what goes one way


def _ends(turns: Sequence[_Turn], circle: frozenset[Signature], rules: Rules) -> bool:
    """Return whether one argument of each predicate moves in one direction where any grows, and nowhere backwards."""
    below = {s: _smaller(_of([s], rules, {})) for s in sorted({s for turn in turns for s, _ in turn.rule.body})}
    names = sorted(circle)
    choices = ((way, places) for way in (_PART, *OTHER_WAY) for places in product(*(range(n) for _, n in names)))
    for tried, (way, places) in enumerate(choices):
        if tried == _MOST:
            return False
        place = dict(zip(names, places, strict=True))
        if all(_goes(way, turn, place, below) for turn in turns):
            return True
    return False


def _smaller(rules: Sequence[Rule]) -> frozenset[tuple[int, int]]:
    """Return the index pairs `(larger, smaller)` where, in all rules, one argument is a part of the other."""
    found: list[frozenset[tuple[int, int]]] = []
    for rule in rules:
        inside = [_parts(term) - {term} for term in rule.head[1]]
        found.append(
            frozenset((i, j) for i, parts in enumerate(inside) for j, t in enumerate(rule.head[1]) if t in parts)
        )
    return frozenset.intersection(*found) if found else frozenset()


def _goes(way: str, turn: _Turn, place: Mapping[Signature, int], below: Below) -> bool:
    """Return whether the chosen argument moves in the direction `way`, or stays the same if no argument grows."""
    signature, terms = turn.rule.head
    now = terms[place[signature]]
    for signature, terms in turn.before:
        was = terms[place[signature]]
        moved = _becomes_part(now, was, turn, below) if way == _PART else _counts(way, now, was, turn)
        if not moved and (turn.larger or now != was):
            return False
    return True


def _becomes_part(now: str, was: str, turn: _Turn, below: Below) -> bool:
    parts = _parts(was)
    holding = {atom[i] for name, atom in turn.rule.body for i, j in below[name] if atom[j] == now}
    return now in parts - {was} or not holding.isdisjoint(parts)


def _counts(way: str, now: str, was: str, turn: _Turn) -> bool:
    """Return whether a number counts in the direction `way`, up to a bound if another argument grows."""
    if step(now) == (was, way):
        name = was
    elif step(was) == (now, OTHER_WAY[way]):
        name = now
    else:
        return False
    return not turn.larger or now in turn.known or (name, way) in turn.rule.limits
