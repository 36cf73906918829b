"""Rules with the same body become one rule, and only where nothing is lost by it."""

import clingo
import pytest
from clingo import ast
from clingo.ast import ASTType

from skolem.reasoner.rulebook.numbering import PREFIX, Numbered, numbered_rule
from skolem.reasoner.rulebook.packing import PACK, packable, packed
from skolem.reasoner.rulebook.parts import Statement

ENDS = frozenset({("cost", 2), ("needs", 2), ("frees", 1)})
NUMBERED = ENDS | {("step", 1), ("builds", 1), ("no", 2)}


def rules(text: str) -> list[Numbered]:
    found: list[Statement] = []
    ast.parse_string(text, lambda tree: found.append(Statement.of(tree)))
    return [numbered_rule(statement, NUMBERED) for statement in found if statement.kind is ASTType.Rule]


def joined(text: str) -> list[str]:
    """Return the rules that are left of some."""
    ends = frozenset((PREFIX + name, n + 1) for name, n in ENDS)
    lines = [line.text for line in packed(packable(rule, ends) or rule for rule in rules(text))]
    return [line for line in lines if not line.startswith("#show")]


def test_rules_that_say_more_of_the_same_step_are_one_whatever_their_variables_are_called() -> None:
    text = """
        cost(S, 3)        :- step(S), S = pick(H, O).
        needs(T, free(X)) :- step(T), T = pick(X, Y).
        frees(S)          :- step(S), S = pick(A, B).
    """
    (rule,) = joined(text)
    assert rule.startswith(f"{PACK}(V0,cost(V1,3),needs(V1,free(V2)),frees(V1)) :- ")


@pytest.mark.parametrize(
    "other",
    [
        "needs(S,free(O)) :- step(S); S = place(O,H).",
        "needs(S,free(O)) :- step(S); S = pick(H,O); O != o1.",
        "builds(S) :- step(S); S = pick(H,O).",
        "needs(S,(C+1)) :- step(S); S = pick(H,C).",
        "needs(S,-C) :- step(S); S = pick(H,C).",
        "needs(S,@ask(O)) :- step(S); S = pick(H,O).",
        "needs(S,(a;b)) :- step(S); S = pick(H,O).",
        "needs(S,(1..2)) :- step(S); S = pick(H,O).",
        "needs(S,0) :- step(S); S = pick(H,O); 1 <= #count { X: step(X) }.",
    ],
    ids=["body", "longer body", "what rules build on", "sum", "minus", "query", "pool", "interval", "aggregate"],
)
def test_a_rule_that_says_something_else_or_computes_stays_by_itself(other: str) -> None:
    left = joined(f"cost(S,3) :- step(S); S = pick(H,O). {other}")
    assert len(left) == 2
    assert not any(PACK in rule for rule in left)


def test_a_negative_number_is_not_computed() -> None:
    assert len(joined("cost(S,-3) :- step(S). needs(S,f(-3,0)) :- step(S).")) == 1


def test_what_follows_from_packed_rules_is_what_followed_from_each() -> None:
    text = """
        cost(S, 3) :- step(S), S = pick(H, O), not no(O, _).
        needs(S, H) :- step(S), S = pick(H, O), not no(O, _).
        frees(H) :- step(S), S = pick(H, O), not no(O, _).
    """
    facts = "_of_step(0, pick(a, b)). _of_step(0, pick(a, c)). _of_step(1, pick(d, c)). _of_no(0, c, why)."
    plain, packs = (solved(facts, some) for some in (list(map(str, rules(text))), joined(text)))
    apart = {
        clingo.Function(f"_of_{said.name}", [pack.arguments[0], *said.arguments])
        for pack in packs
        if pack.name == PACK
        for said in pack.arguments[1:]
    }
    assert {atom for atom in plain if atom.name in ("_of_cost", "_of_needs", "_of_frees")} == apart
    assert len(apart) == 6


def solved(facts: str, lines: list[str]) -> list[clingo.Symbol]:
    control = clingo.Control(["--warn=none"])
    control.add("base", [], "\n".join([facts, *lines]))
    control.ground([("base", [])])
    return [atom.symbol for atom in control.symbolic_atoms]
