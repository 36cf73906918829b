"""C23, the part that the product lacks: the plan tree of a whole run, one row per plan, subgoals and actions told apart.

Supposed here: `skolem.tools.plan_tree.tree_lines(plans, actions)` gives one line per plan that was made (a `start` or
`refine` of the trace), indented by its layer, `[subgoal]` for a blue box, `-op->` for an inference, `(op)` for a step that
was executed; and `skolem show RUN --plans` prints it from a trace.
"""

import importlib

from papers import plans, rehearsed


def test_the_plan_tree_of_the_example_has_one_row_per_plan() -> None:
    """ "Blue boxes contain belief formulas describing goals and subgoals." """
    tree = importlib.import_module("skolem.tools.plan_tree")
    play, operators = rehearsed()
    actions = [turn.action for turn in play.turns if turn.action is not None]
    lines = tree.tree_lines(plans(play), actions)
    assert len([line for line in lines if "[" in line]) == len(plans(play, "start", "refine"))
    assert [op for line in lines for op in operators if f"({op})" in line]
