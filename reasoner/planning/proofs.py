"""Proofs: derivations of atoms, rule by rule, with file, line and the belief's answers to queries.

For every rule `H :- B.` a second one is grounded that records H with B, so that the derivation is clingo's own and not
a second interpretation of the rules. `X = @query(..)` is recorded; `not` and other comparisons are not.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import clingo
from clingo import ast
from clingo.ast import AST, ASTType, ComparisonOperator, Sign

from skolem.reasoner.rulebook.book import COMPILED, Rulebook
from skolem.reasoner.rulebook.validate import INPUT
from skolem.reasoner.terms import Compound, Term, from_symbol, to_symbol
from skolem.traces.errors import InternalError, SkolemError

_NOTE: Final = "why__"
_ASKED: Final = "asked__"

_Notes = dict[Term, tuple[str, int, tuple[Term, ...]]]  # atom -> file, line and body of the rule that derives it


@dataclass(frozen=True, slots=True)
class Proof:
    """An atom and the rule that derives it.

    Attributes:
        atom: The derived atom.
        file: Name of the rule's file; empty for facts and answers of queries.
        line: Its line.
        premises: The proofs of the positive atoms of its body, and the queries with their answers.
    """

    atom: Term
    file: str = ""
    line: int = 0
    premises: "tuple[Proof, ...]" = ()

    @property
    def place(self) -> str:
        """File and line such as `pick.lp:29`; empty for a fact."""
        return f"{self.file}.lp:{self.line}" if self.file else ""


class Derivation:
    """All atoms that the rules derive from some facts in one belief, each with its rule."""

    def __init__(self, rulebook: Rulebook, facts: Sequence[Term], queries: object) -> None:
        """Ground the rules.

        Raises:
            InternalError: If clingo gives a message.
        """
        self._notes: _Notes = rulebook.perform(_derived, queries, facts)

    def proof(self, atom: Term, above: frozenset[Term] = frozenset()) -> Proof:
        """Return the proof of an atom; for a fact, the atom alone."""
        if isinstance(atom, Compound) and atom.name == _ASKED:
            return Proof(Compound("=", atom.args))
        if atom not in self._notes or atom in above:
            return Proof(atom)
        file, line, premises = self._notes[atom]
        return Proof(atom, file, line, tuple(self.proof(premise, above | {atom}) for premise in premises))

    def atoms(self, name: str, arity: int) -> list[Compound]:
        """Return the derived atoms of a predicate, sorted."""
        found = [a for a in self._notes if isinstance(a, Compound) and (a.name, len(a.args)) == (name, arity)]
        return sorted(found, key=str)


def _derived(rulebook: Rulebook, queries: object, facts: Sequence[Term]) -> _Notes:
    """Return every derived atom with the file and line of its rule, and the atoms that the rule took."""
    names = [file.name for file, _ in rulebook.sources]
    notes: _Notes = {}
    messages: list[str] = []
    control = clingo.Control(["--warn=none"], logger=lambda _code, text: messages.append(text))
    with ast.ProgramBuilder(control) as builder:
        for number, (file, statements) in enumerate(rulebook.sources):
            if file.name not in COMPILED:
                for statement in statements:
                    if statement.ast_type is not ASTType.ShowSignature:
                        builder.add(statement)
                    for noted in _noted(statement, number, statement.location.begin.line):
                        builder.add(noted)
        text = "".join(f"#defined {name}/{arity}. " for name, arity in sorted(INPUT))
        ast.parse_string(text + "".join(f"{fact}. " for fact in facts), builder.add)
    try:
        control.ground([("base", [])], context=_Context(queries))
    except RuntimeError as error:
        raise InternalError(f"clingo stopped: {'; '.join(messages) or error}") from error
    for atom in control.symbolic_atoms.by_signature(_NOTE, 4):
        place, line, head, body = atom.symbol.arguments
        premises = tuple(map(from_symbol, body.arguments))
        note = (names[place.number], line.number, premises)
        key = from_symbol(head)
        notes[key] = min(notes.get(key, note), note, key=str)
    return notes


class _Context:
    """Passes @function calls on to a queries object, in terms."""

    def __init__(self, queries: object) -> None:
        self._queries = queries

    def __getattr__(self, name: str) -> object:
        def call(*symbols: clingo.Symbol) -> clingo.Symbol | list[clingo.Symbol]:
            try:
                found: Term | list[Term] = getattr(self._queries, name)(*map(from_symbol, symbols))
            except (SkolemError, LookupError):
                # clingo may order the recorded body differently, and call the query before the literal that guards it.
                # If the rule itself had called it, the run would have failed; so the guard is false.
                return []
            return [to_symbol(term) for term in found] if isinstance(found, list) else to_symbol(found)

        return call


@lru_cache(1 << 12)  # every fluent that is asked about takes the same rules; equal ones may stand at several lines
def _noted(statement: AST, number: int, line: int) -> tuple[AST, ...]:
    """Return the rule that records the head and the body of a rule; nothing for what is no rule."""
    if statement.ast_type is not ASTType.Rule:
        return ()
    where = statement.location
    wildcards = _Wildcards()
    body = [wildcards.visit(e) if _is_positive(e) else e for e in statement.body]
    premises = [premise for element in body if _is_positive(element) for premise in _premises(element)]
    args = [
        ast.SymbolicTerm(where, clingo.Number(number)),
        ast.SymbolicTerm(where, clingo.Number(line)),
        statement.head.atom.symbol,
        ast.Function(where, "", premises, 0),
    ]
    head = ast.Literal(where, Sign.NoSign, ast.SymbolicAtom(ast.Function(where, _NOTE, args, 0)))
    return (ast.Rule(where, head, body),)


class _Wildcards(ast.Transformer):
    """Gives every `_` a name, so that a copy of the body means the same."""

    def __init__(self) -> None:
        self._count = 0

    def visit_Variable(self, variable: AST) -> AST:
        """Return the variable, with a name if it is `_`."""
        if variable.name != "_":
            return variable
        self._count += 1
        return variable.update(name=f"Any{self._count}")


def _is_positive(element: AST) -> bool:
    return element.ast_type is ASTType.Literal and bool(element.sign == Sign.NoSign)


def _premises(literal: AST) -> Iterable[AST]:
    atom, where = literal.atom, literal.location
    if atom.ast_type is ASTType.SymbolicAtom:
        yield atom.symbol
    if atom.ast_type is ASTType.Comparison and len(atom.guards) == 1:
        guard = atom.guards[0]
        sides = (atom.term, guard.term)
        for call, value in (sides, sides[::-1]):
            is_call = call.ast_type is ASTType.Function and call.external
            if is_call and guard.comparison == ComparisonOperator.Equal and not _calls(value):
                question = ast.Function(where, call.name, call.arguments, 0)
                yield ast.Function(where, _ASKED, [question, value], 0)


def _calls(term: AST) -> bool:
    return bool(term.ast_type is ASTType.Function and term.external)


def rules_used(proof: Proof) -> Mapping[str, Proof]:
    """Return the proofs inside a proof by the position of their rule, outermost first."""
    found = {proof.place: proof} if proof.file else {}
    for premise in proof.premises:
        for place, inner in rules_used(premise).items():
            found.setdefault(place, inner)
    return found
