"""C7: plan, execute the first step, observe, update; plan anew only if no pre-image holds."""

from functools import cache

from kit.papers import GREEN_TO_TABLE1, plans, rehearsed, shipped, three_sodas
from kit.plays import BLUE, GREEN, RED, Play


@cache
def lucky() -> Play:
    """Return a play in which everything turns out as planned: the likeliest soda is green."""
    things = three_sodas()
    things["sodaB"].hsv, things["sodaB"].hsv_sd = (GREEN, 0.6, 0.6), 0.2
    play = Play(shipped(), GREEN_TO_TABLE1, things, {"sodaE": RED, "sodaB": GREEN, "sodaC": BLUE})
    play.run()
    return play


def test_if_every_assumed_observation_happens_one_plan_for_the_goal_is_made() -> None:
    """ "Make an approximately optimal plan to achieve a goal given the current belief state." """
    play = lucky()
    assert play.turns[-1].end is not None
    assert play.turns[-1].end.status == "goal_achieved"
    assert len(plans(play, "start")) == 1
    assert {plan.cause for plan in plans(play)} <= {"start", "refine", "skipped_forward", "fell_back", "done"}


def test_what_is_executed_is_the_step_that_the_stack_has_chosen() -> None:
    """ "Execute the first step of the plan." """
    for play in (lucky(), rehearsed()[0]):
        stack = None
        for turn in play.turns:
            stack = turn.plans[-1] if turn.plans else stack
            if turn.action is not None:
                assert stack is not None
                assert turn.action.op == stack.layers[-1][stack.current[-1]].op


def test_each_turn_is_about_the_belief_after_the_observation_of_the_one_before() -> None:
    """ "Make an observation and use it to update the belief." """
    versions = [(d.step, d.belief_version) for turn in rehearsed()[0].turns for d in turn.decisions]
    assert versions
    assert all(step == version for step, version in versions)  # one event per action in these plays


def test_plans_for_the_goal_are_made_only_at_the_start_and_after_all_pre_images_were_lost() -> None:
    """ "The belief state is not in the pre-image of any of the plans on the stack. The robot replans." """
    play, _ = rehearsed()
    causes = [plan.cause for plan in plans(play) if plan.cause in ("start", "preimage_lost", "refused")]
    lost_all = [plan for plan in plans(play, "preimage_lost", "refused") if not plan.layers]
    assert len(plans(play, "start")) == 1 + len(lost_all)
    assert causes[0] == "start"
