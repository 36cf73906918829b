"""Goals about numbers of objects: reached by moving and looking, true of nothing, and those about the only one."""

import pytest
from kit.recordings import recorded

from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, RunEnd, Verdict


def ended(goal: str, scenario: str = "illustrative") -> tuple[RunEnd, Verdict, list[str]]:
    trace = Trace(recorded(scenario, 0, "symbolic", (f"goal={goal}",)))
    (end,), (verdict,) = trace.of(RunEnd), trace.of(Verdict)
    return end, verdict, [action.op for action in trace.of(Action)]


@pytest.mark.parametrize(
    "goal",
    [
        "exists o. B(Den(lambda x. Can(x) & not Green(x), o), 0.9) & B(On(o, desk), 0.9)",
        "exists o. B(Den(lambda x. Can(x), o) & On(o, desk), 0.9)",
        "exists distinct o, p. B(Den(lambda x. Can(x), o), 0.9) & B(On(o, desk), 0.9)"
        " & B(Den(lambda x. Can(x), p), 0.9) & B(On(p, desk), 0.9)",
        "B(at least 2 x. Can(x) & On(x, desk), 0.9)",
        "B(every x. Can(x) -> On(x, desk), 0.85)",
        "B(not exists x. Green(x) & On(x, table), 0.85)",
    ],
)
def test_goals_about_numbers_of_objects_are_achieved_and_true(goal: str) -> None:
    end, verdict, actions = ended(goal)
    assert end.status == "goal_achieved", end.reason
    assert verdict.true
    assert any(op.startswith("Pick") for op in actions)


def test_an_object_that_is_found_late_joins_those_of_which_every_one_is_meant() -> None:
    end, verdict, actions = ended("B(every x. Can(x) -> On(x, desk), 0.85)")
    assert (end.status, verdict.true) == ("goal_achieved", True)
    assert "Place(_o1_, desk)" in actions  # the can on the sideboard, of which nobody told


def test_a_sentence_that_is_true_of_nothing_says_so() -> None:
    end, _, actions = ended("B(every x. Crate(x) -> On(x, table1), 0.9)", "sim1_green")
    assert (end.status, actions) == ("goal_achieved", [])
    assert "true of nothing: every x. Crate(x) -> On(x, table1)" in end.reason


def test_two_objects_that_fit_end_a_goal_about_the_only_one_and_are_told_apart() -> None:
    end, _, _ = ended("exists o. B(Den(the x. Can(x) & Green(x), o), 0.8) & B(On(o, desk), 0.9)")
    assert end.status == "no_unique_referent"
    assert "o2" in end.reason
    assert "_o1_" in end.reason
    assert "o2 is on table, _o1_ on sideboard" in end.reason


def test_the_only_one_is_found_by_ruling_the_others_out() -> None:
    goal = "exists o. B(Den(the x. Can(x) & Green(x) & Heavy(x), o), 0.8) & B(On(o, desk), 0.9)"
    end, verdict, actions = ended(goal)
    assert (end.status, verdict.witness) == ("goal_achieved", "o4")
    assert "Weigh(o2)" in actions


@pytest.mark.parametrize(
    ("superlative", "witness", "weighed"),
    [
        ("heaviest x", "o4", {"_o1_", "o2", "o3"}),
        ("lightest x", "o2", {"_o1_", "o2", "o3"}),
        ("nearest x to o1", "o2", set()),
    ],
)
def test_a_superlative_is_known_once_what_may_be_ahead_was_compared(
    superlative: str, witness: str, weighed: set[str]
) -> None:
    end, verdict, actions = ended(f"exists o. B(Den({superlative}. Can(x), o), 0.8) & B(On(o, desk), 0.9)")
    assert (end.status, verdict.true, verdict.witness) == ("goal_achieved", True, witness)
    lifted = {op.removeprefix("Weigh(").removesuffix(")") for op in actions if op.startswith("Weigh")}
    assert lifted <= weighed  # o1 is a carton, and of the nearest one no weight matters


def test_where_nothing_is_the_only_one_the_run_says_what_it_has_searched() -> None:
    end, _, actions = ended("exists o. B(Den(the x. Carton(x) & Green(x) & Heavy(x), o), 0.8)")
    assert end.status == "no_referent"
    assert "_reg2_" in end.reason
    assert actions
