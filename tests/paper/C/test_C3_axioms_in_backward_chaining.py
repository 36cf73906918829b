"""C3: inference rules are chained backwards like operators."""

from kit.papers import EXAMPLE_GOAL, NINE, example, planned, plans, posed, rehearsed, steps_of


def test_examining_stands_between_physical_steps_and_nothing_executes_it() -> None:
    """ "Inference rules that can be used during backward chaining and play the role of axioms." """
    at = posed(EXAMPLE_GOAL, example().belief)
    steps = steps_of(planned(at, f"b(den(e1,o2),{NINE})", f"b(on(o2,desk),{NINE})", level=1))
    executed = {str(step.instance.step).partition("(")[0]: step.instance.executes for step in steps}
    order = list(executed)
    assert order.index("weigh") < order.index("infer") < order.index("examine") < order.index("place")
    assert executed["examine"] is executed["infer"] is executed["split"] is None
    assert None not in (executed["weigh"], executed["place"], executed["pick"])


def test_the_costs_of_inference_and_action_add_up_in_one_plan() -> None:
    """ "We assign a cost to each action or inference step." """
    found = planned(posed(EXAMPLE_GOAL, example().belief), f"b(den(e1,o2),{NINE})", f"b(on(o2,desk),{NINE})", level=1)
    steps = steps_of(found)
    inference = sum(step.instance.price for step in steps if step.instance.executes is None)
    action = sum(step.instance.price for step in steps if step.instance.executes is not None)
    assert found.cost == inference + action
    assert min(inference, action) > 0


def test_in_a_run_axioms_are_planned_with_and_never_carried_out() -> None:
    """ "Play the role of axioms." """
    play, operators = rehearsed()
    used = {step.op.partition("(")[0] for plan in plans(play) for layer in plan.layers for step in layer}
    assert {"ExamineObj", "FindObj", "Infer", "RemoveObst"} <= used
    assert not {"ExamineObj", "FindObj", "Infer", "RemoveObst"} & {op.partition("(")[0] for op in operators}
