"""Shares of a bound: they add up to no more, and are enough."""

from itertools import pairwise

import pytest
from hypothesis import given, strategies as st

from skolem.reasoner.planning.sharing import evenly, shares
from skolem.reasoner.terms import nll, prob

COSTS = st.lists(st.integers(0, 2_000_000), min_size=1, max_size=8)
BOUNDS = st.integers(0, 1_000_000)


@given(COSTS, BOUNDS)
def test_shares_add_up_to_no_more_than_the_bound(costs: list[int], bound: int) -> None:
    parts = shares(costs, bound)
    assert len(parts) == len(costs)
    assert sum(parts) <= bound
    assert min(parts) >= 0


@given(COSTS, BOUNDS)
def test_what_costs_more_gets_no_less(costs: list[int], bound: int) -> None:
    given_to = sorted(zip(costs, shares(costs, bound), strict=True))
    assert all(p <= q for (_, p), (_, q) in pairwise(given_to))


@given(COSTS, BOUNDS, st.integers(0, 500_000))
def test_a_looser_bound_gives_no_fact_less(costs: list[int], bound: int, more: int) -> None:
    before, after = shares(costs, bound), shares(costs, bound + more)
    assert all(a >= b for a, b in zip(after, before, strict=True))


@given(COSTS, BOUNDS)
def test_facts_that_fit_with_slack_are_all_believed_to_their_shares(costs: list[int], bound: int) -> None:
    if 2 * sum(costs) <= bound:
        assert all(cost <= part for cost, part in zip(costs, shares(costs, bound), strict=True))


@given(st.integers(1, 900_000), st.integers(1, 10))
def test_even_shares_hold_whatever_the_facts_have_to_do_with_each_other(bound: int, count: int) -> None:
    each = 1.0 - prob(evenly(bound, count))
    assert count * each <= 1.0 - prob(bound) + 1e-6 * count
    assert evenly(bound, 1) == pytest.approx(bound, abs=1)
    assert evenly(nll(0.9), 2) == pytest.approx(nll(0.95), abs=1)
