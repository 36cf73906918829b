"""Many questions in one program: each has its own facts and its own derivations.

Every predicate that depends on the facts of a question gets one more argument in front, the number of the question.
Only rules that can fire for these facts are loaded (`shapes`).
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Final

import clingo
from clingo import ast
from clingo.ast import ASTType

from skolem.reasoner.rulebook.loading import Line, Loaded
from skolem.reasoner.rulebook.numbering import PREFIX, Numbered, numbered_rule, numbered_show
from skolem.reasoner.rulebook.packing import PACK, Packable, packable, packed
from skolem.reasoner.rulebook.parts import Signature, Statement, without_pools
from skolem.reasoner.rulebook.shapes import Program, predicates, shape, shaped
from skolem.reasoner.rulebook.validate import INPUT
from skolem.reasoner.terms import Compound, Term, read_term, to_symbol
from skolem.traces.errors import InternalError, RuleError

# One thread, a fixed seed, every message; two models are asked for to notice a second one.
CLINGO_OPTIONS: Final = ("--parallel-mode=1", "--seed=1", "--warn=all", "--models=2")
_UNDEFINED: Final = "--warn=no-atom-undefined"  # the check of the rule files has found undefined atoms already
MEMORY: Final = 4096  # entries of each memo
_WORD: Final = re.compile(r"[A-Za-z_][\w']*")

Question = tuple[Term, ...]  # ground facts


@dataclass(slots=True)
class Solved:
    """The answers to some questions.

    Attributes:
        shown: The shown atoms of each question, as if it had been asked alone.
        ground_atoms: Number of atoms in the ground program; packed atoms count one by one.
        messages: Clingo's messages.
        models: Number of answer sets found, at most two.
        asked: Whether clingo was called; it is not called if no rule can fire.
    """

    shown: list[set[Term]]
    ground_atoms: int = 0
    messages: list[str] = field(default_factory=list)
    models: int = 1
    asked: bool = False


class Questions:
    """Rule files that are ready for questions."""

    def __init__(self, statements: Sequence[Statement]) -> None:
        """Prepare statements that passed validation."""
        shown_names = [s for s in statements if s.kind is ASTType.ShowSignature]
        shown_terms = [s for s in statements if s.kind is ASTType.ShowTerm]
        self._sources = [rule for s in statements if s.kind is ASTType.Rule for rule in without_pools(s)]
        shapes = [shaped(rule) for rule in self._sources]
        self._program = Program(shapes)
        self._heads = [frozenset(head.signature for head in rule.heads) for rule in shapes]
        self._uses = [rule.uses for rule in shapes]
        self._numbered = _dependent(self._heads, self._uses)
        self._outputs = _shown(shown_names, shown_terms) or frozenset().union(*self._heads)
        definitions = [s.tree for s in statements if s.kind is ASTType.Definition]
        self._constants = {tree.name: Line(str(tree), tree) for tree in definitions}
        shows = [*shown_names, *(each for s in shown_terms for each in without_pools(s))]
        self._always = [Line(numbered_show(s, self._numbered), s.tree) for s in shows]
        ends = self._numbered & self._outputs - frozenset().union(*self._uses)
        self._ends = frozenset((PREFIX + name, n + 1) for name, n in ends)
        self._rules: dict[int, Numbered | Packable] = {}  # the rules that some question has needed so far
        self._needed = lru_cache(MEMORY)(self._find_needed)
        self._slice = lru_cache(MEMORY)(self._find_slice)

    def solve(self, questions: Sequence[Question], queries: object) -> Solved:
        """Return the answer to each question.

        Args:
            questions: Sets of facts, each fact an input of the rules.
            queries: An object whose methods answer the @functions, in symbols.

        Raises:
            InternalError: If a query fails or clingo stops.
        """
        solved = Solved([set() for _ in questions])
        loaded = self._slice(frozenset(frozenset(map(shape, facts)) for facts in questions))
        if not loaded.statements:
            return solved
        options = [*CLINGO_OPTIONS, _UNDEFINED]
        tell = solved.messages.append
        control = clingo.Control(options, logger=lambda _code, text: tell(loaded.placed(text)), message_limit=100)
        with ast.ProgramBuilder(control) as builder:
            for statement in loaded.statements:
                builder.add(statement)
        with control.backend() as backend:
            for symbol in self._facts(questions):
                backend.add_rule([backend.add_atom(symbol)])
        try:
            control.ground([("base", [])], context=queries)
        except RuntimeError as error:
            if not solved.messages:
                raise InternalError(f"clingo stopped: {error}") from error
        solved.models, solved.asked = 0, True
        with control.solve(yield_=True) as handle:
            for model in handle:
                solved.models += 1
                if solved.models == 1:
                    try:
                        solved.ground_atoms += _distribute(model.symbols(shown=True), solved.shown)
                    except ValueError as error:  # a text, #inf or #sup that was computed; terms that are too deep
                        raise RuleError(str(error)) from error
        solved.ground_atoms += len(control.symbolic_atoms)
        return solved

    def _find_slice(self, shapes: frozenset[frozenset[Term]]) -> Loaded:
        """Return the statements that questions of these shapes need; empty if nothing can follow."""
        asked = {(fact.name, len(fact.args)) for facts in shapes for fact in facts if isinstance(fact, Compound)}
        needed = sorted(frozenset().union(*map(self._needed, shapes)))
        if not needed and not asked & self._outputs:
            return Loaded([])
        lines = [*self._always, *packed(map(self._rule, needed))]
        return Loaded([*self._constants_in(lines), *lines])

    def _rule(self, index: int) -> Numbered | Packable:
        """Return a rule as it is loaded; it is made on first use, since many are never needed."""
        if index not in self._rules:
            rule = numbered_rule(self._sources[index], self._numbered)
            self._rules[index] = packable(rule, self._ends) or rule
        return self._rules[index]

    def _constants_in(self, lines: Iterable[Line]) -> list[Line]:
        """Return the definitions of the constants in statements, and of the constants in those definitions."""
        found: dict[str, Line] = {}
        waiting = list(lines)
        while waiting:
            words = set(_WORD.findall(waiting.pop().text))
            new = {name: self._constants[name] for name in sorted(words & self._constants.keys() - found.keys())}
            found |= new
            waiting += new.values()
        return list(found.values())

    def _find_needed(self, shapes: frozenset[Term]) -> frozenset[int]:
        """Return the rules that one question needs."""
        atoms = [fact for fact in sorted(shapes, key=str) if isinstance(fact, Compound)]
        return self._program.needed(self._program.fired(atoms), self._outputs)

    def _facts(self, questions: Sequence[Question]) -> Iterator[clingo.Symbol]:
        for number, facts in enumerate(questions):
            yield clingo.Function(PREFIX, [clingo.Number(number)])
            for fact in sorted(facts, key=str):
                assert isinstance(fact, Compound), "a fact is an atom with arguments"
                if (fact.name, len(fact.args)) not in self._numbered:
                    raise InternalError(f"{fact} is not an input of the rules; those are: {_inputs()}")
                yield _numbered_fact(number, fact)


@lru_cache(MEMORY)
def _numbered_fact(number: int, fact: Compound) -> clingo.Symbol:
    return clingo.Function(PREFIX + fact.name, [clingo.Number(number), *map(to_symbol, fact.args)])


def _shown(names: Iterable[Statement], terms: Iterable[Statement]) -> frozenset[Signature]:
    """Return the predicates in `#show` statements; empty if there are none."""
    signatures = {(s.tree.name, s.tree.arity) for s in names if s.tree.name}
    shown = {signature for s in terms for part in s.body for signature in predicates(part)}
    return frozenset(signatures | shown)


def _distribute(symbols: Sequence[clingo.Symbol], shown: Sequence[set[Term]]) -> int:
    """Give every question its shown atoms; return how many atoms unpacking adds."""
    packs: list[tuple[set[Term], set[Term]]] = []
    for text in _texts(symbols):
        if not text.startswith(PREFIX):
            for each in shown:
                each.add(read_term(text))
            continue
        head, _, rest = text.partition(",")
        name, _, number = head.partition("(")
        mine = shown[int(number.rstrip(")"))]
        if name == PACK:
            packs.append((mine, set(_arguments(read_term(f"pack({rest}")))))
        elif name != PREFIX:
            plain = name.removeprefix(PREFIX)
            mine.add(read_term(f"{plain}({rest}" if rest else plain))
        elif rest:
            mine.add(read_term(rest.removesuffix(")")))
    more = -len(packs)
    for mine, derived in packs:
        more += len(derived - mine)
        mine |= derived
    return more


def _arguments(term: Term) -> tuple[Term, ...]:
    return term.args if isinstance(term, Compound) else ()


def _texts(symbols: Sequence[clingo.Symbol]) -> list[str]:
    """Return the text of each symbol; all are printed in one call, which is several times as fast."""
    if not symbols:
        return []
    gap = clingo.String("")  # occurs in no symbol of the rules
    spaced = [part for symbol in symbols for part in (gap, symbol)]
    return str(clingo.Function("", [*spaced, gap])).removeprefix('("",').removesuffix(',"")').split(',"",')


def _dependent(heads: Sequence[frozenset[Signature]], uses: Sequence[frozenset[Signature]]) -> frozenset[Signature]:
    """Return the predicates whose truth depends on the facts of a question."""
    found = set(INPUT)
    while True:
        more = set[Signature]().union(*(head for head, used in zip(heads, uses, strict=True) if used & found)) - found
        if not more:
            return frozenset(found)
        found |= more


def _inputs() -> str:
    return ", ".join(f"{name}/{arity}" for name, arity in sorted(INPUT))
