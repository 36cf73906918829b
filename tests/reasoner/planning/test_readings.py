"""Readings of a goal: the same as by enumeration, without enumerating them."""

import itertools
from collections.abc import Callable

import pytest
from hypothesis import given, strategies as st

from skolem.reasoner.planning.readings import fitting, likeliest
from skolem.reasoner.terms import Compound, Term, compound

X, Y, Z = (compound("var", name) for name in "xyz")
COSTS = st.lists(st.lists(st.integers(0, 5), min_size=1, max_size=4), max_size=4)


@given(COSTS, st.integers(1, 40))
def test_the_likeliest_readings_are_those_that_enumeration_and_sorting_give(costs: list[list[int]], most: int) -> None:
    every = itertools.product(*(range(len(column)) for column in costs))
    cheapest = sorted(every, key=lambda chosen: (sum(c[i] for c, i in zip(costs, chosen, strict=True)), chosen))
    assert likeliest(costs, most) == sorted(cheapest[:most])


def asked(true: set[tuple[str, ...]], log: list[str] | None = None) -> Callable[[Term], bool]:
    def holds(fluent: Term) -> bool:
        assert isinstance(fluent, Compound)
        if log is not None:
            log.append(str(fluent))
        return (fluent.name, *map(str, fluent.args)) in true

    return holds


@given(
    st.sets(st.tuples(st.just("red"), st.sampled_from("abcd"))),
    st.sets(st.tuples(st.just("on"), st.sampled_from("abcd"), st.sampled_from("abcd"))),
    st.booleans(),
)
def test_the_fitting_readings_are_those_that_enumeration_gives_in_the_same_order(
    red: set[tuple[str, ...]], on: set[tuple[str, ...]], distinct: bool
) -> None:
    fluents = [compound("red", X), compound("on", X, Y), compound("on", Y, Z)]
    found = list(fitting([X, Y, Z], ["abcd"] * 3, fluents, asked(red | on), lambda _: False, distinct))
    every = itertools.permutations("abcd", 3) if distinct else itertools.product("abcd", repeat=3)
    fits = [(x, y, z) for x, y, z in every if ("red", x) in red and ("on", x, y) in on and ("on", y, z) in on]
    assert [(each[X], each[Y], each[Z]) for each in found] == fits


def test_twenty_variables_with_twenty_candidates_are_bound_one_after_another() -> None:
    variables = [compound("var", f"v{i}") for i in range(20)]
    names = [f"o{i}" for i in range(20)]
    log: list[str] = []
    true: set[tuple[str, ...]] = {("red", "o19")}
    fluents = [compound("red", v) for v in variables]
    first = next(iter(fitting(variables, [names] * 20, fluents, asked(true, log), lambda _: False)))
    assert set(first.values()) == {"o19"}
    assert len(log) == 400
    assert len(likeliest([[5] * 19 + [0]] * 20)) == 1000


@pytest.mark.parametrize(("red", "questions"), [(set(), 0), ({("red", "b")}, 1)])
def test_a_dear_question_is_asked_only_where_all_else_holds(red: set[tuple[str, ...]], questions: int) -> None:
    log: list[str] = []
    fluents = [compound("at", X), compound("red", X)]
    list(fitting([X], ["abc"], fluents, asked(red, log), lambda f: isinstance(f, Compound) and f.name == "at"))
    assert sum(question.startswith("at") for question in log) == questions
