"""B1: B(phi, p) says that phi is believed with probability at least p."""

import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.minds import TableBelief, Thing
from kit.papers import Handler, at_five_percent, can, holds, posed

from skolem.reasoner.terms import nll

JUST = 3e-6  # relative: the terms of the rules resolve a millionth of a nat


@given(st.floats(0.01, 0.99))
@examples(25)
def test_it_is_true_at_p_and_false_just_above(p: float) -> None:
    """ "P_b(phi = True) >= p." """
    belief = TableBelief({"o": Thing({"soda": p, "bottle": 1.0 - p})})
    assert holds(f"b(type(o,soda),{nll(p)})", belief)
    assert not holds(f"b(type(o,soda),{nll(p * (1.0 + JUST))})", belief)


@pytest.mark.parametrize(("p", "achieved"), [(0.5, True), (0.7999, True), (0.8001, False), (0.9, False)])
def test_a_goal_states_it_in_the_notation_of_the_paper(p: float, achieved: bool) -> None:
    """ "The agent believes phi holds with probability at least p in the current belief state." """
    belief = Handler(at_five_percent([can(soda=0.8)])).belief
    assert (posed(f"B(Soda(can1), {p})", belief).achieved() is not None) is achieved
