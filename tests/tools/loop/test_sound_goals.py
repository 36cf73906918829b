"""Goals of every kind, at bounds from .5 to .98, are pursued to the end in the world without physics."""

import pytest
from kit.runs import Run, ran

GREEN = "B(Den(lambda x. Green(x), o), {p})"
BOUNDS = (0.5, 0.9, 0.98)
OF_KNOWN = {  # sim1_green: three sodas that the robot was told of; sodaC is green and weighs .35 kg
    "meant": f"exists o. {GREEN}",
    "a colour word": "B(Green(sodaC), {p})",
    "a weight word": "B(Light(sodaC), {p})",
    "a type": "B(Soda(sodaC), {p})",
    "in": "B(In(sodaC, table1), {p})",
    "on": "B(On(sodaC, table1), {p})",
    "a weight": "B(Weight(sodaC), any, 0.1, 0.1, {p})",
    "a colour": "B(Color(sodaC), any, (0.02, 0.05, 0.05), (0.1, 0.1, 0.1), {p})",
    "a pose": "B(Pose(sodaC), any, (0.02, 0.02, 6), (0.1, 0.1, 6), {p})",
    "KRD": f"exists o. {GREEN} & KRD(o)",
}
OF_UNMET = {  # sim3_unknown: the same, but the robot was told of tables alone
    "a weight": f"exists o. {GREEN} & B(Weight(o), any, 0.05, 0.1, {{p}})",
    "a colour": f"exists o. {GREEN} & B(Color(o), any, (0.02, 0.05, 0.05), (0.1, 0.1, 0.1), {{p}})",
    "a pose": f"exists o. {GREEN} & B(Pose(o), any, (0.02, 0.02, 6), (0.1, 0.1, 6), {{p}})",
    "KRD": f"exists o. {GREEN} & KRD(o)",
    "on": f"exists o. {GREEN} & B(On(o, table1), {{p}})",
    "two": f"exists o, u. {GREEN} & B(Den(lambda x. Blue(x), u), {{p}}) & B(On(o, table1), {{p}})",
}
HELD = (  # in sim1_green, before the first action
    "KRD(sodaE)",
    "exists o. KRD(o)",
    "B(Soda(sodaE), 0.98)",
    "B(In(sodaE, table1), 0.5)",
    "exists o. B(In(o, table2), 0.9)",
    "exists o, u. B(In(o, table1), 0.9) & B(In(u, table2), 0.9)",
    "exists o. B(Den(lambda x. Soda(x), o), 0.9) & KRD(o)",
)


def pursued(scenario: str, goal: str, p: float = 0.0) -> Run:
    return ran(scenario, 0, overrides=(f"goal={goal.format(p=p)}",))


@pytest.mark.parametrize("p", BOUNDS)
@pytest.mark.parametrize("kind", OF_KNOWN)
def test_a_goal_about_what_is_known_is_achieved(kind: str, p: float) -> None:
    run = pursued("sim1_green", OF_KNOWN[kind], p)
    assert run.achieved, run.end.reason
    assert run.verdict.true


@pytest.mark.parametrize("p", BOUNDS)
@pytest.mark.parametrize("kind", OF_UNMET)
def test_a_goal_about_what_is_not_met_yet_is_achieved(kind: str, p: float) -> None:
    """It is searched for first; what else the goal says of it waits for that."""
    run = pursued("sim3_unknown", OF_UNMET[kind], p)
    assert run.achieved, run.end.reason
    assert run.verdict.true
    assert any(operation.startswith("LookAtRegion") for operation in run.operators)


@pytest.mark.parametrize("goal", HELD)
def test_a_goal_that_holds_already_takes_no_action_and_no_search(goal: str) -> None:
    run = pursued("sim1_green", goal)
    assert run.achieved
    assert not run.actions
    assert not any(decision.expansions for decision in run.decisions)
