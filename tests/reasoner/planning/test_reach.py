"""The bound of long searches: what a conjunction costs at the least if nothing were destroyed."""

import math
from collections.abc import Sequence

import pytest
from hypothesis import given, settings, strategies as st
from kit.instance_tables import Table, instance, terms

from skolem.reasoner.planning import reach, regression
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.reach import Questions, Reach
from skolem.reasoner.planning.regression import Found, regress
from skolem.reasoner.terms import Term, nll

NAMES = "abcdefgh"


def of(steps: Sequence[Instance], true: Sequence[str], *roots: str, again: bool = False) -> Reach:
    table = Table(list(steps), list(true))
    usable = lambda step: not step.rejected  # noqa: E731
    ask = Questions(table.prepare, table.offers, table.holds, usable, lambda step: step.demanded(9))
    return Reach(terms(*roots), ask, again)


def least(found: Reach, *fluents: str) -> float:
    return found.least(terms(*fluents))


def test_a_fluent_costs_its_cheapest_step_and_the_dearest_precondition_of_that() -> None:
    steps = [
        instance("make", ["a"], [("b", 0), ("c", 0)], 0.9),
        instance("buy", ["a"], [], 0.1),
        instance("find", ["b"], [], 0.5),
        instance("keep", ["c"], [], 0.8),
    ]
    found = of(steps, [], "a")
    assert least(found, "a") == nll(0.9) + nll(0.5)
    assert least(found, "b", "c") == nll(0.5)
    assert least(found) == 0


def test_what_holds_costs_nothing_and_what_no_chain_of_steps_leads_to_costs_more_than_anything() -> None:
    steps = [instance("make", ["a"], [("b", 0), ("c", 0)], 0.9), instance("wait", ["c"], [("c", 0)])]
    found = of(steps, ["b"], "a")
    assert (least(found, "b"), least(found, "c"), least(found, "a")) == (0, math.inf, math.inf)


def test_a_step_gives_what_it_was_not_asked_for_too() -> None:
    steps = [instance("both", ["a", "b"], [], 0.9), instance("make", ["b"], [("never", 0)], 0.9)]
    assert least(of(steps, [], "a", "b"), "b") == nll(0.9)


def test_with_too_many_fluents_the_bound_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reach, "MOST", 1)
    steps = [instance("make", ["a"], [("b", 0)], 0.9), instance("find", ["b"], [("c", 0)], 0.9)]
    assert least(of(steps, [], "a"), "a") == 0


def sought(table: Table, root: frozenset[Term], limit: int = 100_000) -> Found:
    return regress([root], table, lambda _: 9, lambda *_: False, limit, 50_000_000)


def test_a_search_that_cannot_end_well_does_not_try_all_orders_of_the_rest() -> None:
    """Twelve independent fluents have 4096 subsets; the thirteenth can never be true."""
    parts = [f"f{i}" for i in range(12)]
    steps = [*(instance(f"s{f}", [f], [], 0.9) for f in parts), instance("hope", ["g"], [("never", 0)], 0.2)]
    found = sought(Table(steps, []), terms("g", *parts))
    assert (found.steps, found.exhausted) == (None, True)
    assert found.expansions < 2 * regression._LONG


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_the_bound_changes_no_plan(data: st.DataObject) -> None:
    """The same search with the bound from its first node on, and without it."""
    some = st.lists(st.sampled_from(NAMES), max_size=2, unique=True)
    steps = [
        instance(
            f"s{k}",
            data.draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=2, unique=True)),
            [(f, 0) for f in data.draw(some)],
            data.draw(st.sampled_from([0.9, 0.8, 0.5])),
            destroys=data.draw(some),
        )
        for k in range(data.draw(st.integers(1, 8)))
    ]
    true = data.draw(some)
    root = terms(*data.draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=3, unique=True)))
    plans = []
    for long in (-1, 10**9):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(regression, "_LONG", long)
            found = sought(Table(steps, true), root)
        plans.append((found.cost, [str(s.instance.step) for s in found.steps or ()], found.steps is None))
    assert plans[0] == plans[1]
