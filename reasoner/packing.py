"""Rules that say more than one thing of the same as one rule: what follows comes in one atom and is taken apart later.

An operator has a rule for each precondition, for each thing it destroys, for its costs, all of the same step. clingo
prepares every rule before it grounds it, which is most of its work where rules have few instances. So rules with the
same body whose heads nothing builds on are joined; what follows from a question is the same to the last atom.
"""

from collections.abc import Iterable, Sequence
from typing import Final

from clingo import ast
from clingo.ast import AST, ASTType, Sign

from skolem.reasoner.numbering import PREFIX
from skolem.reasoner.validate import Signature, children

PACK: Final = f"{PREFIX}_"  # no predicate of a rule file has that name
_VARIABLE: Final = "V"


def packable(rule: AST, ends: frozenset[Signature]) -> str:
    """Return what rules have in common that can be one; empty if this rule has to stay as it is.

    The variables of a rule that can be joined are renamed in place, in order of their occurrence in its body.

    Args:
        rule: As it is loaded: one atom, with the number of the question in front, as its head.
        ends: Predicates, as they are loaded, that are shown and that no rule builds on.
    """
    head = rule.head.atom.symbol
    if head.ast_type is not ASTType.Function or (head.name, len(head.arguments)) not in ends:
        return ""
    if not all(map(_is_simple, rule.body)) or not all(map(_is_given, head.arguments)):
        return ""
    names: dict[str, str] = {}
    for part in (*rule.body, rule.head):
        _rename(part, names)
    return "; ".join(map(str, rule.body))


def packed(rules: Iterable[tuple[AST, str]]) -> list[AST]:
    """Return rules, each given with its `packable`, as fewer ones, and what makes clingo show what they derive."""
    found: list[AST] = []
    groups: dict[str, list[AST]] = {}
    for rule, body in rules:
        group = groups.setdefault(body, []) if body else found
        group.append(rule)
    together = [group for group in groups.values() if len(group) > 1]
    found += [rule for group in groups.values() if len(group) == 1 for rule in group]
    return [*_shown({len(group) + 1 for group in together}), *found, *map(_pack, together)]


def _pack(group: Sequence[AST]) -> AST:
    """Return one rule that derives what each of a group does, as the terms of one atom after the question's number."""
    at, body = group[0].location, group[0].body
    heads = [rule.head.atom.symbol for rule in group]
    said = [ast.Function(at, head.name.removeprefix(PREFIX), head.arguments[1:], 0) for head in heads]
    atom = ast.SymbolicAtom(ast.Function(at, PACK, [heads[0].arguments[0], *said], 0))
    return ast.Rule(at, ast.Literal(at, Sign.NoSign, atom), body)


def _shown(sizes: Iterable[int]) -> list[AST]:
    found: list[AST] = []
    ast.parse_string(" ".join(f"#show {PACK}/{n}." for n in sorted(sizes)), found.append)
    return [statement for statement in found if statement.ast_type is not ASTType.Program]


def _is_simple(element: AST) -> bool:
    """Return whether a part of a body is an atom or a comparison: all its variables are those of the rule."""
    kinds = (ASTType.SymbolicAtom, ASTType.Comparison)
    return element.ast_type is ASTType.Literal and element.atom.ast_type in kinds


def _is_given(term: AST) -> bool:
    """Return whether a term is one, and stands as it is: what is computed may have no value, and takes none with it."""
    kind = term.ast_type
    if kind is ASTType.Function:
        return not term.external and all(map(_is_given, term.arguments))
    return kind in (ASTType.SymbolicTerm, ASTType.Variable)


def _rename(node: AST, names: dict[str, str]) -> None:
    kind = node.ast_type
    if kind is not ASTType.Variable:
        for inner in children(node, kind):
            _rename(inner, names)
    elif node.name != "_":  # which may stand under `not` alone
        node.name = names.setdefault(node.name, f"{_VARIABLE}{len(names)}")
