"""C10: ExamineObj(expr, Props, Obj, P_r) as printed."""

import math

import pytest
from kit.papers import EXAMPLE_GOAL, NINE, example, normal_tail, only, posed, preconditions, results

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import Compound, nll, prob

P_R = 0.9
ROUNDING = 4e-6  # the rule leaves three micro-nats of the bound for it


def rule() -> Instance:
    """Return the rule for o2 of the paper's example."""
    return only(posed(EXAMPLE_GOAL, example().belief), f"b(den(e1,o2),{nll(P_R)})")


def prior() -> float:
    """Return P_p by hand: can .80, green .992, heavy .316."""
    return 0.80 * 0.992 * normal_tail(math.log(0.4), math.log(0.3), 0.6)


def test_its_arguments_are_the_expression_the_properties_the_object_and_p_r() -> None:
    """ "ExamineObj(expr, Props, Obj, P_r)." """
    step = rule().step
    assert isinstance(step, Compound)
    assert (step.name, [str(a) for a in step.args]) == ("examine", ["e1", "(heavy,soda)", "o2", str(NINE)])


def test_its_preconditions_are_holds_of_the_properties_and_den_at_the_prior() -> None:
    """ "precond: B(Holds(Props, Obj), P_r), B(Den(expr, Obj), P_p), PropsFor(expr) = Props", and that it exists."""
    ((holds, level), (_, rest_level), (exists, exists_level), (den, at_once)) = sorted(
        preconditions(rule()), reverse=True
    )
    assert holds.startswith("b(holds((heavy,soda),o2),")
    assert exists == "b(exists(o2),0)"
    assert (level, rest_level, exists_level) == (1, 1, 1)
    assert den.startswith("b(den(e1,o2),")
    assert at_once == 0
    bound = int(den.rstrip(")").rpartition(",")[2])
    assert prob(bound) == pytest.approx(prior() / 2.0, rel=0.01)  # it may halve before the examination is given up


def test_holds_is_demanded_with_the_share_of_p_r_that_falls_to_those_properties() -> None:
    """ "B(Holds(Props, Obj), P_r)": green is believed already, two thirds of the bound are left."""
    (holds,) = [f for f, _ in preconditions(rule()) if f.startswith("b(holds((heavy,soda),o2),")]
    assert prob(int(holds.rstrip(")").rpartition(",")[2])) == pytest.approx(P_R ** (2 / 3), abs=ROUNDING)


def test_props_stay_what_matters_only_while_the_rest_is_believed() -> None:
    """ "PropsFor(expr) = Props": with the third of the bound that is left for it, green must stay believed."""
    (rest,) = [f for f, _ in preconditions(rule()) if f.startswith("b(holds((green,),o2),")]
    assert prob(int(rest.rstrip(")").rpartition(",")[2])) == pytest.approx(P_R ** (1 / 3), abs=ROUNDING)


def test_its_results_are_den_at_p_r_and_a_rigid_designator() -> None:
    """ "result: B(Den(expr, Obj), P_r), KRD(Obj)." """
    assert results(rule()) == {f"b(den(e1,o2),{nll(P_R)})", "krd(o2)"}


def test_its_cost_is_that_of_the_prior_probability() -> None:
    """ "The cost of this inference rule depends on P_p, the prior probability that Obj has properties Props." """
    assert rule().price == pytest.approx(nll(prior()), abs=0.001 * nll(prior()))
    assert rule().executes is None
