"""The checks of rule files on their syntax trees; every fault has a position.

Rules have exactly one answer set, by construction: facts and rules with one atom as head, no recursion through negation
or an aggregate. What they derive may be of any size: whoever loads rules from others bounds it. Input and output
predicates are named here; every other predicate that is used must be defined, and the other way round.
"""

import inspect
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Final

from clingo import SymbolType, ast
from clingo.ast import AST, ASTType

from skolem.reasoner.rulebook.files import GREATEST, RuleFile
from skolem.reasoner.rulebook.parts import Atom, Nested, Part, Signature, Statement
from skolem.reasoner.rulebook.vocabulary import WORD_FACTS
from skolem.traces.errors import Fault

_FaultAt = Callable[[str], Fault]  # makes a fault at a position from a message
_At = Callable[[AST], _FaultAt]

INPUT: Final[frozenset[Signature]] = frozenset(
    {("goal", 1), ("posed", 1), ("open", 1), ("lambda", 3), ("kind", 2)}
)  # given as facts
OUTPUT: Final[frozenset[Signature]] = frozenset(WORD_FACTS.items())  # read without `#show`
_ALLOWED: Final = frozenset(
    {ASTType.Rule, ASTType.Comment, ASTType.ShowSignature, ASTType.ShowTerm, ASTType.Defined, ASTType.Definition}
)
_NAMES: Final = {
    ASTType.Script: "#script",
    ASTType.External: "#external",
    ASTType.Program: "#program",
    ASTType.Minimize: "#minimize and weak constraints",
    ASTType.TheoryDefinition: "#theory",
    ASTType.Edge: "#edge",
    ASTType.Heuristic: "#heuristic",
    ASTType.ProjectAtom: "#project",
    ASTType.ProjectSignature: "#project",
}
_PARTS: Final[dict[ASTType, tuple[str, ...]]] = {  # of frequent nodes; asking clingo for the others takes longer
    ASTType.Rule: ("head", "body"),
    ASTType.Literal: ("atom",),
    ASTType.SymbolicAtom: ("symbol",),
    ASTType.Function: ("arguments",),
    ASTType.SymbolicTerm: (),
    ASTType.Variable: (),
}
WITHOUT_PREDICATES: Final = frozenset(  # comparisons, and terms that may stand where predicates may
    {
        ASTType.Comparison,
        ASTType.Guard,
        ASTType.Function,
        ASTType.Pool,
        ASTType.Interval,
        ASTType.BinaryOperation,
        ASTType.UnaryOperation,
        ASTType.SymbolicTerm,
        ASTType.Variable,
    }
)
# Signs in the text of terms that may be wrong: a @function, a text, a sum or product, a number of ten digits, an
# interval, #inf. Most rules have none, and text is far quicker to search than a tree.
_WORTH_A_LOOK: Final = re.compile(r'[-+*@"#]|\d{10}|\.\.')
_PERHAPS_NUMBERS: Final = frozenset({ASTType.SymbolicTerm, ASTType.Function, ASTType.BinaryOperation})
_ARITHMETIC: Final[dict[int, Callable[[int, int], int]]] = {
    ast.BinaryOperator.Plus: operator.add,
    ast.BinaryOperator.Minus: operator.sub,
    ast.BinaryOperator.Multiplication: operator.mul,
    ast.BinaryOperator.Division: lambda a, b: (abs(a) // abs(b)) * (1 if a * b > 0 else -1),  # towards 0
    ast.BinaryOperator.Modulo: lambda a, b: (abs(a) % abs(b)) * (1 if a > 0 else -1),
    ast.BinaryOperator.Power: lambda a, b: a**b,
}
_GREATEST_POWER: Final = 64
_WIDEST: Final = 10_000  # most numbers in an interval
_LONGEST: Final = 20  # digits of a number in a fault


@dataclass(frozen=True, slots=True)
class Checked:
    """The faults of statements, and their consequences.

    Attributes:
        faults: All faults, with their positions.
        refused: Statements that are not examined further.
        uncertain: Predicates that lack some rules, or may lack them once a fault is mended.
    """

    faults: list[Fault]
    refused: list[Statement]
    uncertain: frozenset[Signature]


def check(files: Sequence[tuple[RuleFile, Sequence[Statement]]], queries_type: type, whole: bool = True) -> Checked:
    """Return every fault of statements; the statements of all files are judged together.

    Args:
        files: Each file with its statements.
        queries_type: The class whose public methods are the @functions.
        whole: Whether every file could be parsed; if not, undefined and unused names are no faults.
    """
    definitions = (s.tree for _, statements in files for s in statements if s.kind is ASTType.Definition)
    constants = {s.name: value for s in definitions if (value := constant_value(s.value, {})) is not None}
    seen = _Seen(constants, any(abs(value) > GREATEST for value in constants.values()))
    for file, statements in files:
        for statement in statements:
            seen.read(file, statement)
    names = _check_names(seen, whole)
    faults = [*seen.faults, *_check_calls(seen, queries_type), *names.faults, *_check_stratified(seen)]
    faults += _check_words(seen)
    return Checked(faults, seen.refused, names.uncertain | seen.missing)


def signatures(atom: AST) -> list[Signature]:
    """Return the predicates of a symbolic atom: one, or several if it is a pool."""
    return _signatures(atom.symbol)


def _signatures(symbol: AST) -> list[Signature]:
    kind = symbol.ast_type
    if kind is ASTType.Function:
        return [(symbol.name, len(symbol.arguments))]
    terms = symbol.arguments if kind is ASTType.Pool else ()
    return [(term.name, len(term.arguments)) for term in terms if term.ast_type is ASTType.Function]


def constant_value(node: AST, constants: Mapping[str, int | None]) -> int | None:
    """Return the value of a constant numeric term without 32-bit overflow; None if it has none."""
    match node.ast_type:
        case ASTType.SymbolicTerm:
            number = node.symbol.type is SymbolType.Number
            return node.symbol.number if number else constants.get(str(node.symbol))
        case ASTType.Function if not node.arguments and not node.external:
            return constants.get(node.name)
        case ASTType.BinaryOperation if node.operator_type in _ARITHMETIC:
            left, right = constant_value(node.left, constants), constant_value(node.right, constants)
            return None if left is None or right is None else _computed(node.operator_type, left, right)
        case ASTType.UnaryOperation if node.operator_type == ast.UnaryOperator.Minus:
            value = constant_value(node.argument, constants)
            return None if value is None else -value
    return None


def _computed(operation: int, left: int, right: int) -> int | None:
    """Return the result of an operation on two numbers; None if it is undefined, or a number in it a fault by itself.

    A power that does not fit 32 bits by far is replaced by a smaller one that does not fit them either.
    """
    power = operation == ast.BinaryOperator.Power
    if (right < 0 if power else right == 0) or max(abs(left), abs(right)) > GREATEST:
        return None
    if power and right > _GREATEST_POWER:
        right = _GREATEST_POWER + right % 2
    return _ARITHMETIC[operation](left, right)


@dataclass(frozen=True, slots=True)
class _Use:
    """A predicate in a body; `strict` under `not`, in an aggregate or in a condition."""

    signature: Signature
    place: _FaultAt
    strict: bool


@dataclass(slots=True)
class _Seen:
    """The record of the statements read so far.

    `constants` are the numbers that `#const` names; `large` says whether one of them does not fit 32 bits.
    """

    constants: dict[str, int]
    large: bool
    heads: list[tuple[Signature, _FaultAt]] = field(default_factory=list)
    uses: list[_Use] = field(default_factory=list)
    calls: list[tuple[str, int, _FaultAt]] = field(default_factory=list)
    declared: set[Signature] = field(default_factory=set)
    shown: set[Signature] = field(default_factory=set)
    depends: dict[Signature, set[Signature]] = field(default_factory=dict)
    strict: list[tuple[Signature, _Use]] = field(default_factory=list)
    words: list[tuple[Signature, _FaultAt, list[_Use]]] = field(default_factory=list)  # derived, not stated
    faults: list[Fault] = field(default_factory=list)
    refused: list[Statement] = field(default_factory=list)
    missing: set[Signature] = field(default_factory=set)  # predicates in the heads of refused statements

    def read(self, file: RuleFile, statement: Statement) -> None:
        def at(node: AST) -> _FaultAt:
            return lambda message: file.fault(node.location.begin.line, node.location.begin.column, message)

        before = len(self.faults)
        self._read(statement, at)
        if len(self.faults) > before:
            self.refused.append(statement)
            about = statement.tree if statement.head is None else statement.head.tree
            self.missing.update(use.signature for use in _uses_inside(about, at, strict=False))

    def _read(self, statement: Statement, at: _At) -> None:
        kind, tree, head = statement.kind, statement.tree, statement.head
        if kind is ASTType.Program and tree.name == "base" and not tree.parameters:
            return  # clingo begins each file with it; `parse` refuses a second one
        if kind not in _ALLOWED:
            self.faults.append(at(tree)(f"{_NAMES.get(kind, str(kind))} is not allowed in a rule file; leave it out"))
            return
        for part in (Nested(tree, str(tree)),) if head is None else (head, *statement.body):
            if self.large or _WORTH_A_LOOK.search(part.text):
                self._read_terms(part.tree, at)
        if kind is ASTType.Defined:
            self.declared.add((tree.name, tree.arity))
        elif kind is ASTType.ShowSignature:
            self.shown.add((tree.name, tree.arity))
            if tree.name:
                self.uses.append(_Use((tree.name, tree.arity), at(tree), strict=False))
        uses = [use for part in statement.body for use in _uses(part, at)]
        self.uses += uses
        if head is not None:
            self._read_head(head, at, uses)

    def _read_terms(self, part: AST, at: _At) -> None:
        for node, kind in descend(part):
            if kind is ASTType.Function and node.external:
                self.calls.append((node.name, len(node.arguments), at(node)))
            if kind is ASTType.SymbolicTerm and node.symbol.type is SymbolType.String:
                self.faults.append(at(node)(f'{node} is a text; rules are written in constants: a_whim, not "a whim"'))
            if kind is ASTType.SymbolicTerm and node.symbol.type in (SymbolType.Infimum, SymbolType.Supremum):
                self.faults.append(at(node)(f"{node} is no term of the rules; leave the bound out, or write any"))
            if kind is ASTType.Interval:
                ends = [constant_value(end, self.constants) for end in (node.left, node.right)]
                if ends[0] is not None and ends[1] is not None and ends[1] - ends[0] >= _WIDEST:
                    self.faults.append(
                        at(node)(f"{node} is more than {_WIDEST} numbers; bound it by something smaller")
                    )
            value = constant_value(node, self.constants) if kind in _PERHAPS_NUMBERS else None
            if value is not None and abs(value) > GREATEST:
                said = value if abs(value) < 10**_LONGEST else f"a number of more than {_LONGEST} digits"
                self.faults.append(at(node)(f"{node} is {said}, which does not fit 32 bits: at most {GREATEST}"))

    def _read_head(self, head: Part, at: _At, uses: list[_Use]) -> None:
        derived = head.signatures if isinstance(head, Atom) and not head.sign else _derived(head.tree)
        if isinstance(derived, str):
            self.faults.append(at(head.tree)(derived))
            return
        for signature in derived:
            self.heads.append((signature, at(head.tree)))
            self.depends.setdefault(signature, set()).update(use.signature for use in uses)
            self.strict += [(signature, use) for use in uses if use.strict]
            if signature in OUTPUT and uses:
                self.words.append((signature, at(head.tree), uses))


def _derived(head: AST) -> list[Signature] | str:
    """Return the predicates of a head that is one atom; for other heads a text that says why they are not allowed."""
    kind = head.ast_type
    if kind is ASTType.Disjunction:
        return "a rule has one atom as its head: no disjunction, no condition"
    if kind is not ASTType.Literal:
        return "a rule has one atom as its head: no choice, no aggregate"
    atom = head.atom
    kind = atom.ast_type
    if kind is ASTType.BooleanConstant:
        return "constraints are not allowed: a rule file excludes nothing; derive rejected(S, Reason)"
    found = signatures(atom) if kind is ASTType.SymbolicAtom and not head.sign else []
    return found or "a rule has one atom as its head: no comparison, no 'not', no '-'"


def descend(node: AST) -> Iterator[tuple[AST, ASTType]]:
    """Yield a node and everything inside it, each with its type."""
    kind = node.ast_type
    yield node, kind
    for inner in children(node, kind):
        yield from descend(inner)


def children(node: AST, kind: ASTType) -> Iterator[AST]:
    """Yield the child nodes of a node of this type."""
    for key in _PARTS[kind] if kind in _PARTS else node.child_keys:
        child = getattr(node, key)
        yield from [child] if isinstance(child, AST) else child or ()


def _uses(part: Part, at: _At) -> Iterator[_Use]:
    """Yield the predicates in one part of a body."""
    if isinstance(part, Atom):
        for signature in part.signatures:
            yield _Use(signature, lambda message: at(part.place)(message), bool(part.sign))  # few faults, many places
    elif isinstance(part, Nested):
        yield from _uses_inside(part.tree, at, strict=False)


def _uses_inside(element: AST, at: _At, strict: bool) -> Iterator[_Use]:
    kind = element.ast_type
    if kind is ASTType.SymbolicAtom:
        symbol = element.symbol
        for signature in _signatures(symbol):
            yield _Use(signature, at(symbol), strict)
    elif kind not in WITHOUT_PREDICATES:
        strict = strict or kind in (ASTType.BodyAggregate, ASTType.Aggregate, ASTType.ConditionalLiteral)
        strict = strict or (kind is ASTType.Literal and bool(element.sign))
        for inner in children(element, kind):
            yield from _uses_inside(inner, at, strict)


def reached(start: Signature, uses: Mapping[Signature, set[Signature]]) -> set[Signature]:
    """Return the predicates that one depends on, directly or through others; itself only if it is recursive."""
    found: set[Signature] = set()
    waiting = [start]
    while waiting:
        new = uses.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


def _check_calls(seen: _Seen, queries_type: type) -> Iterator[Fault]:
    known = query_arities(queries_type)
    for name, arity, fault in seen.calls:
        if name not in known:
            close = get_close_matches(name, sorted(known), 1)
            hint = f"; did you mean @{close[0]}?" if close else f" (known: {', '.join(sorted(known))})"
            yield fault(f"@{name} is not a query{hint}")
        elif known[name] != arity:
            yield fault(f"@{name} takes {known[name]} argument{'s' * (known[name] != 1)}, not {arity}")


def query_arities(queries_type: type) -> dict[str, int]:
    """Return every public method of a class with its number of arguments."""
    methods = inspect.getmembers(queries_type, inspect.isfunction)
    return {name: len(inspect.signature(f).parameters) - 1 for name, f in methods if not name.startswith("_")}


def _check_names(seen: _Seen, whole: bool) -> Checked:
    """Return the faults of derived inputs and, if every file is `whole`, of undefined and unused predicates."""
    defined = {signature for signature, _ in seen.heads} | seen.declared | seen.missing | INPUT
    wanted = {use.signature for use in seen.uses} | seen.missing | OUTPUT
    faults: list[Fault] = []
    uncertain: set[Signature] = set()
    for use in seen.uses:
        if use.signature not in defined:
            uncertain.add(use.signature)
            remedy = _meant(_near(use.signature, defined)) or "define it by a rule"
            faults += [use.place(f"{_text(use.signature)} is never defined; {remedy}")] if whole else []
    for signature, fault in seen.heads:
        if signature in INPUT:
            remedy = "give your predicate another name"
            faults.append(fault(f"{_text(signature)} is given from outside and cannot be derived; {remedy}"))
        elif whole and signature not in wanted:
            near = _near(signature, wanted | INPUT)
            remedy = _meant(near) or f"use it in a rule, leave it out, or hand it over by #show {_text(signature)}."
            faults.append(fault(f"{_text(signature)} is never used; {remedy}"))
            uncertain.update(near)
    return Checked(faults, [], frozenset(uncertain))


def _near(signature: Signature, known: Iterable[Signature]) -> list[Signature]:
    """Return the known predicates that may be meant: those of the same name, else those of similar names."""
    known = set(known) - {signature}
    same_name = sorted(other for other in known if other[0] == signature[0])
    close = get_close_matches(signature[0], sorted({name for name, _ in known}), 2)
    return same_name or sorted(other for other in known if other[0] in close)


def _meant(near: Sequence[Signature]) -> str:
    return f"did you mean {' or '.join(map(_text, near))}?" if near else ""


def _text(signature: Signature) -> str:
    return f"{signature[0]}/{signature[1]}"


def _check_stratified(seen: _Seen) -> Iterator[Fault]:
    for head, use in seen.strict:
        if use.signature == ("goal", 1):
            remedy = "derive a predicate from it in a rule of its own, and put that there"
            yield use.place(f"goal/1 may not stand under 'not', in an aggregate or in a condition; {remedy}")
        if head in {use.signature} | reached(use.signature, seen.depends):
            how = "negation, an aggregate or a condition"
            circle = f"{_text(head)} depends on itself through {how}, by {_text(use.signature)}"
            yield use.place(f"{circle}; let one of them do without the other")


def _check_words(seen: _Seen) -> Iterator[Fault]:
    """Yield a fault for each word whose meaning depends on a goal, since words are read before there is a goal."""
    for signature, fault, uses in seen.words:
        if any(not INPUT.isdisjoint({use.signature} | reached(use.signature, seen.depends)) for use in uses):
            yield fault(f"{_text(signature)} depends on a goal; a word has its meaning whatever is asked: state a fact")
