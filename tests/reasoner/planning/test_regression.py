"""Regression over hand-made rule instances: cost, order, protection, levels and refusals."""

import itertools
import math

from hypothesis import given, strategies as st
from kit.instance_tables import Table, instance, terms

from skolem.reasoner.planning import regression
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.regression import Found, Subgoal, regress
from skolem.reasoner.terms import Term, nll, prob


def search(table: Table, *roots: Subgoal, level: int = 9, limit: int = 500) -> Found:
    return regress(roots, table, lambda _: level, lambda *_: False, limit, 50_000_000)


def test_how_unlikely_a_plan_may_be_is_for_the_caller_to_say() -> None:
    table = Table([instance("a", ["f"], p=1e-9)], [])
    floors = (1e-8, 1e-10)
    found = [regress([terms("f")], table, lambda _: 9, lambda *_: False, 500, nll(floor)) for floor in floors]
    assert [each.steps is not None for each in found] == [False, True]
    assert [c.rejected for each in found for c in each.candidates] == ["too_unlikely", None]


def names(found: Found) -> list[str]:
    assert found.steps is not None
    return [str(s.instance.step) for s in found.steps]


def test_the_cost_of_a_plan_is_the_product_of_its_probabilities() -> None:
    table = Table([instance("a", ["f"], [("g", 0)], 0.9), instance("b", ["g"], [], 0.8)], [])
    found = search(table, terms("f"))
    assert names(found) == ["b", "a"]
    assert math.isclose(prob(found.cost), 0.9 * 0.8, rel_tol=1e-5)


def test_the_most_likely_of_several_plans_is_found() -> None:
    table = Table(
        [instance("dear", ["f"], [], 0.5), instance("cheap", ["f"], [("g", 0)], 0.9), instance("b", ["g"], [], 0.9)], []
    )
    assert names(search(table, terms("f"))) == ["b", "cheap"]


def test_of_equally_likely_plans_the_one_with_the_risk_early_wins() -> None:
    table = Table([instance("safe", ["f"], [], 0.99), instance("risky", ["g"], [], 0.5)], [])
    assert names(search(table, terms("f", "g"))) == ["risky", "safe"]


def test_a_fluent_that_holds_now_is_protected_from_the_steps_before_its_use() -> None:
    """Dropping `h` because it holds now would put the step that destroys it first."""
    breaks = instance("breaks", ["g"], destroys=["h"])
    uses = instance("uses", ["f"], [("h", 0)])
    repairs = instance("repairs", ["h"])
    found = search(Table([breaks, uses, repairs], ["h"]), terms("f", "g"))
    assert names(found) == ["uses", "breaks"]


def test_what_a_step_destroyed_is_achieved_again_if_there_is_no_other_way() -> None:
    moves = instance("moves", ["f"], [("h", 0)], destroys=["h"])
    found = search(Table([moves, instance("returns", ["h"])], ["h"]), terms("f", "h"))
    assert names(found) == ["moves", "returns"]


def test_two_steps_that_exclude_each_other_have_no_plan() -> None:
    table = Table([instance("a", ["f"]), instance("b", ["g"])], [], [("f", "g")])
    assert search(table, terms("f", "g")).steps is None


def test_a_postponed_precondition_counts_as_a_clobberer() -> None:
    """G1: weighing needs the object in the hand, though only at a deeper level."""
    weigh = instance("weigh", ["heavy"], [("holding", 1)])
    place = instance("place", ["on"])
    found = search(Table([weigh, place], [], [("holding", "on")]), terms("heavy", "on"), level=0)
    assert names(found) == ["weigh", "place"]


def test_postponed_preconditions_are_not_demanded() -> None:
    table = Table([instance("a", ["f"], [("g", 1)])], [])
    assert names(search(table, terms("f"), level=0)) == ["a"]
    assert search(table, terms("f"), level=1).steps is None


def test_a_physical_step_on_a_placeholder_is_never_made_detailed() -> None:
    place = instance("place(sk(o))", ["on(sk(o))"], [("holding(sk(o))", 1)])
    table = Table([place], ["holding(sk(o))"])
    assert search(table, terms("on(sk(o))"), level=0).steps is not None
    found = search(table, terms("on(sk(o))"), level=1)
    assert found.steps is None
    assert found.candidates[0].rejected == "acts_on_placeholder"


def test_roots_share_one_queue_and_the_likeliest_wins() -> None:
    table = Table([instance("a", ["f(o1)"], [], 0.2), instance("b", ["f(o2)"], [], 0.4)], [])
    assert names(search(table, terms("f(o1)"), terms("f(o2)"))) == ["b"]


def test_equal_roots_are_taken_in_the_order_given() -> None:
    table = Table([instance("a", ["f(o1)"]), instance("b", ["f(o2)"])], [])
    assert names(search(table, terms("f(o2)"), terms("f(o1)"))) == ["b"]


def test_an_inference_with_a_single_way_to_go_is_expanded_alone() -> None:
    chain = [instance(f"i{k}", [f"f{k}"], [(f"f{k + 1}", 0)], 1.0, immediate=True) for k in range(4)]
    others = [instance(f"o{k}", [f"g{k}"]) for k in range(4)]
    table = Table([*chain, *others, instance("look", ["f4"])], [])
    found = search(table, terms("f0", "g0"))
    assert found.steps is not None
    assert found.expansions <= 8


def test_the_limit_of_expansions_is_reported() -> None:
    endless = [instance(f"a{k}", [f"f{k}"], [(f"f{k + 1}", 0)]) for k in range(50)]
    found = search(Table(endless, []), terms("f0"), limit=10)
    assert found.steps is None
    assert not found.exhausted


def test_what_was_refused_in_this_belief_is_not_offered_again() -> None:
    table = Table([instance("a", ["f"], [], 0.9), instance("b", ["f"], [], 0.5)], [])
    found = regress([terms("f")], table, lambda _: 0, lambda i, _: i.step == "a", 100, 50_000_000)
    assert names(found) == ["b"]


def test_the_same_step_offered_for_two_fluents_is_taken_once_for_both() -> None:
    look = [
        Instance(step="look", operation="look", results=terms(f), preconditions=frozenset({(n, 0)}), executes="look")
        for f, n in (("colour", "near"), ("type", "light"))
    ]
    found = search(Table(look, ["near", "light"]), terms("colour", "type"))
    assert names(found) == ["look"]


# ---------------------------------------------------------------- against exhaustive enumeration


@st.composite
def problems(draw: st.DrawFn) -> tuple[list[Instance], list[str], frozenset[Term]]:
    fluents = [f"f{k}" for k in range(5)]
    instances = []
    for k in range(draw(st.integers(2, 6))):
        result = draw(st.sampled_from(fluents))
        needs = draw(st.sets(st.sampled_from(fluents), max_size=2)) - {result}
        destroys = draw(st.sets(st.sampled_from(fluents), max_size=1)) - {result} - needs
        p = draw(st.sampled_from([0.5, 0.7, 0.8, 0.9, 0.95]))
        instances.append(instance(f"s{k}", [result], [(n, 0) for n in needs], p, destroys))
    now = draw(st.sets(st.sampled_from(fluents), max_size=3))
    goal = draw(st.sets(st.sampled_from(fluents), min_size=1, max_size=2))
    return instances, sorted(now), terms(*goal)


def cheapest_forward(instances: list[Instance], now: frozenset[Term], goal: frozenset[Term], depth: int) -> int | None:
    """Least cost over all sequences of at most `depth` steps, by enumeration of states forward."""
    best: dict[frozenset[Term], int] = {now: 0}
    frontier = dict(best)
    for _ in range(depth):
        following: dict[frozenset[Term], int] = {}
        for (state, cost), i in itertools.product(frontier.items(), instances):
            if all(f in state for f, _ in i.preconditions):
                after = (state - i.destroys) | i.results
                total = cost + i.price
                if total < best.get(after, 1 << 60):
                    best[after] = following[after] = total
        frontier = following
    reached = [cost for state, cost in best.items() if goal <= state]
    return min(reached, default=None)


@given(problems())
def test_regression_finds_the_cost_that_exhaustive_forward_search_finds(
    problem: tuple[list[Instance], list[str], frozenset[Term]],
) -> None:
    instances, now, goal = problem
    table = Table(instances, now)
    found = regression.search([goal], table, lambda _: 9, lambda *_: False, 3000, 50_000_000, None, again=True)
    expected = cheapest_forward(instances, terms(*now), goal, 8)
    assert (None if found.steps is None else found.cost) == expected


@given(problems())
def test_a_plan_reaches_the_goal_when_its_steps_are_carried_out_in_order(
    problem: tuple[list[Instance], list[str], frozenset[Term]],
) -> None:
    instances, now, goal = problem
    found = search(Table(instances, now), goal)
    state = terms(*now)
    for step in found.steps or ():
        assert {f for f, _ in step.instance.preconditions} <= state
        state = (state - step.instance.destroys) | step.instance.results
    assert found.steps is None or goal <= state
