"""The scenarios of goals beyond `lambda`, with one such object, with none and with several."""

import pytest
from kit.places import SCENARIOS
from kit.runs import Run, ran, with_physics

from skolem.tools.loop.setup import prepare
from skolem.traces.messages import RunStatus

SCENARIOS_OF_GOALS = ("the_green_can", "the_soda_on_table2", "not_red", "two_cans", "every_soda")
SEEDS = (0, 1, 2)


def well_ended(name: str, run: Run) -> bool:
    """Whether a run ends as its scenario says, with a true goal, and uses the operators that it names."""
    expect = prepare(SCENARIOS / f"{name}.yaml").scenario.expect
    assert expect is not None
    used = {action.op.partition("(")[0].lower() for action in run.actions}
    wanted = {operator.replace("_", "").removesuffix("base") for operator in expect.operators}
    chosen = expect.chosen in (None, run.end.anchor)
    return run.end.status == expect.status and run.verdict.true and wanted <= used and chosen


@pytest.mark.parametrize("name", SCENARIOS_OF_GOALS)
def test_a_goal_is_achieved_and_true_of_what_is_meant(name: str) -> None:
    assert [seed for seed in SEEDS if not well_ended(name, ran(name, seed))] == []


@pytest.mark.physics
@pytest.mark.parametrize("name", SCENARIOS_OF_GOALS)
def test_with_physics_too(name: str) -> None:
    assert well_ended(name, with_physics(name))


@pytest.mark.parametrize(
    ("name", "goal", "status"),
    [
        ("the_green_can", "exists o. B(Den(the x. Can(x) & Blue(x), o), 0.9)", "no_referent"),
        ("the_green_can", "exists o. B(Den(the x. Can(x), o), 0.9)", "no_unique_referent"),
        ("the_soda_on_table2", "exists o. B(Den(the x. Soda(x) & Was(On(x, table1)), o), 0.9)", "no_referent"),
        ("the_soda_on_table2", "exists o. B(Den(the x. Soda(x), o), 0.9)", "no_unique_referent"),
        ("two_cans", "B(at least 3 x. Can(x), 0.9)", "goal_unachievable"),
        ("two_cans", "B(exactly 1 x. Can(x), 0.9)", "goal_unachievable"),
        ("not_red", "exists o. B(Den(lambda x. Red(x) & not Soda(x), o), 0.95)", "goal_unachievable"),
        ("every_soda", "B(every x. Carton(x) -> On(x, table1), 0.9)", "goal_achieved"),
    ],
)
def test_where_none_or_too_many_are_meant_the_run_says_so(name: str, goal: str, status: RunStatus) -> None:
    run = ran(name, overrides=(f"goal={goal}",))
    assert (run.end.status, run.verdict.true) == (status, status == "goal_achieved")


def test_what_tells_two_referents_apart_is_said() -> None:
    reason = ran("the_green_can", overrides=("goal=exists o. B(Den(the x. Can(x), o), 0.9)",)).end.reason
    assert "canA" in reason
    assert "canB" in reason
    assert "what tells them apart: canA is on table2, canB on table3" in reason


def test_a_soda_that_nobody_told_of_joins_the_others() -> None:
    run = ran("every_soda")
    assert run.named("Pick") == ["sodaB", "_o1_"]


def test_what_parts_that_are_believed_together_describe_is_looked_for() -> None:
    run = ran("every_soda", overrides=("goal=exists o. B(Den(lambda x. Green(x), o) & On(o, table1), 0.9)",))
    assert (run.achieved, run.verdict.true) == (True, True)
    assert run.named("Place") == ["_o1_"]


def test_a_plan_is_dropped_whenever_a_soda_turns_out_to_be_red() -> None:
    lost = [plan for plan in ran("not_red").plans if plan.cause == "preimage_lost"]
    assert [{name for name in ("sodaA", "sodaB", "sodaE") if name in str(plan.false_fluents)} for plan in lost] == [
        {"sodaE"},
        {"sodaA"},
    ]
