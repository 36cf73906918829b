"""The shapes of all atoms that rule files can derive in any belief.

The rules are read with `any` for every value that is not written down: a query's answer, a bound, an object. That gives
for each predicate a finite set of argument patterns, each with its rules. The set is an overestimate: an atom that no
pattern matches is derived in no belief.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Final

from clingo.ast import AST, ASTSequence, ASTType, ComparisonOperator, Sign

from skolem.reasoner.rulebook.files import RuleFile
from skolem.reasoner.rulebook.parts import Signature
from skolem.reasoner.rulebook.validate import INPUT, OUTPUT, constant_value, signatures
from skolem.reasoner.terms import ANY, Compound, Term, from_symbol
from skolem.traces.errors import Fault

_DEEPEST: Final = 5  # deeper terms are cut off, so that there are finitely many
_OPEN: Final = INPUT | OUTPUT  # inputs and words: any argument is possible

Binding = dict[str, Term]
Constants = Mapping[str, int | None]  # the value that `#const` gives a name; None if it is no plain number
Tuple = tuple[Term, ...]


@dataclass(frozen=True, slots=True)
class Source:
    """A rule in its file; two are equal if they stand at the same position.

    Attributes:
        name: Name of its file, without `.lp`.
        line: Where it begins, from 1.
        column: Where it begins, from 1.
        file: Its file.
        statement: Its syntax tree.
    """

    name: str
    line: int
    column: int
    file: RuleFile = field(compare=False)
    statement: AST = field(compare=False)

    @classmethod
    def of(cls, file: RuleFile, statement: AST) -> "Source":
        """Return the source of a statement."""
        begin = statement.location.begin
        return cls(file.name, begin.line, begin.column, file, statement)

    def fault(self, message: str) -> Fault:
        """Return a fault at this position."""
        return self.file.fault(self.line, self.column, message)


@dataclass(slots=True)
class Shapes:
    """Argument patterns by predicate.

    Attributes:
        open: Predicates for which any arguments are possible.
        derived: By predicate, every pattern of its arguments with the rules that give it, in order of appearance.
    """

    open: frozenset[Signature] = _OPEN
    derived: dict[Signature, dict[Tuple, list[Source]]] = field(default_factory=dict)

    def of(self, name: str, arity: int) -> Mapping[Tuple, Sequence[Source]]:
        """Return the patterns of a predicate."""
        return self.derived.get((name, arity), {})

    def every(self, name: str, arity: int) -> Iterator[tuple[Tuple, Source]]:
        """Yield every pattern of a predicate with each rule that gives it."""
        for args, sources in self.of(name, arity).items():
            for source in sources:
                yield args, source

    def add(self, signature: Signature, found: Tuple, source: Source) -> bool:
        """Add a pattern; return whether the pattern or its source is new."""
        sources = self.derived.setdefault(signature, {}).setdefault(found, [])
        if source in sources:
            return False
        sources.append(source)
        return True


class Kept:
    """A node of a syntax tree that is read many times: clingo makes new objects for its parts at each access."""

    def __init__(self, node: AST) -> None:
        self.node = node
        self.ast_type = node.ast_type

    def __getattr__(self, name: str) -> Any:
        part = getattr(self.node, name)
        if isinstance(part, AST):
            part = Kept(part)
        elif isinstance(part, ASTSequence):
            part = tuple(map(Kept, part))
        setattr(self, name, part)
        return part

    def __str__(self) -> str:
        return str(self.node)


@lru_cache(1 << 12)
def kept(statement: AST) -> Kept:
    """Return the tree of a statement; the rules that ship are read again with every file that is checked."""
    return Kept(statement)


def shapes_of(files: Sequence[tuple[RuleFile, Sequence[AST]]], uncertain: frozenset[Signature] = frozenset()) -> Shapes:
    """Return the shapes of all atoms that sound rule files can derive.

    Args:
        files: Each file with its statements.
        uncertain: Predicates that may lack rules, so that any arguments are possible.
    """
    rules = [Source.of(file, s) for file, statements in files for s in statements if s.ast_type is ASTType.Rule]
    constants = constants_of(files)
    trees = {source: kept(source.statement) for source in rules}
    needs = {source: set(_needed(source.statement)) for source in rules}
    shapes = Shapes(_OPEN | uncertain)
    due = rules
    while due:
        changed = {
            signature
            for source in due
            for signature, found in list(_heads(trees[source], shapes, constants))
            if signature not in _OPEN and shapes.add(signature, found, source)
        }
        due = [source for source in rules if needs[source] & changed]
    return shapes


def stated(rule: AST, constants: Constants) -> Iterator[tuple[Signature, Tuple]]:
    """Yield the predicates and patterns in the head of a rule, with `any` for each variable."""
    symbol = kept(rule).head.atom.symbol
    for term in symbol.arguments if symbol.ast_type is ASTType.Pool else [symbol]:
        for found in _patterns(term, {}, constants):
            yield (term.name, len(term.arguments)), found.args if isinstance(found, Compound) else ()


def constants_of(files: Iterable[tuple[RuleFile, Sequence[AST]]]) -> Constants:
    """Return the values that `#const` gives names."""
    found = [s for _, statements in files for s in statements if s.ast_type is ASTType.Definition]
    return {s.name: constant_value(s.value, {}) for s in found}


def _needed(rule: AST) -> Iterator[Signature]:
    for literal in rule.body:
        if literal.ast_type is ASTType.Literal and literal.atom.ast_type is ASTType.SymbolicAtom:
            yield from signatures(literal.atom)


def _heads(rule: Kept, shapes: Shapes, constants: Constants) -> Iterator[tuple[Signature, Tuple]]:
    symbol = rule.head.atom.symbol
    terms = symbol.arguments if symbol.ast_type is ASTType.Pool else [symbol]
    for binding in bindings(rule.body, shapes, constants):
        for term in terms:
            for found in _patterns(term, binding, constants):
                args = found.args if isinstance(found, Compound) else ()
                yield (term.name, len(term.arguments)), tuple(_cut(arg, _DEEPEST) for arg in args)


def bindings(body: Iterable[Kept], shapes: Shapes, constants: Constants) -> list[Binding]:
    """Return the possible bindings of the variables of a body."""
    positive = [e for e in body if e.ast_type is ASTType.Literal and e.sign == Sign.NoSign]
    found: list[Binding] = [{}]
    for literal in positive:
        if literal.atom.ast_type is ASTType.SymbolicAtom:
            found = _distinct(b for old in found for b in _matched(literal.atom.symbol, old, shapes, constants))
    for literal in positive:
        if literal.atom.ast_type is ASTType.Comparison:
            found = _distinct(b for old in found for b in _compared(literal.atom, old, constants))
    return found


def _matched(atom: Kept, binding: Binding, shapes: Shapes, constants: Constants) -> Iterator[Binding]:
    if atom.ast_type is not ASTType.Function:
        yield binding
        return
    signature = (atom.name, len(atom.arguments))
    for args in [(ANY,) * signature[1]] if signature in shapes.open else shapes.of(*signature):
        new: Binding | None = dict(binding)
        for argument, value in zip(atom.arguments, args, strict=True):
            new = None if new is None else _bound(argument, value, new, constants)
        if new is not None:
            yield new


def _compared(comparison: Kept, binding: Binding, constants: Constants) -> Iterator[Binding]:
    """Yield the bindings under which a comparison may hold; only `V = term` restricts them."""
    guard = comparison.guards[0]
    left, right = comparison.term, guard.term
    if len(comparison.guards) != 1 or guard.comparison != ComparisonOperator.Equal:
        yield binding
        return
    if right.ast_type is ASTType.Variable:
        left, right = right, left
    if left.ast_type is not ASTType.Variable:
        yield binding
        return
    if left.name in binding:
        for target in right.arguments if right.ast_type is ASTType.Pool else [right]:
            new = _bound(target, binding[left.name], dict(binding), constants)
            for value in () if new is None else _patterns(target, new, constants):
                joined = meet(binding[left.name], value)
                if new is not None and joined is not None:
                    yield new | {left.name: joined}
        return
    for value in _patterns(right, binding, constants):
        yield binding | {left.name: value}


def _bound(argument: Kept, value: Term, binding: Binding, constants: Constants) -> Binding | None:
    """Return the binding extended so that an argument matches a pattern; None if that is impossible."""
    if argument.ast_type is ASTType.Variable:
        if argument.name == "_":
            return binding
        joined = meet(binding.get(argument.name, ANY), value)
        return None if joined is None else binding | {argument.name: joined}
    if argument.ast_type is ASTType.Function and not argument.external:
        if not isinstance(value, Compound):
            value = Compound(argument.name, tuple([ANY] * len(argument.arguments))) if value == ANY else value
        if not isinstance(value, Compound) or (value.name, len(value.args)) != (argument.name, len(argument.arguments)):
            return None
        found: Binding | None = binding
        for inner, part in zip(argument.arguments, value.args, strict=True):
            found = None if found is None else _bound(inner, part, found, constants)
        return found
    patterns = list(_patterns(argument, binding, constants))
    return binding if any(meet(p, value) is not None for p in patterns) else None


def _patterns(term: Kept, binding: Binding, constants: Constants) -> Iterator[Term]:
    match term.ast_type:
        case ASTType.Variable:
            yield binding.get(term.name, ANY)
        case ASTType.SymbolicTerm:
            name = str(term.symbol)
            value = constants[name] if name in constants else from_symbol(term.symbol)
            yield ANY if value is None else value
        case ASTType.Pool:
            for each in term.arguments:
                yield from _patterns(each, binding, constants)
        case ASTType.Function if not term.external:
            choices: list[Tuple] = [()]
            for argument in term.arguments:
                choices = [(*c, p) for c in choices for p in _patterns(argument, binding, constants)]
            for args in choices:
                yield Compound(term.name, args) if args or not term.name else term.name
        case ASTType.Interval:
            ends = (constant_value(end, constants) for end in (term.left, term.right))
            yield from (end for end in ends if end is not None)
            yield ANY
        case _:
            computed = constant_value(term.node, constants)
            yield ANY if computed is None else computed


def meet(a: Term, b: Term) -> Term | None:
    """Return the pattern of the terms that both patterns match; None if there are none."""
    if a == ANY or b == ANY:
        return b if a == ANY else a
    if isinstance(a, Compound) and isinstance(b, Compound) and (a.name, len(a.args)) == (b.name, len(b.args)):
        parts = [meet(x, y) for x, y in zip(a.args, b.args, strict=True)]
        known = tuple(part for part in parts if part is not None)
        return Compound(a.name, known) if len(known) == len(parts) else None
    return a if a == b else None


def _cut(term: Term, depth: int) -> Term:
    if not isinstance(term, Compound):
        return term
    return Compound(term.name, tuple(_cut(arg, depth - 1) for arg in term.args)) if depth else ANY


def _distinct(found: Iterable[Binding]) -> list[Binding]:
    return list({tuple(sorted((k, str(v)) for k, v in b.items())): b for b in found}.values())
