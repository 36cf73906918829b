"""C17: plans do not branch."""

import itertools

from kit.papers import plans, rehearsed


def test_a_plan_is_a_list_of_steps_each_leading_to_the_next() -> None:
    """ "Rather than making a conditional plan, which requires branching both on actions and observations." """
    for name in ("example", "searching"):
        for plan in plans(rehearsed(name)[0]):
            for layer in plan.layers:
                chained = list(itertools.pairwise(layer))
                if plan.cause == "bind_skolem":
                    continue  # the steps before the binding keep the placeholder
                assert all("sk(" in str(a.subgoal) or a.subgoal == b.preimage for a, b in chained)


def test_a_decision_has_one_plan_and_counts_what_it_took() -> None:
    """ "We plan in a determinized model": one search, one plan, and nothing for other outcomes."""
    play, _ = rehearsed()
    decisions = [(turn, decision) for turn in play.turns for decision in turn.decisions]
    assert decisions
    for turn, decision in decisions:
        assert all(isinstance(operator, str) for operator in decision.plan)
        assert decision.expansions <= 200
        assert len(turn.decisions) <= 20
    searched = [decision for _, decision in decisions if decision.expansions]
    assert sum(decision.clingo_calls for _, decision in decisions) >= len({d.step for d in searched})
    assert sum(decision.clingo_calls for _, decision in decisions) < 40 * len(play.turns)


def test_the_same_steps_are_taken_whatever_would_be_observed_as_long_as_it_is_not_observed() -> None:
    """ "Open-loop plan": the plan before the weighing does not know of the weighing's outcome."""
    light, heavy = (rehearsed(name)[0] for name in ("example", "example heavy"))
    weighed = rehearsed()[1].index("Weigh(o2)")
    assert [t.decisions for t in light.turns[: weighed + 1]] == [t.decisions for t in heavy.turns[: weighed + 1]]
    assert light.turns[weighed + 1].plans != heavy.turns[weighed + 1].plans
