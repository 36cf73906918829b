"""C16: whether to examine what is known or to search for what is not is decided by cost."""

import pytest
from kit.papers import EXAMPLE_GOAL, HEAVY, denotes, example, first_decision, posed

from skolem.reasoner.terms import parse_term

EXAMINE = ("ExamineObj(e1, o2)", "Place(o2, desk)")
FIND = ("FindObj(e1, _reg2_, sk(var(o)))", "Place(sk(var(o)), desk)")
BOUNDARY = 0.1 / (0.80 * 0.99)  # P(Exists) = P(can) P(green) P(heavy)


@pytest.mark.parametrize(
    ("p_heavy", "plan"), [(0.316, EXAMINE), (0.144, EXAMINE), (0.1275, EXAMINE), (0.125, FIND), (0.083, FIND)]
)
def test_the_likelier_of_the_two_is_done_first(p_heavy: float, plan: tuple[str, ...]) -> None:
    """ "This plan was the most likely to succeed, which means that _o2_ has a non-trivial probability." """
    play = example(p_heavy, p_exists=0.1, log_weight_sd=0.5)
    assert play.belief.prob_property("o2", HEAVY) == pytest.approx(p_heavy)
    assert posed(EXAMPLE_GOAL, play.belief).situation.probability(parse_term("exists_in(e1,_reg2_)")) == pytest.approx(
        0.1
    )
    assert (p_heavy > BOUNDARY) is (plan == EXAMINE)
    assert pytest.approx(0.1263, abs=1e-4) == BOUNDARY
    assert first_decision(play) == plan


def test_searching_applies_when_no_known_object_is_plausible() -> None:
    """ "Applies even when there is no object with a reasonable prior probability of satisfying the expression." """
    play = example(0.125, p_exists=0.01, log_weight_sd=0.5)
    for name in ("o1", "o2", "o3"):
        play.belief.things[name].types = {"table": 1.0}
    assert max(denotes("lambda x. Soda(x) & Green(x) & Heavy(x)", play.belief).values()) == 0.0
    assert first_decision(play) == FIND


def test_a_light_object_is_never_touched_where_searching_is_likelier() -> None:
    """ "Cost-based reasoning encourages the planner": the choice shows in what is done."""
    touched = {}
    for p_heavy in (0.144, 0.083):
        operators = example(p_heavy, log_weight_sd=0.5).run()
        touched[p_heavy] = any("o2" in op.replace("_o2_", "") for op in operators)
    assert touched == {0.144: True, 0.083: False}
