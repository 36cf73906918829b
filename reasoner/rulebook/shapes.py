"""The rules that a question can need, found by evaluating all rules over shapes instead of terms.

The shape of a term keeps its functors and forgets its constants and numbers: that of `goal(b(on(o2,desk),105361))` is
`goal(b(on(leaf,leaf),leaf))`; an unknown term has the shape `any`. A rule fires over shapes whenever it can fire over
terms: all conditions of a rule besides the shape of its positive literals (negation, comparisons, conditions, answers
of queries) count as true. So a rule that does not fire over the shape of a question cannot fire in answering it, and
is left out without changing the answer.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Final

from clingo.ast import AST, ASTType

from skolem.reasoner.rulebook import parts
from skolem.reasoner.rulebook.parts import Signature, Statement
from skolem.reasoner.rulebook.validate import WITHOUT_PREDICATES, children, signatures
from skolem.reasoner.terms import ANY, Compound, Term

Atom = tuple[Term, ...]  # the arguments of an atom, as shapes

_DEEPEST: Final = 6  # functors below this depth are cut off
_MOST_SHAPES: Final = 64  # of one predicate; if there are more, all count as `any`
_MEMORY: Final = 1 << 14  # terms whose shape is remembered
_LEAF: Final = "leaf"  # the shape of constants and numbers
_VARIABLE: Final = "$"  # variables of a rule are compounds of this name


@dataclass(frozen=True, slots=True)
class Literal:
    """A predicate with argument patterns."""

    signature: Signature
    args: tuple[Term, ...]


@dataclass(frozen=True, slots=True)
class Shaped:
    """A rule over shapes.

    Attributes:
        heads: Its head; several if that is a pool.
        body: Its positive literals, with pools unfolded.
        equal: Pairs of patterns that must be equal.
        uses: Every predicate in its body, also under negation and in conditions.
    """

    heads: tuple[Literal, ...]
    body: tuple[tuple[Literal, ...], ...]
    equal: tuple[tuple[Term, Term], ...]
    uses: frozenset[Signature]


def shape(term: Term) -> Term:
    """Return the shape of a ground term."""
    return _cut(term, _DEEPEST)


@lru_cache(_MEMORY)
def _cut(term: Term, depth: int) -> Term:
    if term == ANY or depth == 0:
        return ANY
    if not isinstance(term, Compound):
        return _LEAF
    return Compound(term.name, tuple(_cut(arg, depth - 1) for arg in term.args))


# ---------------------------------------------------------------- reading rules


def shaped(rule: Statement) -> Shaped:
    """Return a rule with one atom as its head as a rule over shapes."""
    body: list[tuple[Literal, ...]] = []
    equal: list[tuple[Term, Term]] = []
    uses: set[Signature] = set()
    for part in rule.body:
        uses |= predicates(part)
        match part:
            case parts.Atom(sign=""):
                body.append(_literals(part))
            case parts.Comparison(sign="", operators=("=",)):
                left, right = map(_pattern, part.terms)
                equal.append((left, right))
    assert isinstance(rule.head, parts.Atom), "a rule derives an atom"
    return Shaped(_literals(rule.head), tuple(body), tuple(equal), frozenset(uses))


def predicates(part: parts.Part) -> set[Signature]:
    """Return every predicate that occurs in a part of a rule."""
    match part:
        case parts.Atom():
            return set(part.signatures)
        case parts.Nested():
            return _inside(part.tree)
    return set()


def _inside(node: AST) -> set[Signature]:
    kind = node.ast_type
    if kind is ASTType.SymbolicAtom:
        return set(signatures(node))
    if kind in WITHOUT_PREDICATES:
        return set()
    return {signature for inner in children(node, kind) for signature in _inside(inner)}


def _literals(atom: parts.Atom) -> tuple[Literal, ...]:
    return tuple(Literal((atom.name, len(terms)), tuple(map(_pattern, terms))) for terms in atom.pool)


def _pattern(term: str) -> Term:
    """Return a term of a rule as a pattern; parts that have no definite shape become `any`."""
    if parts.VARIABLE.fullmatch(term):
        return Compound(_VARIABLE, (term,))
    terms = parts.arguments_of(term)
    return ANY if terms is None else Compound(term.partition("(")[0], tuple(map(_pattern, terms)))


# ---------------------------------------------------------------- evaluating


class Program:
    """A program of rules over shapes."""

    def __init__(self, rules: Sequence[Shaped]) -> None:
        self._rules = rules
        self._by_use: dict[Signature, list[int]] = {}
        for index, rule in enumerate(rules):
            for signature in sorted({literal.signature for pool in rule.body for literal in pool}):
                self._by_use.setdefault(signature, []).append(index)
        self._known: dict[Signature, set[Atom]] = {}  # what follows without facts
        self._fired = self._follow(self._known, {index for index, rule in enumerate(rules) if not rule.body})

    def fired(self, facts: Iterable[Compound]) -> frozenset[int]:
        """Return the indices of the rules that fire for facts, given as shapes of atoms."""
        known = {signature: set(atoms) for signature, atoms in self._known.items()}
        changed: set[Signature] = set()
        for fact in facts:
            _add(known, (fact.name, len(fact.args)), fact.args, changed)
        waiting = {index for signature in changed for index in self._by_use.get(signature, ())}
        return self._fired | self._follow(known, waiting)

    def _follow(self, known: dict[Signature, set[Atom]], waiting: set[int]) -> frozenset[int]:
        """Add to `known` all consequences of firing the waiting rules; return the indices of the rules that fire."""
        found: set[int] = set()
        while waiting:
            changed: set[Signature] = set()
            for index in sorted(waiting):
                if self._fire(self._rules[index], known, changed):
                    found.add(index)
            waiting = {index for signature in changed for index in self._by_use.get(signature, ())}
        return frozenset(found)

    def _fire(self, rule: Shaped, known: dict[Signature, set[Atom]], changed: set[Signature]) -> bool:
        """Add the heads that one rule derives; return whether it fires."""
        fires = False
        for literals in product(*rule.body):
            for binding in _bindings(literals, known):
                bound = _equated(rule.equal, binding)
                if bound is not None:
                    fires = True
                    for head in rule.heads:
                        args = tuple(_cut(_instance(arg, bound), _DEEPEST) for arg in head.args)
                        _add(known, head.signature, args, changed)
        return fires

    def needed(self, fired: Iterable[int], outputs: Iterable[Signature]) -> frozenset[int]:
        """Return the fired rules on which predicates in `outputs` depend."""
        by_head: dict[Signature, list[int]] = {}
        for index in fired:
            for head in self._rules[index].heads:
                by_head.setdefault(head.signature, []).append(index)
        found: set[int] = set()
        waiting = set(outputs)
        seen: set[Signature] = set()
        while waiting:
            signature = waiting.pop()
            seen.add(signature)
            for index in by_head.get(signature, ()):
                if index not in found:
                    found.add(index)
                    waiting |= self._rules[index].uses - seen
        return frozenset(found)


def _add(known: dict[Signature, set[Atom]], signature: Signature, args: Atom, changed: set[Signature]) -> None:
    atoms = known.setdefault(signature, set())
    everything = (ANY,) * len(args)
    if args in atoms or everything in atoms:
        return
    if len(atoms) >= _MOST_SHAPES:
        atoms.clear()
        args = everything
    atoms.add(args)
    changed.add(signature)


def _bindings(literals: Sequence[Literal], known: Mapping[Signature, set[Atom]]) -> list[dict[str, Term]]:
    """Return the bindings of variables under which every literal is among the known shapes."""
    found: list[dict[str, Term]] = [{}]
    for literal in literals:
        atoms = known.get(literal.signature, ())
        extended: dict[tuple[Term, ...], dict[str, Term]] = {}  # by values: all name the same variables in one order
        for binding in found:
            for atom in atoms:
                trial: dict[str, Term] | None = binding
                for pattern, arg in zip(literal.args, atom, strict=True):
                    trial = None if trial is None else _matched(pattern, arg, trial)
                if trial is not None:
                    extended.setdefault(tuple(trial.values()), trial)
        found = list(extended.values())
    return found


def _matched(pattern: Term, term: Term, binding: dict[str, Term]) -> dict[str, Term] | None:
    """Return the binding extended so that a pattern has the shape `term`; None if that is impossible."""
    if pattern == ANY or not isinstance(pattern, Compound):
        return binding
    if pattern.name == _VARIABLE:
        name = str(pattern.args[0])
        both = _met(binding.get(name, ANY), term)
        return None if both is None else {**binding, name: both}
    if term == ANY:
        term = Compound(pattern.name, (ANY,) * len(pattern.args))
    if not isinstance(term, Compound) or (term.name, len(term.args)) != (pattern.name, len(pattern.args)):
        return None
    found: dict[str, Term] | None = binding
    for inner, arg in zip(pattern.args, term.args, strict=True):
        found = None if found is None else _matched(inner, arg, found)
    return found


def _met(a: Term, b: Term) -> Term | None:
    """Return the shape of the terms that have both shapes; None if no term has."""
    if a == ANY:
        return b
    if b == ANY or a == b:
        return a
    if not isinstance(a, Compound) or not isinstance(b, Compound):
        return None
    if a.name != b.name or len(a.args) != len(b.args):
        return None
    args = [_met(x, y) for x, y in zip(a.args, b.args, strict=True)]
    return None if None in args else Compound(a.name, tuple(arg for arg in args if arg is not None))


def _equated(pairs: Sequence[tuple[Term, Term]], binding: dict[str, Term]) -> dict[str, Term] | None:
    """Return the binding refined by equations in order; None if one cannot hold."""
    found: dict[str, Term] | None = binding
    for left, right in pairs:
        for pattern, other in ((left, right), (right, left)):
            found = None if found is None else _matched(pattern, _instance(other, found), found)
    return found


def _instance(pattern: Term, binding: Mapping[str, Term]) -> Term:
    if not isinstance(pattern, Compound):
        return ANY
    if pattern.name == _VARIABLE:
        return binding.get(str(pattern.args[0]), ANY)
    return Compound(pattern.name, tuple(_instance(arg, binding) for arg in pattern.args))
