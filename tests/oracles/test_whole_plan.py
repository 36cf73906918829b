"""The regressor against the optimisation of a whole plan in one clingo program, at a small horizon.

The program knows steps in time, states that change, and `#minimize`; nothing of regression, subgoals or a queue.
"""

import clingo
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.instance_tables import Table, instance, terms

from skolem.reasoner.planning import regression
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import Term

HORIZON = 5
FLUENTS = [f"f{k}" for k in range(5)]

PLAN = """
time(0..horizon - 1).
{ take(T, S) : step(S) } 1 :- time(T).
:- take(T, S), needs(S, F), not true(T, F).
true(0, F) :- now(F).
true(T + 1, F) :- take(T, S), gives(S, F).
true(T + 1, F) :- time(T), true(T, F), not lost(T, F).
lost(T, F) :- take(T, S), destroys(S, F), not gives(S, F).
:- wanted(F), not true(horizon, F).
#minimize { C, T : take(T, S), price(S, C) }.
#defined needs/2. #defined gives/2. #defined destroys/2. #defined now/1. #defined price/2.
"""


def whole_plan(steps: list[Instance], now: list[str], goal: frozenset[Term]) -> int | None:
    """Return the cost of the best sequence of at most `HORIZON` steps; None if there is none."""
    facts = [f"now({f})." for f in now] + [f"wanted({f})." for f in sorted(goal, key=str)]
    for step in steps:
        facts += [f"step({step.step}).", f"price({step.step}, {step.price})."]
        facts += [f"gives({step.step}, {f})." for f in step.results]
        facts += [f"needs({step.step}, {f})." for f, _ in step.preconditions]
        facts += [f"destroys({step.step}, {f})." for f in step.destroys]
    control = clingo.Control(["--parallel-mode=1", "-c", f"horizon={HORIZON}"])
    control.add("base", [], PLAN + " ".join(facts))
    control.ground([("base", [])])
    costs: list[int] = []
    control.solve(on_model=lambda model: costs.append(sum(model.cost)))
    return costs[-1] if costs else None


@st.composite
def problems(draw: st.DrawFn) -> tuple[list[Instance], list[str], frozenset[Term]]:
    """Up to five steps with one or two results each, some of which destroy what others need."""
    steps = []
    for k in range(draw(st.integers(2, 5))):
        results = draw(st.sets(st.sampled_from(FLUENTS), min_size=1, max_size=2))
        needs = draw(st.sets(st.sampled_from(FLUENTS), max_size=2)) - results
        destroys = draw(st.sets(st.sampled_from(FLUENTS), max_size=1)) - results - needs
        p = draw(st.sampled_from([0.5, 0.6, 0.7, 0.8, 0.9]))
        steps.append(instance(f"s{k}", results, [(n, 0) for n in needs], p, destroys))
    now = draw(st.sets(st.sampled_from(FLUENTS), max_size=3))
    goal = draw(st.sets(st.sampled_from(FLUENTS), min_size=1, max_size=3))
    return steps, sorted(now), terms(*goal)


@given(problems())
@examples(200)
def test_regression_finds_the_optimum_of_the_whole_plan(
    problem: tuple[list[Instance], list[str], frozenset[Term]],
) -> None:
    steps, now, goal = problem
    found = regression.regress([goal], Table(steps, now), lambda _: 9, lambda *_: False, 3000, 50_000_000, optimal=True)
    best = whole_plan(steps, now, goal)
    if found.steps is not None and len(found.steps) > HORIZON:
        assert best is None or best > found.cost
    else:
        assert (None if found.steps is None else found.cost) == best


@given(problems())
@examples(200)
def test_the_bound_that_the_usual_search_reports_holds(
    problem: tuple[list[Instance], list[str], frozenset[Term]],
) -> None:
    steps, now, goal = problem
    arguments = (Table(steps, now), lambda _: 9, lambda *_: False, 3000, 50_000_000)
    usual, best = regression.regress([goal], *arguments), regression.regress([goal], *arguments, optimal=True)
    assert (usual.steps is None) == (best.steps is None)
    if usual.steps is not None:
        assert usual.bound <= best.cost <= usual.cost
        assert usual.within is None or usual.cost <= usual.within * best.cost * (1 + 1e-12)
        assert best.within == 1.0
