"""G3: goals are interpreted by the same mechanism by which actions are planned."""

from kit.papers import EXAMPLE_GOAL, example, plans, posed, rehearsed

from skolem.reasoner.terms import parse_term


def test_examining_finding_and_placing_are_candidates_of_one_search() -> None:
    """ "It is carried out through the same planning, inference, and execution mechanisms"."""
    (decision, *_) = example().agent.decide(0).decisions
    kinds = {candidate.op.partition("(")[0] for candidate in decision.candidates}
    assert kinds >= {"ExamineObj", "FindObj", "Place"}


def test_one_plan_has_inferences_and_actions_and_one_cost_that_adds_them_up() -> None:
    """ "The same planning, inference, and execution mechanisms as are used for determining physical robot actions"."""
    play = example()
    turn = play.agent.decide(0)
    top = turn.plans[0].layers[0]
    assert [step.op for step in top] == ["ExamineObj(e1, o2)", "Place(o2, desk)"]
    assert all(step.cost > 0 for step in top)
    assert sum(step.cost for step in top) == turn.decisions[0].cost


def test_one_stack_refines_an_inference_down_to_a_movement() -> None:
    """ "Planning to disambiguate the goal specification is handled by the same mechanism"."""
    play, _ = rehearsed()
    stacks = [[{step.op.partition("(")[0] for step in layer} for layer in plan.layers] for plan in plans(play)]
    assert any("ExamineObj" in stack[0] and "Pick" in set().union(*stack[1:]) for stack in stacks if len(stack) > 1)
    assert any(
        "FindObj" in stack[0] and "LookAtRegion" in set().union(*stack[1:]) for stack in stacks if len(stack) > 1
    )


def test_both_kinds_come_from_one_question_to_the_rules() -> None:
    """ "General-purpose planning and reasoning tools are used": a step is an action only in that it executes one."""
    play = example()
    at = posed(EXAMPLE_GOAL, play.belief)
    goals = ("b(den(e1,o2),105361)", "b(on(o2,desk),105361)")
    (examine,), (place,) = (at.offers.offers(parse_term(goal)) for goal in goals)
    assert type(examine) is type(place)
    assert examine.executes is None
    assert place.executes is not None
