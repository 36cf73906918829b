"""C15: when no pre-image of any plan holds any more, all plans are dropped and the goal is planned for anew."""

from kit.papers import plans, rehearsed

from skolem.traces.messages import Plan


def dropped() -> Plan:
    """Return the first time that all plans were dropped in the paper's example."""
    return next(plan for plan in plans(rehearsed()[0], "preimage_lost") if not plan.layers)


def test_all_plans_are_dropped_right_after_the_weighing_that_shows_100_grams() -> None:
    """ "At this point, the pre-images of both plans on the stack are no longer true." """
    _, operators = rehearsed()
    assert dropped().step == operators.index("Weigh(o2)") + 1
    assert dropped().current == ()


def test_the_fluent_that_became_false_is_named() -> None:
    """ "It does not believe it could plausibly be denoted by expr." """
    assert any(fluent.startswith("b(den(e1,o2),") for fluent in dropped().false_fluents)


def test_the_stack_was_deep_before() -> None:
    """ "Both plans on the stack": the plan for the goal and those that refine it."""
    play, _ = rehearsed()
    before = [plan for plan in plans(play) if plan.step < dropped().step]
    assert len(before[-1].layers) >= 2
    assert [step.op for step in before[-1].layers[0]] == ["ExamineObj(e1, o2)", "Place(o2, desk)"]


def test_the_goal_is_planned_for_anew_in_the_same_turn() -> None:
    """ "The planner is re-invoked, resulting in the new abstract plan." """
    turn = rehearsed()[0].turns[dropped().step]
    causes = [plan.cause for plan in turn.plans]
    assert causes[:2] == ["preimage_lost", "start"]
    assert [step.op for step in turn.plans[1].layers[0]] == [
        "FindObj(e1, _reg2_, sk(var(o)))",
        "Place(sk(var(o)), desk)",
    ]
