"""Many questions in one program: each has its own facts and its own derivations, none sees another's.

Every predicate that depends on the facts of a question gets one more argument in front, the number of the question. Of
the rules only those are loaded that can fire for these facts (`shapes`).
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import count
from typing import Any, Final

import clingo
from clingo import ast
from clingo.ast import AST, ASTType, Sign

from skolem.reasoner.shapes import Program, predicates, shape, shaped
from skolem.reasoner.terms import Compound, Term, read_term, to_symbol
from skolem.reasoner.validate import INPUT, Signature
from skolem.traces.errors import InternalError

# One thread, a fixed seed, every message; two models are asked for to notice a second one.
CLINGO_OPTIONS: Final = ("--parallel-mode=1", "--seed=1", "--warn=all", "--models=2")
_PREFIX: Final = "_of_"  # of the predicates that got the number of the question
_NUMBER: Final = "Number_of_question"
_UNNAMED: Final = "_Unnamed"
_NAMELESS: Final = re.compile(r"\b_\b")
MEMORY: Final = 4096  # entries of each memo
_WORD: Final = re.compile(r"[A-Za-z_][\w']*")

Question = tuple[Term, ...]  # ground facts


@dataclass(slots=True)
class Solved:
    """What follows from some questions.

    Attributes:
        shown: Per question its shown atoms, as if it had been asked alone.
        ground_atoms: Number of atoms in the ground program.
        messages: What clingo had to say.
        models: Number of answer sets, of two at most.
        asked: Whether clingo was called: it is not if no rule can fire.
    """

    shown: list[list[Term]]
    ground_atoms: int = 0
    messages: list[str] = field(default_factory=list)
    models: int = 1
    asked: bool = False


class Questions:
    """Some rule files, made ready to be asked."""

    def __init__(self, statements: Sequence[AST]) -> None:
        """Read statements that passed validation."""
        self._rules = [s for s in statements if s.ast_type is ASTType.Rule]
        self._shown_terms = [s for s in statements if s.ast_type is ASTType.ShowTerm]
        shapes = [shaped(rule) for rule in self._rules]
        self._program = Program(shapes)
        self._heads = [frozenset(head.signature for head in rule.heads) for rule in shapes]
        self._uses = [rule.uses for rule in shapes]
        self._numbered = _dependent(self._heads, self._uses)
        self._outputs = self._show(statements) or frozenset().union(*self._heads)
        numbering, naming = _Numbering(self._numbered), _Naming()
        self._rules = [naming.of(numbering.of(rule)) for rule in self._rules]
        self._constants = {s.name: s for s in statements if s.ast_type is ASTType.Definition}
        self._always = [_show_signature(s, self._numbered) for s in statements if s.ast_type is ASTType.ShowSignature]
        self._always += [numbering.of(s) for s in self._shown_terms]
        self._needed = lru_cache(MEMORY)(self._find_needed)
        self._slice = lru_cache(MEMORY)(self._find_slice)
        self._shape = lru_cache(MEMORY)(shape)

    def _show(self, statements: Sequence[AST]) -> frozenset[Signature]:
        """Return the predicates that are shown; none if nothing says which."""
        signatures = {(s.name, s.arity) for s in statements if s.ast_type is ASTType.ShowSignature and s.name}
        shown = {signature for s in self._shown_terms for element in s.body for signature in predicates(element)}
        return frozenset(signatures | shown)

    def solve(self, questions: Sequence[Question], queries: object) -> Solved:
        """Return what follows from each question.

        Args:
            questions: Facts, each an input of the rules.
            queries: Its methods answer the @functions, in symbols.

        Raises:
            InternalError: If a query fails or clingo stops.
        """
        solved = Solved([[] for _ in questions])
        statements = self._slice(frozenset(frozenset(map(self._shape, facts)) for facts in questions))
        if not statements:
            return solved
        control = clingo.Control(
            list(CLINGO_OPTIONS), logger=lambda _code, text: solved.messages.append(text), message_limit=100
        )
        with ast.ProgramBuilder(control) as builder:
            for statement in statements:
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
                    _distribute(model.symbols(shown=True), solved.shown)
        solved.ground_atoms = len(control.symbolic_atoms)
        return solved

    def _find_slice(self, shapes: frozenset[frozenset[Term]]) -> list[AST]:
        """Return the statements that matter to questions of these shapes; none if nothing can follow."""
        asked = {(fact.name, len(fact.args)) for facts in shapes for fact in facts if isinstance(fact, Compound)}
        needed = sorted(frozenset().union(*map(self._needed, shapes)))
        if not needed and not asked & self._outputs:
            return []
        derived = set[Signature]().union(*(self._heads[index] for index in needed))
        given = self._outputs | asked | set().union(*(self._uses[index] for index in needed)) - derived
        chosen = [self._rules[index] for index in needed]
        constants = self._constants_in([*self._always, *chosen])
        return [*_defined(given, self._numbered), *self._always, *constants, *chosen]

    def _constants_in(self, rules: Iterable[AST]) -> list[AST]:
        """Return the definitions of the constants that rules name, and of those that these are made of."""
        found: dict[str, AST] = {}
        waiting = list(rules)
        while waiting:
            words = set(_WORD.findall(str(waiting.pop())))
            new = {name: s for name, s in self._constants.items() if name in words and name not in found}
            found |= new
            waiting += new.values()
        return list(found.values())

    def _find_needed(self, shapes: frozenset[Term]) -> frozenset[int]:
        """Return the rules that matter to one question."""
        atoms = [fact for fact in sorted(shapes, key=str) if isinstance(fact, Compound)]
        return self._program.needed(self._program.fired(atoms), self._outputs)

    def _facts(self, questions: Sequence[Question]) -> Iterator[clingo.Symbol]:
        for number, facts in enumerate(questions):
            yield clingo.Function(_PREFIX, [clingo.Number(number)])
            for fact in sorted(facts, key=str):
                assert isinstance(fact, Compound), "a fact is an atom with arguments"
                if (fact.name, len(fact.args)) not in self._numbered:
                    raise InternalError(f"{fact} is not an input of the rules; those are: {_inputs()}")
                yield clingo.Function(_PREFIX + fact.name, [clingo.Number(number), *map(to_symbol, fact.args)])


def _distribute(symbols: Sequence[clingo.Symbol], shown: Sequence[list[Term]]) -> None:
    """Give every question its shown atoms."""
    for text in _texts(symbols):
        if not text.startswith(_PREFIX):
            for each in shown:
                each.append(read_term(text))
            continue
        head, _, rest = text.partition(",")
        name, _, number = head.partition("(")
        if name != _PREFIX:
            plain = name.removeprefix(_PREFIX)
            shown[int(number.rstrip(")"))].append(read_term(f"{plain}({rest}" if rest else plain))
        elif rest:
            shown[int(number)].append(read_term(rest.removesuffix(")")))


def _texts(symbols: Sequence[clingo.Symbol]) -> list[str]:
    """Return what clingo prints for each symbol, asked for all of them at once: that is several times as fast."""
    if not symbols:
        return []
    gap = clingo.String("")  # occurs in no symbol of the rules
    spaced = [part for symbol in symbols for part in (gap, symbol)]
    return str(clingo.Function("", [*spaced, gap])).removeprefix('("",').removesuffix(',"")').split(',"",')


# ---------------------------------------------------------------- numbering


class _Numbering(ast.Transformer):
    """Puts the number of the question into the atoms of a statement."""

    def __init__(self, numbered: frozenset[Signature]) -> None:
        self._numbered = numbered

    def of(self, statement: AST) -> AST:
        """Return the statement for questions that are numbered; unchanged if it does not depend on any."""
        heads = predicates(statement.head.atom) if statement.ast_type is ASTType.Rule else set()
        positive = [e for e in statement.body if e.ast_type is ASTType.Literal and e.sign == Sign.NoSign]
        if not self._numbered & heads.union(*map(predicates, statement.body)):
            return statement
        found, location = self.visit(statement), statement.location
        if not any(self._numbered & predicates(element) for element in positive):
            atom = ast.SymbolicAtom(ast.Function(location, _PREFIX, [_number(location)], 0))
            found = found.update(body=[ast.Literal(location, Sign.NoSign, atom), *found.body])
        if statement.ast_type is ASTType.ShowTerm:
            found = found.update(term=ast.Function(location, _PREFIX, [_number(location), found.term], 0))
        return found

    def visit_SymbolicAtom(self, node: AST) -> AST:
        """Number an atom."""
        symbol = node.symbol
        if symbol.ast_type is ASTType.Pool:
            terms = [self._atom(term) for term in symbol.arguments]
            return node.update(symbol=symbol.update(arguments=terms))
        return node.update(symbol=self._atom(symbol))

    def _atom(self, term: AST) -> AST:
        if (term.name, len(term.arguments)) not in self._numbered:
            return term
        return term.update(name=_PREFIX + term.name, arguments=[_number(term.location), *term.arguments])


class _Naming(ast.Transformer):
    """Gives a name to every `_` in positive literals.

    For `p(X, _)` clingo makes one more predicate, p without its last place, and a rule for it. Where rules have few
    instances each, such rules cost more than they save. Under `not` the `_` stays: a named variable would be unsafe.
    """

    def __init__(self) -> None:
        self._numbers = count(1)

    def of(self, statement: AST) -> AST:
        """Return the statement with names; few have any `_`, which their text tells much faster than a walk."""
        return self.visit(statement) if _NAMELESS.search(str(statement)) else statement

    def visit_Literal(self, node: AST) -> AST:
        """Leave a negative literal as it is."""
        return node if node.sign != Sign.NoSign else node.update(**self.visit_children(node))

    def visit_Variable(self, node: AST) -> AST:
        """Name a variable that has no name."""
        return node if node.name != "_" else node.update(name=f"{_UNNAMED}{next(self._numbers)}")


def _number(location: Any) -> AST:
    return ast.Variable(location, _NUMBER)


def _dependent(heads: Sequence[frozenset[Signature]], uses: Sequence[frozenset[Signature]]) -> frozenset[Signature]:
    """Return the predicates whose truth depends on the facts of a question."""
    found = set(INPUT)
    while True:
        more = set[Signature]().union(*(head for head, used in zip(heads, uses, strict=True) if used & found)) - found
        if not more:
            return frozenset(found)
        found |= more


def _defined(given: Iterable[Signature], numbered: frozenset[Signature]) -> list[AST]:
    """Return `#defined` for predicates that no rule at hand derives: facts of questions, and what is never true."""
    names = [(_PREFIX, 1)] + [
        (_PREFIX + name, n + 1) if (name, n) in numbered else (name, n) for name, n in sorted(given)
    ]
    found: list[AST] = []
    ast.parse_string(" ".join(f"#defined {name}/{n}." for name, n in names), found.append)
    return [statement for statement in found if statement.ast_type is ASTType.Defined]


def _show_signature(statement: AST, numbered: frozenset[Signature]) -> AST:
    if (statement.name, statement.arity) not in numbered:
        return statement
    return statement.update(name=_PREFIX + statement.name, arity=statement.arity + 1)


def _inputs() -> str:
    return ", ".join(f"{name}/{arity}" for name, arity in sorted(INPUT))
