"""Evaluation over shapes: what can fire at all, and nothing that can is left out."""

import pytest
from clingo import ast
from clingo.ast import AST, ASTType

from skolem.reasoner.rulebook.parts import Statement
from skolem.reasoner.rulebook.shapes import Program, shape, shaped
from skolem.reasoner.terms import Compound, parse_term


def rules(text: str) -> list[AST]:
    found: list[AST] = []
    ast.parse_string(text, found.append)
    return [statement for statement in found if statement.ast_type is ASTType.Rule]


def fired(text: str, *facts: str) -> list[str]:
    """Return the heads of the rules that fire over the shapes of facts."""
    statements = rules(text)
    shapes = [shape(parse_term(fact)) for fact in facts]
    program = Program([shaped(Statement.of(rule)) for rule in statements])
    atoms = [fact for fact in shapes if isinstance(fact, Compound)]
    return [str(statements[index].head) for index in sorted(program.fired(atoms))]


def test_a_shape_keeps_functors_and_forgets_the_rest() -> None:
    assert str(shape(parse_term("goal(b(on(o2,desk),105361))"))) == "goal(b(on(leaf,leaf),leaf))"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("p(X) :- goal(a(X)). q(X) :- goal(b(X)).", ["p(X)"]),
        ("p(X) :- goal(X). q(X) :- p(X), X = b(_). r(X) :- p(X), X = a(_).", ["p(X)", "r(X)"]),
        ("p(b(X)) :- goal(a(X)). q :- p(a(_)). r :- p(b(_)).", ["p(b(X))", "r"]),
        ("p(X) :- goal(a(X)), not q(X). q(X) :- goal(X), X != a(_).", ["p(X)", "q(X)"]),
        ("p(X) :- goal(a(X)), X = @f(X). q(X) :- p(X), X > 3.", ["p(X)", "q(X)"]),
        ("p(X; Y) :- goal(a(X)), Y = c. q :- p(_).", ["p(X;Y)", "q"]),
        ("p(X) :- goal(a(X)). p(f(X)) :- p(X).", ["p(X)", "p(f(X))"]),
        ("h(1; 2). p(X) :- goal(a(_)), h(X). q(X) :- h(X), goal(b(_)).", ["h(1;2)", "p(X)"]),
        ("p(X) :- goal(a(X)), X = f(_). q(X) :- goal(a(X)), X = o2.", ["q(X)"]),
        ("p(X, X) :- goal(a(X)). q :- p(b(_), c(_)). r(X) :- p(X, X).", ["p(X,X)", "r(X)"]),
        ("p(X, X) :- goal(a(_)), X = @f(1). q :- p(b(_), c(_)). r :- p(b(_), b(_)).", ["p(X,X)", "q", "r"]),
    ],
)
def test_what_fires_over_a_fact(text: str, expected: list[str]) -> None:
    """The last case shows that more may fire over shapes than over terms: what a variable hides is not told apart."""
    assert fired(text, "goal(a(o1))") == expected


def test_a_variable_that_occurs_twice_must_have_one_shape() -> None:
    assert fired("p :- goal(X), other(X).", "goal(a(o1))", "other(b(o1))") == []
    assert fired("p :- goal(X), other(X).", "goal(a(o1))", "other(a(o2))") == ["p"]


def test_rules_that_nothing_shown_depends_on_are_not_needed() -> None:
    statements = rules("p(X) :- goal(X). q(X) :- p(X), not r(X). r(X) :- p(X). s(X) :- q(X).")
    program = Program([shaped(Statement.of(rule)) for rule in statements])
    every = range(len(statements))
    assert program.needed(every, [("q", 1)]) == {0, 1, 2}
    assert program.needed(every, [("p", 1)]) == {0}
