"""Rules with the same body become one rule, and only where nothing is lost by it."""

import clingo
import pytest
from clingo import ast
from clingo.ast import AST, ASTType

from skolem.reasoner.packing import PACK, packable, packed

ENDS = frozenset({("_of_cost", 3), ("_of_needs", 3), ("_of_frees", 2)})


def rules(text: str) -> list[AST]:
    found: list[AST] = []
    ast.parse_string(text, found.append)
    return [statement for statement in found if statement.ast_type is ASTType.Rule]


def joined(text: str) -> list[str]:
    """Return the rules that are left of some."""
    left = packed((rule, packable(rule, ENDS)) for rule in rules(text))
    return [str(statement) for statement in left if statement.ast_type is ASTType.Rule]


def test_rules_that_say_more_of_the_same_step_are_one_whatever_their_variables_are_called() -> None:
    text = """
        _of_cost(N, S, 3)      :- _of_step(N, S), S = pick(H, O).
        _of_needs(N, T, free(X)) :- _of_step(N, T), T = pick(X, Y).
        _of_frees(N, S)        :- _of_step(N, S), S = pick(A, B).
    """
    (rule,) = joined(text)
    assert rule.startswith(f"{PACK}(V0,cost(V1,3),needs(V1,free(V2)),frees(V1)) :- ")


@pytest.mark.parametrize(
    "other",
    [
        "_of_needs(N,S,free(O)) :- _of_step(N,S); S = place(O,H).",
        "_of_needs(N,S,free(O)) :- _of_step(N,S); S = pick(H,O); O != o1.",
        "_of_builds(N,S) :- _of_step(N,S); S = pick(H,O).",
        "_of_needs(N,S,(C+1)) :- _of_step(N,S); S = pick(H,C).",
        "_of_needs(N,S,@ask(O)) :- _of_step(N,S); S = pick(H,O).",
        "_of_needs(N,S,(a;b)) :- _of_step(N,S); S = pick(H,O).",
        "_of_needs(N,S,0) :- _of_step(N,S); S = pick(H,O); 1 <= #count { X: _of_step(N,X) }.",
    ],
    ids=["another body", "a longer body", "what rules build on", "a sum", "a query", "a pool", "an aggregate"],
)
def test_a_rule_that_says_something_else_or_computes_stays_by_itself(other: str) -> None:
    left = joined(f"_of_cost(N,S,3) :- _of_step(N,S); S = pick(H,O). {other}")
    assert len(left) == 2
    assert not any(PACK in rule for rule in left)


def test_what_follows_from_packed_rules_is_what_followed_from_each() -> None:
    text = """
        _of_cost(N, S, 3) :- _of_step(N, S), S = pick(H, O), not _of_no(N, O, _).
        _of_needs(N, S, H) :- _of_step(N, S), S = pick(H, O), not _of_no(N, O, _).
        _of_frees(N, H) :- _of_step(N, S), S = pick(H, O), not _of_no(N, O, _).
    """
    facts = "_of_step(0, pick(a, b)). _of_step(0, pick(a, c)). _of_step(1, pick(d, c)). _of_no(0, c, why)."
    plain, packs = (solved(facts, some) for some in (rules(text), packed((r, packable(r, ENDS)) for r in rules(text))))
    apart = {
        clingo.Function(f"_of_{said.name}", [pack.arguments[0], *said.arguments])
        for pack in packs
        if pack.name == PACK
        for said in pack.arguments[1:]
    }
    assert {atom for atom in plain if atom.name in ("_of_cost", "_of_needs", "_of_frees")} == apart
    assert len(apart) == 6


def solved(facts: str, statements: list[AST]) -> list[clingo.Symbol]:
    control = clingo.Control(["--warn=none"])
    with ast.ProgramBuilder(control) as builder:
        ast.parse_string(facts, builder.add)
        for statement in statements:
            if statement.ast_type is ASTType.Rule:
                builder.add(statement)
    control.ground([("base", [])])
    return [atom.symbol for atom in control.symbolic_atoms]
