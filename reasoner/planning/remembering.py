"""The steps of the plan stack as messages, so that a decision can be repeated from a recorded memory."""

from typing import Final

from skolem.reasoner.planning.hierarchy import plan_step
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.regression import Step
from skolem.reasoner.terms import Term, parse_term
from skolem.traces.messages import RememberedStep

_PRICE: Final = "recalled"  # the single reason that stands for the costs of a recalled step
_DEMANDED: Final = "recalled"  # the single precondition that stands for those of a recalled step


def remembered(step: Step) -> RememberedStep:
    """Return the message of a step of the stack."""
    instance = step.instance
    return RememberedStep(
        **dict(plan_step(step)),
        instance=str(instance.step),
        called=str(instance.operation),
        executes=None if instance.executes is None else str(instance.executes),
    )


def recalled(step: RememberedStep) -> Step:
    """Return the step of a message; it has the price and the concrete level, but not the single costs and fluents."""
    instance = Instance(
        step=parse_term(step.instance),
        operation=parse_term(step.called),
        costs=frozenset({(_PRICE, step.cost)}),
        preconditions=frozenset({(_DEMANDED, step.concrete)}),
        executes=None if step.executes is None else parse_term(step.executes),
    )
    return Step(instance, step.level, _conjunction(step.subgoal), _conjunction(step.preimage))


def _conjunction(fluents: tuple[str, ...]) -> frozenset[Term]:
    return frozenset(map(parse_term, fluents))
