"""C23: the plans of all levels, their subgoals and the executed actions can be drawn as the paper draws them."""

from kit.papers import plans, rehearsed

from skolem.tools.words.plan_tree import plan_lines
from skolem.traces.wording.wording import AS_RECORDED


def test_each_row_is_a_plan_at_one_level() -> None:
    """ "Each horizontal row of boxes represents a plan at some hierarchical level of the process." """
    for plan in plans(rehearsed()[0]):
        lines = plan_lines(plan, AS_RECORDED)
        assert len(lines) == len(plan.layers)
        for depth, (line, layer, chosen) in enumerate(zip(lines, plan.layers, plan.current, strict=True)):
            marked = [f"<{step.op}>" if i == chosen else step.op for i, step in enumerate(layer)]
            assert line == "  " * depth + "  ".join(marked)


def test_the_first_rows_of_the_figure_are_there() -> None:
    """ "The highest-level plan has two abstract steps"; the row below plans for the first subgoal."""
    play, _ = rehearsed()
    first, second = plans(play)[:2]
    assert plan_lines(first, AS_RECORDED) == ["<ExamineObj(e1, o2)>  Place(o2, desk)"]
    top, below = plan_lines(second, AS_RECORDED)
    assert top == plan_lines(first, AS_RECORDED)[0]
    assert below.endswith("ExamineObj(e1, o2)")
    subgoal = set(second.layers[1][-1].subgoal)
    assert subgoal == set(second.layers[0][0].subgoal)
    assert {"b(den(e1,o2),105361)"} < subgoal


def test_executed_actions_are_the_ends_of_the_tree_and_inferences_lie_above_them() -> None:
    """ "Clear boxes represent the execution of an action; arrows between blue boxes represent inference steps." """
    play, operators = rehearsed()
    executed = [turn.action.op for turn in play.turns if turn.action is not None]
    assert tuple(executed) == operators
    deepest = {plan.layers[-1][plan.current[-1]].op for plan in plans(play) if plan.layers}
    assert set(executed) <= deepest
