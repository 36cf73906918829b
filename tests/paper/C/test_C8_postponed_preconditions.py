"""C8: detailed planning is postponed: nothing is computed for a later step before the first one is done."""

import pytest
from kit.papers import (
    EXAMPLE_GOAL,
    GREEN_TO_TABLE1,
    HUES,
    NINE,
    example,
    planned,
    plans,
    posed,
    rehearsed,
    shipped,
    steps_of,
    three_sodas,
)
from kit.plays import Play
from kit.runs import Run, over, with_physics

from skolem.traces.messages import Geometry

SODAS = ("sodaE", "sodaB", "sodaC")


def about_motions(asked: list[str]) -> list[str]:
    """Return the questions but those for the room on a support: no motion is computed for these."""
    return [question for question in asked if not question.startswith("blockers place(")]


def test_no_motion_is_asked_for_later_steps_before_the_first_one_is_done() -> None:
    """ "Eventually taking primitive actions without planning in detail for later parts of the plan." """
    play = Play(shipped(), GREEN_TO_TABLE1, three_sodas(), HUES)
    for turn in play.turns_to_the_end():
        if turn.action is not None and turn.action.op == "LookAt(sodaC)":
            break
    assert play.geometry.asked
    assert all("look(" in question for question in about_motions(play.geometry.asked))


def test_in_the_example_nothing_is_asked_about_the_desk_before_the_weighing() -> None:
    """ "Begin refining the initial step." """
    play = example()
    asked: list[int] = []
    for turn in play.turns_to_the_end():
        asked.append(len(about_motions(play.geometry.asked)))
        if turn.action is not None and turn.action.op == "Weigh(o2)":
            break
    assert not [q for q in about_motions(play.geometry.asked) if "place(" in q and ", o2, desk" in q]
    assert asked[0] <= 6  # before the first action: can it be seen, is it hidden, where to stand
    assert all("o2" in question for question in about_motions(play.geometry.asked)[: asked[0]])


def assert_postponed(run: Run) -> None:
    """Assert that of each soda only the look is computed until it was looked at, and the place only once it is held."""

    def asked(activity: str, name: str) -> list[Geometry]:
        return [question for question in run.asked(activity, name) if about_motions([question.query])]

    looked = {name: run.where(f"LookAt({name})") for name in SODAS}
    first = [q for q in run.questions if q.step == 0 and about_motions([q.query])]
    assert 1 <= len(first) <= 6
    assert all("look(sodaE)" in question.query for question in first)
    for name, look in looked.items():
        too_early = [q for act in ("pick", "place") for q in asked(act, name) if q.step <= look]
        assert len(too_early) == 0
        assert len(asked("look", name)) >= 1
    assert not [q for name in ("sodaE", "sodaB") for act in ("pick", "place") for q in asked(act, name)]
    pick = run.where("Pick(sodaC)")
    assert {question.step for question in asked("pick", "sodaC")} >= {pick}
    assert min(question.step for question in asked("place", "sodaC")) > pick


def test_nothing_is_computed_for_a_step_before_the_one_ahead_of_it_is_done() -> None:
    """ "Begin refining the initial step", over seeds, counted in the recorded questions to the geometry."""
    for run in over("sim1_green", range(6)):
        assert_postponed(run)


@pytest.mark.physics
def test_nothing_is_computed_for_a_later_step_with_the_physics() -> None:
    """ "Begin refining the initial step": each question is one of motion or inverse kinematics of the PR2."""
    assert_postponed(with_physics("sim1_green"))


def test_levels_demand_more_and_more_preconditions() -> None:
    """ "By postponing preconditions in the style of Sacerdoti." """
    at = posed(EXAMPLE_GOAL, example().belief)
    ops = [
        [str(step.instance.step).partition("(")[0] for step in steps_of(planned(at, "holding(o2)", level=level))]
        for level in range(4)
    ]
    assert ops == [["pick"], ["pick"], ["pick"], ["move", "look", "pick"]]
    assert len(steps_of(planned(at, f"b(den(e1,o2),{NINE})", f"b(on(o2,desk),{NINE})", level=0))) == 2


def test_only_the_chosen_first_step_is_ever_refined() -> None:
    """ "Delay detailed planning for physical actions until the high-level precondition has been achieved." """
    for plan in plans(rehearsed()[0], "refine"):
        for upper, chosen, lower in zip(plan.layers, plan.current, plan.layers[1:], strict=False):
            assert lower[-1].subgoal == upper[chosen].subgoal
    assert max(len(plan.layers) for plan in plans(rehearsed()[0])) >= 8
