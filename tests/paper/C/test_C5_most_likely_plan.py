"""C5: costs are -log p, so the cheapest plan is the most likely one."""

import itertools
import math

import clingo
import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.minds import Region, TableBelief, Thing
from kit.papers import EXAMPLE_GOAL, NINE, example, planned, posed, steps_of

from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.patterns import entails
from skolem.reasoner.planning.regression import Subgoal, regress
from skolem.reasoner.terms import Term, nll, prob


def test_the_cost_of_a_plan_is_that_of_the_product_of_its_probabilities() -> None:
    """ "-log p where p is the probability that the action will have the desired outcome." """
    found = planned(posed(EXAMPLE_GOAL, example().belief), f"b(den(e1,o2),{NINE})", f"b(on(o2,desk),{NINE})", level=1)
    chances = [prob(cost) for step in steps_of(found) for _, cost in step.instance.costs]
    assert len(chances) > 5
    assert prob(found.cost) == pytest.approx(math.prod(chances), rel=1e-9)
    assert all(
        step.instance.price == nll(math.prod(prob(c) for _, c in step.instance.costs)) for step in found.steps or ()
    )


# ---------------------------------------------------------------- against two oracles, on abstract plans


@st.composite
def beliefs(draw: st.DrawFn) -> TableBelief:
    """The example with other numbers: which object, or which region, is the best bet differs."""
    belief = example().belief
    for name in ("o1", "o2", "o3"):
        thing: Thing = belief.things[name]
        soda = draw(st.floats(0.1, 0.95))
        thing.types, thing.on = {"soda": soda, "bottle": 1.0 - soda}, draw(st.sampled_from(["side", "desk"]))
        thing.hsv = (draw(st.floats(0.2, 0.5)), 0.8, 0.8)
    belief.spaces["_reg3_"] = Region("side")
    for region in belief.spaces.values():
        region.objects = draw(st.floats(0.1, 6.0))
    return belief


def reachable(at: PosedGoal, root: Subgoal) -> list[Instance]:
    """Return every instance that can be of use for a goal, of the most abstract level."""
    found: dict[Term, Instance] = {}
    waiting = list(root)
    while waiting:
        fluent = waiting.pop()
        if not at.situation.holds(fluent):
            fresh = [i for i in at.offers.offers(fluent) if not i.rejected and i.step not in found]
            found |= {i.step: i for i in fresh}
            waiting += [need for i in fresh for need in i.demanded(0)]
    return list(found.values())


def enumerated(at: PosedGoal) -> int:
    """Return the cost of the likeliest plan over every object and every set of steps that needs nothing more."""
    totals = []
    for root in at.instantiations:
        steps = reachable(at, root)
        for choice in itertools.product((False, True), repeat=len(steps)):
            chosen = [step for step, taken in zip(steps, choice, strict=True) if taken]
            needed = {*root, *(need for step in chosen for need in step.demanded(0))}
            given_by = [r for step in chosen for r in step.results]
            if all(at.situation.holds(f) or any(entails(r, f) for r in given_by) for f in needed):
                totals.append(sum(step.price for step in chosen))
    return min(totals)


ORACLE = """
1 { chosen(R) : root(R) } 1.
{ taken(R, S) : step(R, S, _) } :- chosen(R).
needed(R, F) :- chosen(R), wants(R, F).
needed(R, F) :- taken(R, S), needs(R, S, F).
:- needed(R, F), not taken(R, S) : gives(R, S, F).
#minimize { C, S : taken(R, S), step(R, S, C) }.
#defined needs/3. #defined gives/3. #defined step/3. #defined wants/2.
"""


def minimised(at: PosedGoal) -> int:
    """Return the same by one optimisation of the whole plan in clingo."""
    facts = []
    for index, root in enumerate(at.instantiations):
        steps = reachable(at, root)
        needs = {(s.step, need) for s in steps for need in s.demanded(0) if not at.situation.holds(need)}
        wants = [f for f in root if not at.situation.holds(f)]
        facts += [f"root({index}).", *(f"wants({index}, {f})." for f in wants)]
        facts += [f"step({index}, {s.step}, {s.price})." for s in steps]
        facts += [f"needs({index}, {step}, {need})." for step, need in needs]
        facts += [
            f"gives({index}, {s.step}, {f})."
            for s in steps
            for f in {*wants, *(need for _, need in needs)}
            if any(entails(r, f) for r in s.results)
        ]
    control = clingo.Control(["--parallel-mode=1"])
    control.add("base", [], ORACLE + " ".join(facts))
    control.ground([("base", [])])
    costs: list[int] = []
    control.solve(on_model=lambda model: costs.append(sum(model.cost)))
    return costs[-1]


@given(beliefs())
@examples(8)
def test_the_plan_is_the_likeliest_of_all_by_enumeration_and_by_whole_plan_optimisation(belief: TableBelief) -> None:
    """ "A plan that minimizes the sum of these costs: the open-loop plan that is most likely to achieve the goal." """
    at = posed(EXAMPLE_GOAL, belief)
    found = regress(at.instantiations, at.offers, lambda _: 0, lambda *_: False, 3000, 50_000_000)
    assert found.steps is not None
    assert found.cost == enumerated(at) == minimised(at)
