"""Rules as they are loaded for many questions at once: each atom that depends on a question has its number in front.

All work is done in place, on copies: of the ways to change a syntax tree this is by far the fastest.
"""

import re
from collections.abc import Iterator
from copy import deepcopy
from itertools import count
from typing import Final

from clingo import ast
from clingo.ast import AST, ASTType, Sign

from skolem.reasoner.validate import WITHOUT_PREDICATES, Signature, children

PREFIX: Final = "_of_"  # of the predicates that got the number of the question
_NUMBER: Final = "Number_of_question"
_UNNAMED: Final = "_Unnamed"
_NAMELESS: Final = re.compile(r"\b_\b")


def numbered_rule(rule: AST, numbered: frozenset[Signature]) -> AST:
    """Return a rule for questions that are numbered, with a name for every `_` in its positive literals.

    For `p(X, _)` clingo makes one more predicate, p without its last place, and a rule for it. Where rules have few
    instances each, such rules cost more than they save. Under `not` the `_` stays: a named variable would be unsafe.
    """
    found = deepcopy(rule)
    _number(found, numbered)
    names = map(f"{_UNNAMED}{{}}".format, count(1))
    for element in found.body:
        if _NAMELESS.search(str(element)):  # few have any `_`, which their text tells much faster than a walk
            _name(element, names)
    return found


def numbered_show(statement: AST, numbered: frozenset[Signature]) -> AST:
    """Return `#show` of a predicate or of terms for questions that are numbered."""
    found = deepcopy(statement)
    if found.ast_type is ASTType.ShowTerm:
        number = _number(found, numbered)
        if number is not None:
            found.term = ast.Function(found.location, PREFIX, [number, found.term], 0)
    elif (found.name, found.arity) in numbered:
        found.name, found.arity = PREFIX + found.name, found.arity + 1
    return found


def _number(statement: AST, numbered: frozenset[Signature]) -> AST | None:
    """Put the number of the question into the atoms of a statement; return the number, None if no atom takes it."""
    number = ast.Variable(statement.location, _NUMBER)
    head = statement.ast_type is ASTType.Rule and _number_atoms(statement.head, numbered, number)
    taking = [element for element in statement.body if _number_atoms(element, numbered, number)]
    if not head and not taking:
        return None
    if not any(element.ast_type is ASTType.Literal and element.sign == Sign.NoSign for element in taking):
        atom = ast.SymbolicAtom(ast.Function(statement.location, PREFIX, [number], 0))
        statement.body.insert(0, ast.Literal(statement.location, Sign.NoSign, atom))
    return number


def _number_atoms(node: AST, numbered: frozenset[Signature], number: AST) -> bool:
    """Put the number into the atoms of a part of a statement; return whether there are any that take it."""
    kind = node.ast_type
    if kind is not ASTType.SymbolicAtom:
        inside = () if kind in WITHOUT_PREDICATES else children(node, kind)
        return any([_number_atoms(inner, numbered, number) for inner in inside])  # a list: all of them are changed
    symbol, found = node.symbol, False
    for term in symbol.arguments if symbol.ast_type is ASTType.Pool else [symbol]:
        name, arguments = term.name, term.arguments
        if (name, len(arguments)) in numbered:
            term.name = PREFIX + name
            arguments.insert(0, number)
            found = True
    return found


def _name(node: AST, names: Iterator[str]) -> None:
    """Name the variables of a part of a rule that have no name."""
    kind = node.ast_type
    if kind is ASTType.Variable:
        if node.name == "_":
            node.name = next(names)
    elif kind is not ASTType.Literal or node.sign == Sign.NoSign:
        for inner in children(node, kind):
            _name(inner, names)
