"""What is read from the text of a rule is what its syntax tree says."""

from collections.abc import Sequence
from typing import Any

import pytest
from clingo import ast
from clingo.ast import AST, ASTType, ComparisonOperator, Sign
from kit.papers import shipped

from skolem.reasoner.rulebook.numbering import numbered_rule, numbered_show
from skolem.reasoner.rulebook.parts import Atom, Comparison, Nested, Part, Statement, split, without_pools

ODD = """
p(X,Y) :- X = (1..3), Y = @f(X,1), q((a;b)), q(a;b), r(a,b;c), s(X+1,-X,|X|,(X,),(),f(X)*2), not not t, not u(X').
p(X) :- X < Y <= 4, X != f(Y,Z), not X = f(Y), f(X) = X, (X,Y) = (Y,X), X >= 1, Z' > X, r(X,Y,Z,Z').
p(X) :- #sum { W,Z: e(Z,W), not f(Z); 3: g } > 3, not { h; i: j } 2, b(Z) : c(Z), d(Z); q(X, #inf, #sup).
p(_A, __B') :- q(|f(_A,__B')|), r(@f, @g(1,2)), -q(__B'), not -q(_A), #true, s(_, f(_), -3, -f(_A)).
p(a;b,f(c)) :- q(f(1;2),(X,Y),(X;Y),(X,Y;Z)).
"""


def statements(text: str) -> list[Statement]:
    found: list[Statement] = []
    ast.parse_string(text, lambda tree: found.append(Statement.of(tree)))
    return [statement for statement in found if statement.kind is not ASTType.Program]


def parts() -> list[Part]:
    shown = [Statement.of(tree) for _, trees in shipped().sources for tree in trees]
    return [part for s in (*shown, *statements(ODD)) for part in ([] if s.head is None else [s.head, *s.body])]


OPERATORS = {
    ComparisonOperator.Equal: "=",
    ComparisonOperator.NotEqual: "!=",
    ComparisonOperator.LessThan: "<",
    ComparisonOperator.LessEqual: "<=",
    ComparisonOperator.GreaterThan: ">",
    ComparisonOperator.GreaterEqual: ">=",
}
SIGNS = {Sign.NoSign: "", Sign.Negation: "not ", Sign.DoubleNegation: "not not "}


def as_the_tree_says(tree: AST) -> Any:
    """Return what `as_read` should, from the nodes of the tree; None if it is nothing that is read from text."""
    if tree.ast_type is not ASTType.Literal:
        return None
    sign, atom = SIGNS[Sign(tree.sign)], tree.atom
    if atom.ast_type is ASTType.Comparison:
        terms = [str(atom.term), *(str(guard.term) for guard in atom.guards)]
        return sign, terms, [OPERATORS[ComparisonOperator(guard.comparison)] for guard in atom.guards]
    if atom.ast_type is not ASTType.SymbolicAtom or atom.symbol.ast_type is ASTType.UnaryOperation:
        return None
    functions = atom.symbol.arguments if atom.symbol.ast_type is ASTType.Pool else [atom.symbol]
    return sign, functions[0].name, [[str(argument) for argument in function.arguments] for function in functions]


def as_read(part: Part) -> Any:
    match part:
        case Atom():
            return part.sign, part.name, [list(arguments) for arguments in part.pool]
        case Comparison():
            return part.sign, list(part.terms), list(part.operators)
    return None


def test_atoms_and_comparisons_are_read_as_their_trees_say() -> None:
    every = parts()
    for part in every:
        assert as_read(part) == as_the_tree_says(part.tree), part.text
    kinds = {type(part) for part in every}
    assert kinds == {Atom, Comparison, Nested}


@pytest.mark.parametrize(
    ("text", "terms"),
    [
        ("a,f(b,c),(d;e)", [["a", "f(b,c)", "(d;e)"]]),
        ("a;b,c", [["a"], ["b", "c"]]),
        ("", [[]]),
        (";a", [[], ["a"]]),
        ("(X,),()", [["(X,)", "()"]]),
    ],
)
def test_terms_are_split_where_no_bracket_is_open(text: str, terms: Sequence[Sequence[str]]) -> None:
    assert list(split(text)) == terms


def test_a_pool_of_atoms_is_as_many_rules() -> None:
    (rule,) = statements("p(a;b) :- q(X;Y,Z), r((X;Y)), s(Z).")
    every = [each for each in without_pools(rule) if each.head is not None]
    assert len(every) == 8
    assert all(isinstance(part, Atom) and len(part.pool) == 1 for each in every for part in (each.head, *each.body))


NUMBERED = frozenset({("p", 1), ("q", 1), ("q", 2), ("t", 0)})


@pytest.mark.parametrize(
    ("text", "numbered"),
    [
        ("p(X) :- q(X), r(X), X = f(_).", "_of_p(N,X) :- _of_q(N,X); r(X); X = f(_Unnamed1)."),
        ("p(X) :- q(X,_), not q(X,_), r(f(_,_)).", "_of_p(N,X) :- _of_q(N,X,U1); not _of_q(N,X,_); r(f(U2,U3))."),
        ("p(X) :- r(X), not t.", "_of_p(N,X) :- _of_(N); r(X); not _of_t(N)."),
        ("r(X) :- s(X), not u(X).", "r(X) :- s(X); not u(X)."),
        ("t.", "_of_t(N) :- _of_(N)."),
        ("p(C) :- C = #count { X: q(X), s(X) }.", "_of_p(N,C) :- _of_(N); C = #count { X: _of_q(N,X), s(X) }."),
        ("p(X) :- r(X), q(Y) : s(Y).", "_of_p(N,X) :- _of_(N); r(X); _of_q(N,Y): s(Y)."),
        ("#show q/2.", "#show _of_q/3."),
        ("#show r/2.", "#show r/2."),
        ("#show f(X) : q(X), r(X).", "#show _of_(N,f(X)) : _of_q(N,X); r(X)."),
        ("#show f(X) : r(X).", "#show f(X) : r(X)."),
    ],
)
def test_what_depends_on_a_question_gets_its_number(text: str, numbered: str) -> None:
    """The last positive cases show a body in which no literal would say which questions there are."""
    (statement,) = statements(text)
    expected = numbered.replace("(N", "(Number_of_question").replace("U1", "_Unnamed1")
    expected = expected.replace("U2", "_Unnamed2").replace("U3", "_Unnamed3")
    if statement.kind is ASTType.Rule:
        assert str(numbered_rule(statement, NUMBERED)) == expected
    else:
        assert numbered_show(statement, NUMBERED) == expected
