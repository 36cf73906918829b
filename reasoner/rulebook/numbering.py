"""Rules for many questions at once: atoms that depend on a question have its number as first argument."""

from copy import deepcopy
from dataclasses import dataclass
from itertools import count
from typing import Final

from clingo import ast
from clingo.ast import AST, ASTType

from skolem.reasoner.rulebook.parts import ANONYMOUS, Atom, Nested, Signature, Statement, atom_text
from skolem.reasoner.rulebook.validate import WITHOUT_PREDICATES, children

PREFIX: Final = "_of_"  # of the predicates that have the question's number as first argument
_NUMBER: Final = "Number_of_question"
_UNNAMED: Final = "_Unnamed"


@dataclass(frozen=True, slots=True)
class Numbered:
    """A rule for numbered questions, as text.

    Attributes:
        origin: The rule as it stands in its file.
        name: The predicate of its head.
        arguments: The arguments of its head.
        body: The elements of its body.
        flat: Whether its body has only atoms and comparisons, so that no variable is local to a part.
    """

    origin: AST
    name: str
    arguments: tuple[str, ...]
    body: tuple[str, ...]
    flat: bool

    def __str__(self) -> str:
        body = f" :- {'; '.join(self.body)}" if self.body else ""
        return f"{atom_text(self.name, self.arguments)}{body}."


def numbered_rule(rule: Statement, numbered: frozenset[Signature]) -> Numbered:
    """Return a rule without pools as a rule for numbered questions."""
    head = rule.head
    assert isinstance(head, Atom), "a rule derives an atom"
    (arguments,) = head.pool
    body, taking = _body(rule, numbered)
    name = head.name
    if (name, len(arguments)) in numbered:
        name, arguments = PREFIX + name, (_NUMBER, *arguments)
        taking = True
    flat = not any(isinstance(part, Nested) for part in rule.body)
    return Numbered(rule.tree, name, arguments, tuple(_bound(rule, body, numbered) if taking else body), flat)


def numbered_show(statement: Statement, numbered: frozenset[Signature]) -> str:
    """Return a `#show` of a predicate or of terms for numbered questions."""
    tree = statement.tree
    if statement.kind is ASTType.ShowSignature:
        return f"#show {PREFIX}{tree.name}/{tree.arity + 1}." if (tree.name, tree.arity) in numbered else str(tree)
    body, taking = _body(statement, numbered)
    if not taking:
        return str(tree)
    return f"#show {PREFIX}({_NUMBER},{tree.term}) : {'; '.join(_bound(statement, body, numbered))}."


def _body(statement: Statement, numbered: frozenset[Signature]) -> tuple[list[str], bool]:
    """Return the elements of a body with the question's number in those that take it, and whether any does.

    Every `_` in positive literals gets a name. For `p(X, _)` clingo makes one more predicate, p without its last place,
    and a rule for it. Where rules have few instances each, such rules cost more than they save. Under `not` the `_`
    stays: a named variable would be unsafe.
    """
    texts: list[str] = []
    taking = False
    unnamed = count(1)
    for part in statement.body:
        text = part.text
        if isinstance(part, Nested):
            tree = deepcopy(part.tree)
            if _number_atoms(tree, numbered, ast.Variable(statement.tree.location, _NUMBER)):
                text, taking = str(tree), True
        elif isinstance(part, Atom) and not numbered.isdisjoint(part.signatures):
            (arguments,) = part.pool
            text, taking = part.sign + atom_text(PREFIX + part.name, (_NUMBER, *arguments)), True
        if not isinstance(part, Nested) and not part.sign:
            text = ANONYMOUS.sub(lambda _: f"{_UNNAMED}{next(unnamed)}", text)
        texts.append(text)
    return texts, taking


def _bound(statement: Statement, body: list[str], numbered: frozenset[Signature]) -> list[str]:
    """Return a body in which some positive literal binds the question's number."""
    says = any(isinstance(p, Atom) and not p.sign and not numbered.isdisjoint(p.signatures) for p in statement.body)
    return body if says else [atom_text(PREFIX, (_NUMBER,)), *body]


def _number_atoms(node: AST, numbered: frozenset[Signature], number: AST) -> bool:
    """Put the question's number into the atoms of a part of a statement; return whether any atom takes it."""
    kind = node.ast_type
    if kind is not ASTType.SymbolicAtom:
        inside = () if kind in WITHOUT_PREDICATES else children(node, kind)
        return any([_number_atoms(inner, numbered, number) for inner in inside])  # a list: all of them are changed
    symbol, found = node.symbol, False
    for term in symbol.arguments if symbol.ast_type is ASTType.Pool else [symbol]:
        if term.ast_type is ASTType.Function and (term.name, len(term.arguments)) in numbered:
            term.arguments.insert(0, number)
            term.name = PREFIX + term.name
            found = True
    return found
