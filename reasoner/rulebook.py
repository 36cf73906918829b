"""The rule files: loaded, validated and parsed once; solved anew for every question."""

import hashlib
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Final

import clingo
from clingo import ast
from clingo.ast import AST, ASTType

from skolem.reasoner.terms import Compound, Term, from_symbol, to_symbol
from skolem.reasoner.validate import INPUT, RuleFile, check, explain, parse, signatures
from skolem.reasoner.vocabulary import WORD_FACTS, Place, Vocabulary, read_vocabulary
from skolem.traces.errors import Fault, InputError, InternalError

RULE_FILES: Final = (  # the table of contents of the folder rules/
    "vocabulary",  # words and their meanings
    "denote",  # what a description means
    "infer",  # from descriptions to properties to quantities
    "find",  # from descriptions to regions
    "look",
    "look_region",
    "weigh",
    "clear",
    "pick",
    "place",
    "move",
    "mutex",  # what may not hold together
    "regress",  # what one regression step hands over
)
# One thread, a fixed seed, every message; two models are asked for to notice a second one.
CLINGO_OPTIONS: Final = ("--parallel-mode=1", "--seed=1", "--warn=all", "--models=2")


@dataclass(frozen=True, slots=True)
class Answer:
    """The shown atoms of one answer set.

    Attributes:
        atoms: By predicate, the argument tuples of its atoms, sorted by text.
        ground_atoms: Number of atoms in the ground program: the measure of its size.
    """

    atoms: dict[str, list[tuple[Term, ...]]]
    ground_atoms: int


@dataclass(frozen=True)
class Rulebook:
    """Rule files that passed validation.

    Attributes:
        vocabulary: The words they define.
        files: File name to content, in the order in which they are loaded.
        warnings: What is allowed but probably not meant.
    """

    vocabulary: Vocabulary
    files: Mapping[str, bytes]
    warnings: tuple[Fault, ...]
    _statements: Mapping[str, Sequence[AST]] = field(repr=False)
    _sources: Sequence[RuleFile] = field(repr=False)
    _terms: dict[str, tuple[str, tuple[Term, ...]]] = field(default_factory=dict, repr=False)  # memo, by text

    @classmethod
    def load(cls, queries_type: type, extra: Sequence[Path] = ()) -> "Rulebook":
        """Return the rules that ship with the product and those of the user.

        Args:
            queries_type: The class whose public methods rules may call as @functions.
            extra: A user's own rule files.

        Raises:
            InputError: With every fault in every file.
        """
        with ExitStack() as stack:
            folder = resources.files("skolem.rules")
            paths = [stack.enter_context(resources.as_file(folder / f"{name}.lp")) for name in RULE_FILES]
            shipped = [RuleFile(p.stem, f"rules/{p.name}", str(p), p.read_bytes(), own=False) for p in paths]
            sources = [*shipped, *_own_files(extra, {file.name for file in shipped})]
            parsed = [(file, *parse(file)) for file in sources]
        _raise(fault for _, _, faults in parsed for fault in faults)
        statements = {file.name: found for file, found, _ in parsed}
        _raise(check([(file, statements[file.name]) for file in sources], queries_type))
        vocabulary, warnings = _vocabulary(sources, statements)
        book = cls(vocabulary, {f"{f.name}.lp": f.content for f in sources}, tuple(warnings), statements, sources)
        weakref.finalize(book, statements.clear)  # at exit, syntax trees must be gone before clingo's library is
        return book

    @property
    def sha256(self) -> dict[str, str]:
        """SHA-256 of every file, by file name."""
        return {name: hashlib.sha256(content).hexdigest() for name, content in self.files.items()}

    def solve(self, facts: Iterable[Term], queries: object, files: Sequence[str] | None = None) -> Answer:
        """Return what follows from `facts`.

        Args:
            facts: Ground atoms, each `goal(..)` or another input of the rules.
            queries: Answers the @functions: methods from terms to a term or a list of terms.
            files: Names of the rule files to use, without `.lp`; None for all.

        Raises:
            InternalError: If clingo has anything to say, a query fails, or there is not exactly one answer set.
        """
        unknown = [name for name in files or () if name not in self._statements]
        if unknown:
            raise InternalError(f"no rule file {unknown[0]!r}; there are: {', '.join(self._statements)}")
        names = list(self._statements) if files is None else files
        messages: list[str] = []
        control = _ground(
            [statement for name in names for statement in self._statements[name]],
            sorted(facts, key=str),
            _Context(queries),
            messages,
        )
        models: list[list[clingo.Symbol]] = []
        control.solve(on_model=lambda model: models.append(list(model.symbols(shown=True))))
        if messages:
            raise InternalError("\n".join(str(fault) for fault in explain(messages, self._sources)))
        if len(models) != 1:
            raise InternalError(f"the rules {', '.join(names)} have {len(models) or 'no'} answer sets instead of one")
        return Answer(self._by_predicate(models[0]), len(control.symbolic_atoms))

    def _by_predicate(self, symbols: Iterable[clingo.Symbol]) -> dict[str, list[tuple[Term, ...]]]:
        found: dict[str, list[tuple[Term, ...]]] = {}
        for text, symbol in sorted((str(symbol), symbol) for symbol in symbols):
            if text not in self._terms:
                term = from_symbol(symbol)
                self._terms[text] = (term.name, term.args) if isinstance(term, Compound) else (text, ())
            name, args = self._terms[text]
            found.setdefault(name, []).append(args)
        return found


class _Context:
    """Passes @function calls on to a queries object, in terms."""

    def __init__(self, queries: object) -> None:
        self._queries = queries

    def __getattr__(self, name: str) -> Callable[..., clingo.Symbol | list[clingo.Symbol]]:
        def call(*symbols: clingo.Symbol) -> clingo.Symbol | list[clingo.Symbol]:
            try:
                arguments = [from_symbol(symbol) for symbol in symbols]
                found: Term | list[Term] = getattr(self._queries, name)(*arguments)
                return [to_symbol(term) for term in found] if isinstance(found, list) else to_symbol(found)
            except Exception as error:
                text = f"@{name}({', '.join(map(str, symbols))})"
                raise InternalError(f"query {text} failed: {type(error).__name__}: {error}") from error

        return call


class _NoAnswers:
    """Queries that know nothing: for reading facts."""

    def __getattr__(self, name: str) -> Callable[..., list[Term]]:
        return lambda *_: []


def _ground(statements: Iterable[AST], facts: Sequence[Term], context: object, messages: list[str]) -> clingo.Control:
    """Return a grounded control; clingo's words are appended to `messages`.

    Raises:
        InternalError: If a query fails.
    """
    control = clingo.Control(list(CLINGO_OPTIONS), logger=lambda _code, text: messages.append(text), message_limit=100)
    inputs = "".join(f"#defined {name}/{arity}. " for name, arity in sorted(INPUT))
    with ast.ProgramBuilder(control) as builder:
        for statement in statements:
            builder.add(statement)
        ast.parse_string(inputs + "".join(f"{fact}. " for fact in facts), builder.add)
    try:
        control.ground([("base", [])], context=context)
    except RuntimeError as error:
        if not messages:
            raise InternalError(f"clingo stopped: {error}") from error
    return control


def _own_files(paths: Sequence[Path], taken: set[str]) -> list[RuleFile]:
    found, faults = [], []
    for path in paths:
        try:
            file = RuleFile(path.stem, str(path), str(path), path.read_bytes(), own=True)
        except OSError as error:
            faults.append(Fault(str(path), 0, 0, f"cannot be read: {error.strerror}"))
            continue
        if path.suffix != ".lp":
            faults.append(Fault(str(path), 0, 0, "expected a rule file whose name ends in .lp"))
        elif file.name in taken:
            faults.append(Fault(str(path), 0, 0, f"there is another rule file named {path.name}"))
        taken = taken | {file.name}
        found.append(file)
    _raise(faults)
    return found


def _vocabulary(sources: Sequence[RuleFile], statements: Mapping[str, Sequence[AST]]) -> tuple[Vocabulary, list[Fault]]:
    """Return the words that the rules define without a goal, and warnings."""
    messages: list[str] = []
    control = _ground([s for file in sources for s in statements[file.name]], (), _NoAnswers(), messages)
    _raise(explain(messages, sources))
    places = _places(sources, statements)
    facts = []
    for signature in WORD_FACTS.items():
        for atom in control.symbolic_atoms.by_signature(*signature):
            fact = from_symbol(atom.symbol)
            assert isinstance(fact, Compound)
            facts.append((fact, places.get(str(fact)) or places[f"{signature[0]}/{signature[1]}"]))
    vocabulary, faults, warnings = read_vocabulary(facts)
    _raise(faults)
    return vocabulary, warnings


def _places(sources: Sequence[RuleFile], statements: Mapping[str, Sequence[AST]]) -> dict[str, Place]:
    """Return where each word fact stands, by its text, and where each predicate is derived first."""
    found: dict[str, Place] = {}
    for file in sources:
        for statement in statements[file.name]:
            if statement.ast_type is ASTType.Rule:
                begin = statement.location.begin
                place = Place(file.title, begin.line, begin.column, file.own)
                found.setdefault(str(statement.head).replace(" ", ""), place)
                for name, arity in signatures(statement.head.atom):
                    found.setdefault(f"{name}/{arity}", place)
    return found


def _raise(faults: Iterable[Fault]) -> None:
    found = list(dict.fromkeys(faults))
    if found:
        raise InputError(found)
