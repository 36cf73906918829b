"""B13: how sure the robot has to be is a part of the goal."""

import pytest
from kit.minds import Thing
from kit.papers import GREEN_TO_TABLE1, first_decision, shipped, three_sodas
from kit.plays import GREEN, Play


def perhaps_green() -> dict[str, Thing]:
    """The soda on the second table is green with probability .79."""
    things = three_sodas()
    things["sodaB"].hsv, things["sodaB"].hsv_sd = (GREEN, 0.8, 0.8), 0.08
    return things


@pytest.mark.parametrize(
    ("p", "plan"),
    [("0.9", ("ExamineObj(e1, sodaB)", "Place(sodaB, table1)")), ("0.5", ("Place(sodaB, table1)",))],
)
def test_two_thresholds_give_two_plans_on_one_belief(p: str, plan: tuple[str, ...]) -> None:
    """ "B(Den(expr, obj), p), which means that the robot believes, with probability at least p." """
    goal = GREEN_TO_TABLE1.replace("x), o), 0.9", f"x), o), {p}")
    assert first_decision(Play(shipped(), goal, perhaps_green())) == plan


def test_a_lower_threshold_spares_the_look_at_the_colour() -> None:
    """ "The goal is in belief space": the plans contain actions that gain as much information as it asks for."""
    lengths = []
    for p in ("0.9", "0.5"):
        goal = GREEN_TO_TABLE1.replace("x), o), 0.9", f"x), o), {p}")
        lengths.append(len(Play(shipped(), goal, perhaps_green(), {"sodaB": GREEN}).run()))
    assert lengths[1] < lengths[0]
