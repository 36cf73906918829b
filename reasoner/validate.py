"""What rule files may contain, checked on their syntax trees: every mistake with its place.

Rules have exactly one answer set, by construction: facts and rules with one atom as head, no recursion through negation
or an aggregate. What comes in and goes out is named; whatever else is used must be defined, and the other way round.
"""

import inspect
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any, Final

from clingo import SymbolType, ast
from clingo.ast import AST, ASTType

from skolem.reasoner.vocabulary import WORD_FACTS
from skolem.traces.errors import Fault

Signature = tuple[str, int]

INPUT: Final[frozenset[Signature]] = frozenset(
    {("goal", 1), ("posed", 1), ("open", 1), ("lambda", 3)}
)  # given as facts
OUTPUT: Final[frozenset[Signature]] = frozenset(WORD_FACTS.items())  # read without `#show`
MAX_BYTES: Final = 200_000
GREATEST: Final = 2**31 - 1  # clingo counts in 32 bits and wraps without a word

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
_PARTS: Final[dict[ASTType, tuple[str, ...]]] = {  # of frequent nodes; for others clingo is asked, which takes longer
    ASTType.Rule: ("head", "body"),
    ASTType.Literal: ("atom",),
    ASTType.SymbolicAtom: ("symbol",),
    ASTType.Function: ("arguments",),
    ASTType.SymbolicTerm: (),
    ASTType.Variable: (),
}
WITHOUT_PREDICATES: Final = frozenset(  # comparisons, and the terms that stand where predicates may stand too
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
_PERHAPS_NUMBERS: Final = frozenset({ASTType.SymbolicTerm, ASTType.Function, ASTType.BinaryOperation})
_SKIPPED_OR_TOKEN: Final = re.compile(
    r"""%\*.*?\*%|%[^\n]*|"(?:\\.|[^"\\])*"|(?P<include>\#include\b)|(?<![\w'])(?P<number>[1-9]\d*)\b""", re.DOTALL
)
_ARITHMETIC: Final[dict[int, Callable[[int, int], int]]] = {
    ast.BinaryOperator.Plus: operator.add,
    ast.BinaryOperator.Minus: operator.sub,
    ast.BinaryOperator.Multiplication: operator.mul,
}
_MESSAGE: Final = re.compile(r"(?P<file>.+?):(?P<line>\d+):(?P<column>\d+)(?:-[\d:]+)?: (?P<kind>\w+): (?P<text>.*)")
_UNSAFE: Final = re.compile(r":(?P<line>\d+):(?P<column>\d+)(?:-[\d:]+)?: note: '(?P<name>.+?)' is unsafe")


@dataclass(frozen=True, slots=True)
class RuleFile:
    """One rule file.

    Attributes:
        name: Its name without `.lp`.
        title: How faults call it.
        path: Where it was read; clingo's messages carry it.
        content: Its bytes.
        own: Whether it is a user's own file.
    """

    name: str
    title: str
    path: str
    content: bytes
    own: bool

    def fault(self, line: int, column: int, message: str) -> Fault:
        """Return a fault in this file, with the line it is about."""
        lines = self.content.decode(errors="replace").splitlines()
        return Fault(self.title, line, column, message, excerpt=lines[line - 1] if 0 < line <= len(lines) else "")


def parse(file: RuleFile) -> tuple[list[AST], list[Fault]]:
    """Return the statements of a rule file, or the faults for which it cannot be parsed."""
    if len(file.content) > MAX_BYTES:
        return [], [Fault(file.title, 0, 0, f"a rule file of {len(file.content)} bytes; at most {MAX_BYTES} are read")]
    try:
        text = file.content.decode()
    except UnicodeDecodeError as error:
        return [], [Fault(file.title, 0, 0, f"not UTF-8: byte {error.start}")]
    refused = [
        file.fault(*_place(text, match.start()), message)
        for match in _SKIPPED_OR_TOKEN.finditer(text)
        if (message := _token_refusal(match))
    ]
    if refused:
        return [], refused
    statements: list[AST] = []
    messages: list[str] = []
    try:
        ast.parse_files([file.path], statements.append, logger=lambda _code, message: messages.append(message))
    except RuntimeError:
        return [], explain(messages, [file])
    return [s for s in statements if s.ast_type is not ASTType.Comment], explain(messages, [file])


def _token_refusal(match: re.Match[str]) -> str:
    """Return why a piece of text is not allowed, of which the syntax tree says nothing any more."""
    if match["include"]:
        return "#include is not allowed: name each file"
    if match["number"] and int(match["number"]) > GREATEST:
        return f"{match['number']} does not fit 32 bits: at most {GREATEST}"
    return ""


def explain(messages: Iterable[str], files: Sequence[RuleFile]) -> list[Fault]:
    """Return what clingo's messages say about `files`, as faults."""
    by_path = {file.path: file for file in files}
    faults = []
    for message in messages:
        match = _MESSAGE.match(message)
        if match is None or match["file"] not in by_path:
            faults.append(Fault("rules", 0, 0, " ".join(message.split())))
            continue
        unsafe = list(_UNSAFE.finditer(message))
        line, column = (unsafe[0] if unsafe else match).group("line", "column")
        text = " ".join(message[match.start("text") :].split())
        if unsafe:
            names = ", ".join(dict.fromkeys(note["name"] for note in unsafe))
            text = f"unsafe variable {names}: each must occur in a positive literal of the body"
        faults.append(by_path[match["file"]].fault(int(line), int(column), text))
    return faults


def check(files: Sequence[tuple[RuleFile, Sequence[AST]]], queries_type: type) -> list[Fault]:
    """Return every fault of rule files that could be parsed; they are judged together.

    Args:
        files: Each file with its statements.
        queries_type: The class whose public methods are the @functions.
    """
    definitions = (s for _, statements in files for s in statements if s.ast_type is ASTType.Definition)
    seen = _Seen({s.name: value for s in definitions if (value := constant_value(s.value, {})) is not None})
    for file, statements in files:
        for statement in statements:
            seen.read(file, statement)
    return [*seen.faults, *_check_calls(seen, queries_type), *_check_names(seen), *_check_stratified(seen)]


def signatures(atom: AST) -> list[Signature]:
    """Return the predicates of a symbolic atom: one, or several if it is a pool."""
    symbol = atom.symbol
    kind = symbol.ast_type
    if kind is ASTType.Function:
        return [(symbol.name, len(symbol.arguments))]
    terms = symbol.arguments if kind is ASTType.Pool else ()
    return [(term.name, len(term.arguments)) for term in terms if term.ast_type is ASTType.Function]


def constant_value(node: AST, constants: Mapping[str, int]) -> int | None:
    """Return the number that a term stands for in every belief, as it should be; None if there is none."""
    match node.ast_type:
        case ASTType.SymbolicTerm:
            number = node.symbol.type is SymbolType.Number
            return node.symbol.number if number else constants.get(str(node.symbol))
        case ASTType.Function if not node.arguments and not node.external:
            return constants.get(node.name)
        case ASTType.BinaryOperation if node.operator_type in _ARITHMETIC:
            left, right = constant_value(node.left, constants), constant_value(node.right, constants)
            return None if left is None or right is None else _ARITHMETIC[node.operator_type](left, right)
    return None


def _place(text: str, offset: int) -> tuple[int, int]:
    return text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset)


@dataclass(frozen=True, slots=True)
class _Use:
    """A predicate in a body; `strict` under `not`, in an aggregate or in a condition."""

    signature: Signature
    place: Callable[[str], Fault]
    strict: bool


@dataclass(slots=True)
class _Seen:
    """Everything of interest in the statements read so far; `constants` are the numbers that `#const` names."""

    constants: dict[str, int]
    heads: list[tuple[Signature, Callable[[str], Fault]]] = field(default_factory=list)
    uses: list[_Use] = field(default_factory=list)
    calls: list[tuple[str, int, Callable[[str], Fault]]] = field(default_factory=list)
    declared: set[Signature] = field(default_factory=set)
    shown: set[Signature] = field(default_factory=set)
    depends: dict[Signature, set[Signature]] = field(default_factory=dict)
    strict: list[tuple[Signature, _Use]] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    def read(self, file: RuleFile, statement: AST) -> None:
        def at(node: Any) -> Callable[[str], Fault]:
            return lambda message: file.fault(node.location.begin.line, node.location.begin.column, message)

        kind = statement.ast_type
        if kind is ASTType.Program and statement.name == "base" and not statement.parameters:
            return
        if kind not in _ALLOWED:
            self.faults.append(at(statement)(f"{_NAMES.get(kind, str(kind))} is not allowed in a rule file"))
            return
        for node, its_kind in _descend(statement):
            if its_kind is ASTType.Function and node.external:
                self.calls.append((node.name, len(node.arguments), at(node)))
            if its_kind is ASTType.SymbolicTerm and node.symbol.type is SymbolType.String:
                self.faults.append(at(node)(f"{node} is a text; rules are written in constants"))
            value = constant_value(node, self.constants) if its_kind in _PERHAPS_NUMBERS else None
            if value is not None and abs(value) > GREATEST:
                self.faults.append(at(node)(f"{node} is {value}, which does not fit 32 bits: at most {GREATEST}"))
        if kind is ASTType.Defined:
            self.declared.add((statement.name, statement.arity))
        elif kind is ASTType.ShowSignature:
            self.shown.add((statement.name, statement.arity))
            if statement.name:
                self.uses.append(_Use((statement.name, statement.arity), at(statement), strict=False))
        elif kind in (ASTType.Rule, ASTType.ShowTerm):
            uses = [use for element in statement.body for use in _uses(element, at, strict=False)]
            self.uses += uses
            if kind is ASTType.Rule:
                self._read_head(statement.head, at, uses)

    def _read_head(self, head: AST, at: Callable[[Any], Callable[[str], Fault]], uses: list[_Use]) -> None:
        message = _refusal(head)
        if message:
            self.faults.append(at(head)(message))
            return
        for signature in signatures(head.atom):
            self.heads.append((signature, at(head)))
            self.depends.setdefault(signature, set()).update(use.signature for use in uses)
            self.strict += [(signature, use) for use in uses if use.strict]


def _refusal(head: AST) -> str:
    """Return why a head is not allowed; nothing if it is one atom."""
    kind = head.ast_type
    if kind is ASTType.Disjunction:
        return "a rule has one atom as its head: no disjunction, no condition"
    if kind is not ASTType.Literal:
        return "a rule has one atom as its head: no choice, no aggregate"
    atom = head.atom
    if atom.ast_type is ASTType.BooleanConstant:
        return "constraints are not allowed: a rule file excludes nothing; derive rejected(S, Reason)"
    if atom.ast_type is not ASTType.SymbolicAtom or head.sign or not signatures(atom):
        return "a rule has one atom as its head: no comparison, no 'not', no '-'"
    return ""


def _descend(node: AST) -> Iterator[tuple[AST, ASTType]]:
    """Yield a node and everything inside it, each with its type."""
    kind = node.ast_type
    yield node, kind
    for inner in children(node, kind):
        yield from _descend(inner)


def children(node: AST, kind: ASTType) -> Iterator[AST]:
    """Yield the nodes that a node of this type is made of."""
    for key in _PARTS[kind] if kind in _PARTS else node.child_keys:
        child = getattr(node, key)
        yield from [child] if isinstance(child, AST) else child or ()


def _uses(element: AST, at: Callable[[Any], Callable[[str], Fault]], strict: bool) -> Iterator[_Use]:
    """Yield the predicates in one part of a body."""
    kind = element.ast_type
    if kind is ASTType.SymbolicAtom:
        for signature in signatures(element):
            yield _Use(signature, at(element.symbol), strict)
    elif kind not in WITHOUT_PREDICATES:
        strict = strict or kind in (ASTType.BodyAggregate, ASTType.Aggregate, ASTType.ConditionalLiteral)
        strict = strict or (kind is ASTType.Literal and bool(element.sign))
        for inner in children(element, kind):
            yield from _uses(inner, at, strict)


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


def _check_names(seen: _Seen) -> Iterator[Fault]:
    defined = {signature for signature, _ in seen.heads} | seen.declared | INPUT
    wanted = {use.signature for use in seen.uses} | OUTPUT
    for use in seen.uses:
        if use.signature not in defined:
            yield use.place(f"{_text(use.signature)} is never defined{_near(use.signature, defined)}")
    for signature, fault in seen.heads:
        if signature in INPUT:
            yield fault(f"{_text(signature)} is given from outside and cannot be derived")
        elif signature not in wanted:
            yield fault(f"{_text(signature)} is never used{_near(signature, wanted | INPUT)}")


def _near(signature: Signature, known: Iterable[Signature]) -> str:
    known = set(known) - {signature}
    same_name = sorted(_text(other) for other in known if other[0] == signature[0])
    close = get_close_matches(signature[0], sorted({name for name, _ in known}), 2)
    near = same_name or sorted(_text(other) for other in known if other[0] in close)
    return f"; did you mean {' or '.join(near)}?" if near else ""


def _text(signature: Signature) -> str:
    return f"{signature[0]}/{signature[1]}"


def _check_stratified(seen: _Seen) -> Iterator[Fault]:
    for head, use in seen.strict:
        if use.signature == ("goal", 1):
            yield use.place("goal/1 may not stand under 'not', in an aggregate or in a condition")
        if head in _reachable(use.signature, seen.depends):
            how = "negation, an aggregate or a condition"
            yield use.place(f"{_text(head)} depends on itself through {how}, by {_text(use.signature)}")


def _reachable(start: Signature, depends: dict[Signature, set[Signature]]) -> set[Signature]:
    found, waiting = {start}, [start]
    while waiting:
        for signature in depends.get(waiting.pop(), ()):
            if signature not in found:
                found.add(signature)
                waiting.append(signature)
    return found
