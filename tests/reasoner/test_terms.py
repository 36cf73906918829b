"""Terms, their codec to clingo symbols, patterns and micro-nats."""

import math
import pickle
import random
from itertools import pairwise

import clingo
import pytest
from hypothesis import given, strategies as st

from skolem.reasoner.terms import (
    CAP_MICRONATS,
    Compound,
    Term,
    compound,
    from_symbol,
    matches,
    nll,
    parse_term,
    prob,
    read_term,
    substitute,
    to_symbol,
)

CONSTANTS = st.sampled_from(["o", "_o1_", "sodaE", "green", "any", "table1"])
ATOMIC = st.one_of(st.integers(-(2**31), 2**31 - 1), CONSTANTS)


def compounds(children: st.SearchStrategy[Term]) -> st.SearchStrategy[Term]:
    named = st.builds(
        Compound, st.sampled_from(["b", "den", "var", "holds"]), st.lists(children, min_size=1, max_size=3).map(tuple)
    )
    return st.one_of(named, st.builds(Compound, st.just(""), st.lists(children, max_size=3).map(tuple)))


TERMS: st.SearchStrategy[Term] = st.recursive(ATOMIC, compounds, max_leaves=8)
DEN = compound("b", compound("den", "e1", compound("var", "o")), nll(0.9))


@given(TERMS)
def test_a_term_survives_the_trip_through_clingo(term: Term) -> None:
    assert from_symbol(to_symbol(term)) == term


@given(TERMS)
def test_text_is_what_clingo_prints_and_reads(term: Term) -> None:
    assert str(term) == str(to_symbol(term))
    assert parse_term(str(term)) == term


@given(st.lists(TERMS, max_size=6), st.randoms(use_true_random=False))
def test_compounds_are_ordered_by_text(terms: list[Term], shuffle: random.Random) -> None:
    found = [term for term in terms if isinstance(term, Compound)]
    shuffle.shuffle(found)
    assert [str(term) for term in sorted(found)] == sorted(str(term) for term in found)


def test_equal_text_means_equal_and_equal_hash() -> None:
    again = parse_term("b(den(e1,var(o)),105361)")
    assert again == DEN
    assert hash(again) == hash(DEN)
    assert pickle.loads(pickle.dumps(DEN)) == DEN


def test_a_term_cannot_be_changed() -> None:
    with pytest.raises(AttributeError, match="immutable"):
        DEN.name = "c"


def test_a_compound_is_taken_apart_by_match() -> None:
    match DEN:
        case Compound("b", (Compound("den", (expression, _)), int(bound))):
            assert (expression, bound) == ("e1", 105361)
        case _:
            pytest.fail("the pattern does not match")


@pytest.mark.parametrize("symbol", [clingo.String("green"), clingo.Infimum, clingo.Function("p", [], False)])
def test_symbols_the_rules_do_not_use_are_refused(symbol: clingo.Symbol) -> None:
    with pytest.raises(ValueError, match="is not a term of the rules"):
        from_symbol(symbol)


@pytest.mark.parametrize("text", ['f("")', '"a(b)"', "f(a", "b)", "f(#sup)", "-f(a)", "f(g,-h)"])
def test_text_of_what_is_no_term_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is not a term of the rules"):
        read_term(text)


@pytest.mark.parametrize("text", ["p(X)", "p(", ""])
def test_text_that_is_no_ground_term_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is not a ground term"):
        parse_term(text)


def test_substitution_replaces_every_occurrence() -> None:
    binding: dict[Term, Term] = {compound("var", "o"): "o2"}
    assert str(substitute(DEN, binding)) == "b(den(e1,o2),105361)"
    assert substitute(DEN, {compound("var", "q"): "o2"}) is DEN


@pytest.mark.parametrize(
    ("pattern", "term", "expected"),
    [
        ("b(on(o2,any),any)", "b(on(o2,table1),105361)", True),
        ("b(on(o2,any),any)", "b(on(o3,table1),105361)", False),
        ("any", "krd(var(o))", True),
        ("holding(any)", "holding(right,o2)", False),
        ("handempty", "handempty", True),
        ("krd(o2)", "krd(any)", False),
        ("sd(under(50),any)", "sd(8,8)", True),
        ("sd(under(50),any)", "sd(50,50)", False),
        ("sd(under(50),any)", "sd(any,any)", False),
    ],
)
def test_any_matches_every_term_and_under_every_smaller_number(pattern: str, term: str, expected: bool) -> None:
    assert matches(parse_term(pattern), parse_term(term)) is expected


@pytest.mark.parametrize(
    ("p", "micronats"), [(0.9, 105361), (0.999999, 1), (1.0, 0), (1.5, 0), (0.0, CAP_MICRONATS), (-0.1, CAP_MICRONATS)]
)
def test_micronats(p: float, micronats: int) -> None:
    assert nll(p) == micronats


def test_micronats_of_nan_is_an_error() -> None:
    with pytest.raises(ValueError, match="not a number"):
        nll(math.nan)


@given(st.lists(st.floats(0, 1), min_size=2, max_size=6))
def test_micronats_fall_as_probability_rises(values: list[float]) -> None:
    costs = [nll(p) for p in sorted(values)]
    assert all(a >= b for a, b in pairwise(costs))


@given(st.integers(0, CAP_MICRONATS))
def test_micronats_survive_the_trip_through_probability(micronats: int) -> None:
    assert abs(nll(prob(micronats)) - micronats) <= 1


def test_forty_two_capped_costs_fit_clingos_integers() -> None:
    assert 42 * CAP_MICRONATS < 2**31
