"""The examination of rule files: they are parsed, checked, and grounded without a goal, and all faults collected.

A fault does not stop the examination. The faulty statement is set aside, and `Doubt` keeps what may be missing because
of it, so that no fault is reported that would vanish once the first one is mended.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import clingo
from clingo import ast
from clingo.ast import AST, ASTType

from skolem.reasoner.rulebook.arguments import Position
from skolem.reasoner.rulebook.files import RuleFile, explain, parse
from skolem.reasoner.rulebook.parts import Atom, Signature, Statement
from skolem.reasoner.rulebook.questions import CLINGO_OPTIONS
from skolem.reasoner.rulebook.validate import INPUT, OUTPUT, check
from skolem.reasoner.rulebook.vocabulary import WORD_FACTS, Vocabulary, read_vocabulary
from skolem.reasoner.terms import Compound, Term, from_symbol
from skolem.traces.errors import Fault, InternalError

_ABOUT_NAMES: Final = re.compile(r"info: atom does not occur in any rule head")  # the check of names says it better


@dataclass(frozen=True, slots=True)
class Doubt:
    """The parts of rule files that may be missing because of faults.

    Attributes:
        whole: Whether every statement was understood; if not, anything may be missing.
        uncertain: Predicates that may lack some of their rules.
        words: Whether some words may have no meaning because of a fault.
    """

    whole: bool = True
    uncertain: frozenset[Signature] = frozenset()
    words: bool = False

    def __bool__(self) -> bool:
        """Return whether anything may be missing."""
        return not self.whole or bool(self.uncertain) or self.words

    def about(self, needed: Iterable[Signature]) -> bool:
        """Return whether any of these predicates may lack rules."""
        return not self.whole or not self.uncertain.isdisjoint(needed)


@dataclass(frozen=True)
class Examined:
    """The result of an examination.

    Attributes:
        vocabulary: The words that the files define.
        faults: All faults, in no order.
        warnings: Statements that are allowed but probably not meant.
        doubt: The parts that may be missing because of the faults.
        files: Every file with its sound statements.
    """

    vocabulary: Vocabulary
    faults: tuple[Fault, ...]
    warnings: tuple[Fault, ...]
    doubt: Doubt
    files: Sequence[tuple[RuleFile, Sequence[Statement]]] = field(repr=False)

    @property
    def sources(self) -> tuple[tuple[RuleFile, Sequence[AST]], ...]:
        """Every file with the syntax trees of its sound statements."""
        return tuple((file, tuple(s.tree for s in statements)) for file, statements in self.files)


def examine(sources: Sequence[RuleFile], queries_type: type, complete: bool = True) -> Examined:
    """Return the examination of rule files that are loaded together.

    Args:
        sources: The files, in the order in which they are to be loaded.
        queries_type: The class whose public methods are the @functions.
        complete: Whether these are all files; if not, missing definitions are no faults.
    """
    faults: list[Fault] = []
    files: list[tuple[RuleFile, Sequence[Statement]]] = []
    for file in sources:
        trees, found = parse(file)
        faults += found
        files.append((file, [Statement.of(tree) for tree in trees]))
    whole = complete and not faults
    checked = check(files, queries_type, whole)
    faults += checked.faults
    kept = [(file, [s for s in statements if s not in checked.refused]) for file, statements in files]
    grounded, control = _grounded(kept, strict=whole and not faults)
    faults += grounded
    certain = whole and not checked.uncertain and not grounded
    try:
        words = _word_facts(control, kept)
    except ValueError as error:  # #inf, the greatest of nothing, or a term that is too deep
        faults += [Fault(file.title, 0, 0, f"a word is derived with {error}") for file in sources if not file.ships]
        words, certain = [], False
    vocabulary, wrong, warnings = read_vocabulary(words, certain)
    doubt = Doubt(whole, checked.uncertain, bool(wrong) or not certain)
    return Examined(vocabulary, tuple(dict.fromkeys([*faults, *wrong])), tuple(warnings), doubt, kept)


# ---------------------------------------------------------------- grounding without a goal


class _NoAnswers:
    """Queries without answers, for grounding facts alone."""

    def __getattr__(self, name: str) -> Callable[..., list[Term]]:
        return lambda *_: []


_Files = Sequence[tuple[RuleFile, Sequence[Statement]]]


def _grounded(files: _Files, strict: bool) -> tuple[list[Fault], clingo.Control]:
    """Return clingo's messages about rules as faults, and the rules grounded without those that clingo refuses.

    Args:
        files: The rules.
        strict: Whether every message is a fault; if not, messages about undefined atoms are none.
    """
    faults: list[Fault] = []
    left = [(file, list(statements)) for file, statements in files]
    while True:
        messages: list[str] = []
        control = _facts_alone((s for _, statements in left for s in statements), messages)
        kept = [m for m in messages if (strict and not faults) or not _ABOUT_NAMES.search(m)]
        found = explain(kept, [file for file, _ in left])
        faults += found
        if control is not None:
            return faults, control
        fewer = [(file, [s for s in statements if not _concerns(found, file, s)]) for file, statements in left]
        if sum(len(s) for _, s in fewer) == sum(len(s) for _, s in left):
            fewer = [(file, []) for file, _ in left]  # no message names a statement: drop all
        left = fewer


def _concerns(faults: Iterable[Fault], file: RuleFile, statement: Statement) -> bool:
    """Return whether any of the faults lies inside a statement."""
    begin, end = statement.tree.location.begin, statement.tree.location.end
    first, last = (begin.line, begin.column), (end.line, end.column)
    return any(fault.file == file.title and first <= (fault.line, fault.column) <= last for fault in faults)


def _facts_alone(statements: Iterable[Statement], messages: list[str]) -> clingo.Control | None:
    """Return the rules grounded without any question, or None if clingo refuses; its messages go to `messages`."""
    control = clingo.Control(list(CLINGO_OPTIONS), logger=lambda _code, text: messages.append(text), message_limit=100)
    with ast.ProgramBuilder(control) as builder:
        for statement in statements:
            builder.add(statement.tree)
        ast.parse_string("".join(f"#defined {name}/{arity}. " for name, arity in sorted(INPUT)), builder.add)
    try:
        control.ground([("base", [])], context=_NoAnswers())
    except RuntimeError as error:
        if not messages:
            raise InternalError(f"clingo stopped: {error}") from error
        return None
    return control


# ---------------------------------------------------------------- words


def _word_facts(control: clingo.Control, files: _Files) -> list[tuple[Compound, Position]]:
    """Return the atoms that give words a meaning, each with its position."""
    positions = _positions(files)
    found = []
    for signature in WORD_FACTS.items():
        for atom in control.symbolic_atoms.by_signature(*signature):
            fact = from_symbol(atom.symbol)
            assert isinstance(fact, Compound)
            found.append((fact, positions.get(str(fact)) or positions[f"{signature[0]}/{signature[1]}"]))
    return found


def _positions(files: _Files) -> Mapping[str, Position]:
    """Return the position of each word fact by its text, and of each predicate's first rule by `name/arity`."""
    found: dict[str, Position] = {}
    for file, statements in files:
        for statement in statements:
            head = statement.head
            if not isinstance(head, Atom):
                continue
            for name, arity in OUTPUT.intersection(head.signatures):
                position = Position(*_begin(statement.tree), file.fault, file.own, _arguments(head.place))
                text = head.text.replace(" ", "")
                if text not in found or (file.own and not found[text].own):  # a fact that ships, stated again, is own
                    found[text] = position
                found.setdefault(f"{name}/{arity}", position)
    return found


def _arguments(symbol: AST) -> tuple[tuple[int, int], ...]:
    """Return the line and column of each argument; empty for a pool."""
    return tuple(map(_begin, symbol.arguments)) if symbol.ast_type is ASTType.Function else ()


def _begin(node: AST) -> tuple[int, int]:
    begin = node.location.begin
    return begin.line, begin.column
