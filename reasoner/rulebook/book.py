"""The rulebook: rule files that are loaded and validated once, and solved for every question."""

import hashlib
import re
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any, Final, Protocol

from clingo.ast import AST, ASTType

from skolem.reasoner.rulebook.asking import Asked
from skolem.reasoner.rulebook.examination import examine
from skolem.reasoner.rulebook.files import MAX_BYTES, RuleFile, explain
from skolem.reasoner.rulebook.parts import Atom, Signature, Statement
from skolem.reasoner.rulebook.questions import Question, Questions, Solved
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.terms import Compound, Term
from skolem.traces.errors import BrokenRulesError, Fault, InputError, InternalError, RuleError, SkolemError
from skolem.traces.given import read_regular

RULE_FILES: Final = (  # the table of contents of the folder rules/
    "vocabulary",  # words and their meanings
    "denote",  # the denotation of descriptions
    "infer",  # from descriptions to properties to quantities
    "find",  # from descriptions to regions
    "count",  # from numbers of objects to descriptions
    "witness",  # from relations to what can be looked at
    "refute",  # how the robot comes to know that an object, or a hidden one, does not fit
    "superlative",  # from superlatives to what can be measured
    "together",  # from what holds in one world to its parts
    "look",
    "look_region",
    "weigh",
    "clear",
    "pick",
    "place",
    "move",
    "mutex",  # fluents that exclude each other
    "regress",  # the atoms that one regression step reads
)
ABOUT_DESCRIPTIONS: Final = "denote"  # the one file that is not about steps
_MOST_PLACES: Final = 5  # that one fault of rules is attributed to
_KEPT: Final = 4  # sets of rules that ship: all of them, and those that older traces have
COMPILED: Final = (ABOUT_DESCRIPTIONS, "mutex")  # asked once before a search, and left out of its questions


@dataclass(frozen=True, slots=True)
class Answer:
    """The shown atoms of one answer set.

    Attributes:
        atoms: By predicate, the argument tuples of its atoms, sorted by text.
        ground_atoms: Number of atoms in the ground program, a measure of its size.
    """

    atoms: dict[str, list[tuple[Term, ...]]]
    ground_atoms: int


@dataclass(frozen=True, slots=True)
class Answers:
    """The answers to several questions.

    Attributes:
        atoms: The shown atoms of each question, as in `Answer`.
        ground_atoms: Number of atoms in the ground program for all of them.
        asked: Whether clingo was called; it is not called if no rule can fire.
    """

    atoms: list[dict[str, list[tuple[Term, ...]]]]
    ground_atoms: int
    asked: bool


class Elsewhere(Protocol):
    """Another process that has read the same rules, and has clingo answer questions about them."""

    def __call__(self, work: Callable[..., Any], queries: object, *arguments: object) -> Any:
        """Return what `work` returns of the rules, of queries that are answered here, and of some arguments."""
        ...


@dataclass(frozen=True)
class Rulebook:
    """Rule files that passed validation.

    Attributes:
        vocabulary: The words that the files define.
        files: File name to content, in the order in which they are loaded.
        warnings: Statements that are allowed but probably not meant.
    """

    vocabulary: Vocabulary
    files: Mapping[str, bytes]
    warnings: tuple[Fault, ...]
    _statements: Mapping[str, Sequence[Statement]] = field(repr=False)
    _sources: Sequence[RuleFile] = field(repr=False)
    _ready: dict[tuple[str, ...], Questions] = field(default_factory=dict, repr=False)  # by the names of their files
    _elsewhere: Elsewhere | None = field(default=None, repr=False)

    @classmethod
    def load(cls, queries_type: type, extra: Sequence[Path] = (), folder: Path | None = None) -> "Rulebook":
        """Return the rules that ship with the product, with those of the user.

        Args:
            queries_type: The class whose public methods rules may call as @functions.
            extra: A user's own rule files.
            folder: A folder with every file of `RULE_FILES`, used instead of those that ship; None for those.

        Raises:
            InputError: With every fault in every file.
        """
        sources, faults = rule_files(extra, folder)
        _raise(faults)
        return cls.of(queries_type, sources)

    @classmethod
    def of(cls, queries_type: type, sources: Sequence[RuleFile], elsewhere: Elsewhere | None = None) -> "Rulebook":
        """Return the rules in files that are already read; they are loaded in the order of `sources`.

        Files that all ship are examined once in a process; whoever asks again gets the same rules.

        Args:
            queries_type: The class whose public methods rules may call as @functions.
            sources: The files.
            elsewhere: Where clingo is to answer questions about them; None for this process.

        Raises:
            InputError: With every fault in every file.
        """
        if elsewhere is None and all(file.ships for file in sources):
            return _shipped(queries_type, tuple(sources))
        return cls._examined(queries_type, sources, elsewhere)

    @classmethod
    def _examined(cls, queries_type: type, sources: Sequence[RuleFile], elsewhere: Elsewhere | None) -> "Rulebook":
        examined = examine(sources, queries_type)
        _raise(examined.faults)
        statements = {file.name: found for file, found in examined.files}
        contents = {f"{file.name}.lp": file.content for file in sources}
        book = cls(examined.vocabulary, contents, examined.warnings, statements, sources, {}, elsewhere)
        weakref.finalize(
            book, _clear, statements, book._ready
        )  # at exit, syntax trees must be gone before clingo's library is
        return book

    @property
    def sources(self) -> tuple[tuple[RuleFile, Sequence[AST]], ...]:
        """Every rule file with the syntax trees of its statements, in the order in which they are loaded."""
        return tuple((file, tuple(s.tree for s in self._statements[file.name])) for file in self._sources)

    def stating(self, predicate: Signature) -> tuple[str, ...]:
        """Return the names, without `.lp`, of the files that have facts or rules of a predicate."""
        return tuple(
            name
            for name, statements in self._statements.items()
            if any(isinstance(s.head, Atom) and predicate in s.head.signatures for s in statements)
        )

    @property
    def sha256(self) -> dict[str, str]:
        """SHA-256 of every file, by file name."""
        return {name: hashlib.sha256(content).hexdigest() for name, content in self.files.items()}

    def solve(self, facts: Iterable[Term], queries: object, files: Sequence[str] | None = None) -> Answer:
        """Return the shown atoms that follow from `facts`.

        Args:
            facts: Ground atoms, each `goal(..)` or another input of the rules.
            queries: Answers the @functions: methods from terms to a term or a list of terms.
            files: Names of the rule files to use, without `.lp`; None for all.

        Raises:
            InternalError: If clingo gives a message, a query fails, or there is not exactly one answer set.
        """
        answers = self.solve_each([tuple(facts)], Asked(queries), files)
        return Answer(answers.atoms[0], answers.ground_atoms)

    def solve_each(self, questions: Sequence[Question], asked: Asked, files: Sequence[str] | None = None) -> "Answers":
        """Return the shown atoms that follow from each set of facts; one call of clingo answers all.

        Args:
            questions: Sets of facts, as for `solve`.
            asked: Answers the @functions.
            files: Names of the rule files to use, without `.lp`; None for all.

        Raises:
            InternalError: As `solve`.
        """
        unknown = [name for name in files or () if name not in self._statements]
        if unknown:
            raise InternalError(f"no rule file {unknown[0]!r}; there are: {', '.join(self._statements)}")
        names = tuple(self._statements if files is None else files)
        if self._elsewhere is None:
            solved = self.solved(asked, questions, names)
        else:
            solved = self._elsewhere(_solved, Asked.source(asked), questions, names)
        if solved.messages:
            raise self._refused(explain(solved.messages, self._sources))
        if solved.models != 1:
            raise InternalError(f"the rules {', '.join(names)} have {solved.models or 'no'} answer sets instead of one")
        return Answers([_by_predicate(shown) for shown in solved.shown], solved.ground_atoms, solved.asked)

    def solved(self, asked: Asked, questions: Sequence[Question], names: tuple[str, ...]) -> Solved:
        """Return what clingo answers in this process, its messages included."""
        if names not in self._ready:
            self._ready[names] = Questions([statement for name in names for statement in self._statements[name]])
        return self._ready[names].solve(questions, asked)

    def perform(self, work: Callable[..., Any], queries: object, *arguments: object) -> Any:
        """Return what `work` returns of these rules, of queries and of arguments, wherever clingo works on them."""
        if self._elsewhere is None:
            return work(self, queries, *arguments)
        return self._elsewhere(work, queries, *arguments)

    @contextmanager
    def answerable(self) -> Iterator[None]:
        """Make what a user's own rules do against the contract of rules a fault of theirs, with file and line.

        Raises:
            BrokenRulesError: Instead of a `RuleError`, if there are rules that do not ship.
        """
        try:
            yield
        except RuleError as error:
            faults = self._blamed(error)
            if not faults:
                raise
            raise BrokenRulesError(faults) from error

    def _blamed(self, error: RuleError) -> list[Fault]:
        """Return a fault at each rule of others that says what an error is about; without any, one for each file."""
        foreign = [file for file in self._sources if not file.ships]
        word = re.compile(rf"(?<![\w@]){re.escape(error.about)}(?!\w)")
        places = [
            file.fault(s.tree.location.begin.line, s.tree.location.begin.column, str(error))
            for file in foreign
            for s in self._statements[file.name]
            if error.about and s.kind is ASTType.Rule and word.search(str(s.tree))
        ]
        return places[:_MOST_PLACES] or [Fault(file.title, 0, 0, f"with these rules, {error}") for file in foreign]

    def _refused(self, faults: Sequence[Fault]) -> SkolemError:
        """Return what to raise for faults that show only while questions are answered."""
        ship = all(file.ships for file in self._sources)
        return InternalError("\n".join(map(str, faults))) if ship else BrokenRulesError(faults)


@lru_cache(_KEPT)
def _shipped(queries_type: type, sources: tuple[RuleFile, ...]) -> Rulebook:
    return Rulebook._examined(queries_type, sources, None)


def _solved(rules: Rulebook, queries: object, questions: Sequence[Question], names: tuple[str, ...]) -> Solved:
    return rules.solved(Asked(queries), questions, names)


def _by_predicate(shown: Iterable[Term]) -> dict[str, list[tuple[Term, ...]]]:
    found: dict[str, list[tuple[Term, ...]]] = {}
    for term in sorted(shown, key=str):
        name, args = (term.name, term.args) if isinstance(term, Compound) else (str(term), ())
        found.setdefault(name, []).append(args)
    return found


def _clear(*kept: dict[Any, Any]) -> None:
    for each in kept:
        each.clear()


def rule_files(extra: Sequence[Path] = (), folder: Path | None = None) -> tuple[list[RuleFile], list[Fault]]:
    """Return the rule files that ship with the product and those of the user, with a fault for each unreadable one.

    Args:
        extra: A user's own rule files.
        folder: A folder with every file of `RULE_FILES`, used instead of those that ship; None for those.
    """
    faults: list[Fault] = []
    if folder is None:
        with ExitStack() as stack:
            place = resources.files("skolem.rules")
            paths = [stack.enter_context(resources.as_file(place / f"{name}.lp")) for name in RULE_FILES]
            shipped = [
                RuleFile(p.stem, f"rules/{p.name}", str(p), p.read_bytes(), own=False, ships=True) for p in paths
            ]
    else:
        found, faults = _own_files([folder / f"{name}.lp" for name in RULE_FILES], set())
        shipped = [replace(file, own=False) for file in found]
    own, refused = _own_files(extra, {file.name for file in shipped})
    return [*shipped, *own], faults + refused


def _own_files(paths: Sequence[Path], taken: set[str]) -> tuple[list[RuleFile], list[Fault]]:
    """Return the rule files at some paths, with a fault for each path that has none."""
    found, faults = [], []
    for path in paths:
        try:
            file = RuleFile(path.stem, str(path), str(path), read_regular(path, MAX_BYTES), own=True)
        except OSError as error:
            faults.append(Fault(str(path), 0, 0, f"cannot be read: {error.strerror}"))
            continue
        if path.suffix != ".lp":
            faults.append(Fault(str(path), 0, 0, "expected a rule file whose name ends in .lp"))
        elif file.name in taken:
            faults.append(Fault(str(path), 0, 0, f"there is another rule file named {path.name}; rename one of them"))
        else:
            found.append(file)
        taken = taken | {file.name}
    return found, faults


def _raise(faults: Iterable[Fault]) -> None:
    found = list(dict.fromkeys(faults))
    if found:
        raise InputError(found)
