"""C23: the plan tree of a whole run has one row per plan, and tells subgoals, inferences and executed actions apart."""

from kit.papers import plans, rehearsed

from skolem.tools.words.plan_tree import tree_lines
from skolem.traces.wording.wording import AS_RECORDED


def tree() -> list[str]:
    """Return the tree of the paper's example."""
    play, _ = rehearsed()
    return tree_lines(plans(play), [turn.action for turn in play.turns if turn.action is not None], AS_RECORDED)


def test_the_plan_tree_of_the_example_has_one_row_per_plan() -> None:
    """ "Blue boxes contain belief formulas describing goals and subgoals." """
    rows = [line for line in tree() if line.lstrip().startswith("[")]
    assert len(rows) == len(plans(rehearsed()[0], "start", "refine"))
    assert "b(den(e1,o2),105361)" in rows[0]
    assert "-ExamineObj(e1, o2)->" in rows[0]
    assert "Place(o2, desk)" in rows[0]


def test_every_executed_action_is_in_it_in_order() -> None:
    """ "Clear boxes represent the execution of an action." """
    executed = [line.strip()[1:-1] for line in tree() if line.lstrip().startswith("(")]
    assert tuple(executed) == rehearsed()[1]


def test_it_says_where_plans_were_dropped_and_why() -> None:
    """ "The pre-images of both plans on the stack are no longer true." """
    lines = [line.strip() for line in tree()]
    weighed = lines.index("(Weigh(o2))")
    assert "den(e1,o2)" in lines[weighed + 1]
    assert lines[weighed + 2].startswith("[")
    assert "FindObj(e1, _reg2_, sk(var(o)))" in lines[weighed + 2]
