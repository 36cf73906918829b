"""C6: planning takes the favourable observation for granted, and pays for it."""

import math

import pytest
from kit.papers import (
    EXAMPLE_GOAL,
    GREEN_SODA,
    HEAVY,
    NINE,
    Handler,
    at_five_percent,
    can,
    example,
    green,
    only,
    planned,
    posed,
    steps_of,
)

from skolem.reasoner.terms import Compound, nll, prob


def test_a_weighing_is_planned_as_if_it_showed_what_the_goal_needs_though_that_is_not_likely() -> None:
    """ "Under the assumption of most likely observations, it will observe that it is heavy and satisfy the goal." """
    play = example()
    assert play.belief.prob_property("o2", HEAVY) == pytest.approx(0.316, abs=1e-3)
    steps = steps_of(planned(posed(EXAMPLE_GOAL, play.belief), f"b(den(e1,o2),{NINE})", level=1))
    (weigh,) = [step for step in steps if str(step.instance.step) == "weigh(o2)"]
    (reading,) = [r for r in weigh.instance.results if isinstance(r, Compound) and r.name == "bn"]
    mu, tolerance = reading.args[1], reading.args[3]
    assert isinstance(mu, Compound)
    assert isinstance(tolerance, Compound)
    centre, reach = mu.args[0], tolerance.args[0]
    assert isinstance(centre, int)
    assert isinstance(reach, int)
    assert (centre - reach) / 1000.0 > math.log(0.4) > play.belief.gaussian("weight", "o2").mean[0]


def test_the_price_is_the_probability_that_the_observation_turns_out_so() -> None:
    """ "It is assumed that observation actions result in the most likely observation": at -log of its probability."""
    robot = Handler(at_five_percent([can("can1", 0.9)], colour_sd_rgb=0.01))
    supposed = only(posed(GREEN_SODA, robot.belief), f"b(supposed(green,can1),{NINE})")
    favourable = robot.belief.prob_favourable("can1", green(), 0.9)
    assert 0.5 < favourable < 0.99
    assert supposed.price == pytest.approx(nll(favourable), abs=5)


def test_within_a_plan_a_hypothesis_is_paid_for_once() -> None:
    """ "p is the probability that the action will have the desired outcome": P(heavy) enters the plan one time."""
    play = example()
    at = posed(EXAMPLE_GOAL, play.belief)
    steps = steps_of(planned(at, f"b(den(e1,o2),{NINE})", level=1))
    reasons = [str(reason) for step in steps for reason, _ in step.instance.costs]
    assert reasons.count("prior_of_description") == 1
    assert "prior_of_property" not in reasons
    stated = only(at, f"b(prop(heavy,o2),{NINE})")
    supposed = only(at, f"b(supposed(heavy,o2),{NINE})")
    assert prob(stated.price - supposed.price) == pytest.approx(0.316, abs=1e-3)


def test_an_unexpected_observation_makes_a_new_plan() -> None:
    """ "If those actions result in unexpected observations, a new plan will be made based on the new belief." """
    play = example()
    starts = []
    for turn in play.turns_to_the_end():
        starts += [(plan.step, plan.layers[0][0].op) for plan in turn.plans if plan.cause == "start"]
        if len(starts) == 2:
            break
    assert [op for _, op in starts] == ["ExamineObj(e1, o2)", "FindObj(e1, _reg2_, sk(var(o)))"]
    weighed = next(t.action.step for t in play.turns if t.action is not None and t.action.op == "Weigh(o2)")
    assert starts[1][0] == weighed + 1
