"""Recursion without end is refused before it fills the memory; what ends is let through, and ends."""

import clingo
import pytest
from clingo import ast
from clingo.ast import ASTType
from kit.papers import shipped

from skolem.reasoner.rulebook.parts import Statement
from skolem.reasoner.rulebook.recursion import endless

CONSTANTS = {"limit": 10, "down": -1}
BASE = (
    "#const limit = 10. #const down = -1. h(1, 2). h(-1, any). a(z). a(f(f(z))). b(0, z). b(3, f(z)). "
    "c(z, f(f(z))). d(f(f(f(z))), z). e(z). e(y)."
)


def refused(text: str) -> list[str]:
    """Return the rules that may go on without end."""
    found: list[Statement] = []
    ast.parse_string(text, lambda tree: found.append(Statement.of(tree)))
    return [str(rule.tree) for rule, _ in endless((s for s in found if s.kind is ASTType.Rule), CONSTANTS)]


@pytest.mark.parametrize(
    "rules",
    [
        "a(f(X)) :- a(X).",
        "a(X) :- a(Y), X = f(Y).",
        "a(f(Y)) :- a(X), X = Y.",
        "c(f(X), Y) :- c(X, Y).",
        "c(f(X), f(Y)) :- c(X, Y), e(Y).",
        "a((X, Y)) :- a(X), e(Y).",
        "a(f(X); X) :- a(X).",
        "a(f(X)) :- a((X; f(X))).",
        "a(f(X)) :- a(X), not e(X).",
        "a(f(X)) :- a(X), 1 <= #count { Y : c(Y, X) }.",
        "g(f(X)) :- a(X). a(X) :- g(X).",
        "d(X, f(Y)) :- d(f(X), Y). d(f(X), Y) :- d(X, Y).",
        "d(X, f(Y)) :- d(f(X), Y). d(Z, Y) :- d(_, Y), a(Z).",
        "a(f(X)) :- a(X), a(g(X)).",
        "b(N + 1, X) :- b(N, X).",
        "b(M, X) :- b(N, X), M = N + 1.",
        "b(N - 1, X) :- b(N, X), N < 10.",
        "b(N + 1, X) :- b(N, X), N > 0.",
        "b(N + M, X) :- b(N, X), b(M, X).",
        "b(N + 1, f(X)) :- b(N, X), N != 10.",
        "b(N + 1, f(X)) :- b(N, X), N < M, b(M, X).",
        "b(N - 1, f(X)) :- b(N, X), N < 10.",
        "b(N + 1, X) :- b(N, X), N < most.",
        "b(N + 1, X) :- b(N, X), h(_, W), N < W.",
        "b(N + M, X) :- b(N, X), h(M, _), N < 5.",
        "b(N - 1, X) :- b(N, X), 10 - N > 0.",
        "b(N + 1, X) :- b(N, X), N \\ 10 < 10.",
        "b(N + 1, X) :- b(N, X), h(N \\ 2, _).",
        "b(N + down, X) :- b(N, X), N < 10.",
        "b(N + 1, X) :- b(N, X), N < 2000000000.",
        "b(2 * N, X) :- b(N, X), N <= 100.",
        "b(N + 1, f(X)) :- b(N, X), N < 10. b(N - 1, f(X)) :- b(N, X), N > 0.",
        "b(N + 1, f(X)) :- b(N, X), N < 10. b(N - 1, X) :- b(N, X), N > 0.",
    ],
)
def test_what_grows_without_end_is_refused(rules: str) -> None:
    assert refused(f"{BASE} {rules}")


@pytest.mark.parametrize(
    "rules",
    [
        "a(X) :- a(f(X)).",
        "c(X, Z) :- c(X, Y), c(Y, Z).",
        "c(Y, X) :- c(X, Y).",
        "a(f(X)) :- a(X), e(X).",
        "a(f(X)) :- a(Y), e(X).",
        "a(f(X)) :- a(f(X)), e(_).",
        "g(X) :- a(X). a(Y) :- g(f(Y)).",
        "d(X, f(Y)) :- d(f(X), Y).",
        "d(X, f(Y)) :- d(Z, Y), Z = f(X).",
        "d(X, f(Y)) :- d(f(X), Y). d(X, Y) :- d((X; f(X)), Y).",
        "s(f(X), X) :- e(X). s(f(f(X)), f(X)) :- e(X). d(X, f(Y)) :- d(Z, Y), s(Z, X).",
        "g(Y, f(X)) :- d(f(X), Y). d(X, f(Y)) :- g(Y, f(X)).",
        "b(N + 1, X) :- b(N, X), N < 10.",
        "b(N + 1, X) :- b(N, X), N < M, M = 10.",
        "b(N + 1, X) :- b(N, X), N < limit.",
        "b(N, X) :- b(M, X), M = N - 1, N < 10.",
        "b(N, X) :- b(N + 1, X), N >= 0.",
        "b((N + 1) \\ 12, X) :- b(N, X).",
        "b(N + M, X) :- b(N, X), h(M, _), -5 < N, N < 5.",
        "t(N, M) :- b(N, z), b(M, z). t(N + 1, M + W) :- t(N, M), h(N + 1, W).",
        "h(0..9, 1). k(0, 1). k(N, M + W) :- k(N - 1, M), h(N, W).",
        "b(M, X) :- b(N, X), M = N + 1, M <= 10.",
        "b(N - 1, f(X)) :- b(N, X), 0 < N.",
        "b(2 * N, X) :- b(N, X), 0 <= N, N <= 100.",
        "b(N, X) :- b(_, X), N = #count { Y : e(Y) }.",
        "b(1..3, X) :- b(_, X).",
    ],
)
def test_what_ends_is_let_through(rules: str) -> None:
    assert refused(f"{BASE} {rules}") == []
    control = clingo.Control(["--warn=none"])
    control.add("base", [], f"{BASE} {rules}")
    control.ground([("base", [])])
    assert len(control.symbolic_atoms) < 1000


def test_of_a_circle_the_rules_that_grow_are_named() -> None:
    assert refused("g(X) :- a(X). a(f(X)) :- g(X). h(X) :- a(X).") == ["a(f(X)) :- g(X)."]


def test_what_ships_ends() -> None:
    found = [Statement.of(tree) for _, trees in shipped().sources for tree in trees]
    assert list(endless(s for s in found if s.kind is ASTType.Rule)) == []
