"""Searches for plans as the robot made them: for one reading of the goal, or through one region."""

from collections.abc import Callable
from dataclasses import dataclass

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.regression import Found, Subgoal, regress
from skolem.reasoner.terms import prob
from skolem.tools.explain.insight import Insight
from skolem.tools.explain.refusals import Refused
from skolem.traces.errors import NotRecordedError


def never(_instance: Instance, _level: int) -> bool:
    """Refuse nothing."""
    return False


def planned(
    insight: Insight, root: Subgoal, worst: int, refused: Callable[[Instance, int], bool] = never
) -> Found | None:
    """Return the cheapest plan for one reading of the goal; None if the trace cannot tell.

    Args:
        insight: The mind that plans.
        root: The reading.
        worst: The most that the plan may cost, micro-nats.
        refused: The steps that the plan must not have.
    """
    try:
        return regress([root], insight.posed.offers, lambda _: 0, refused, insight.given.limits.expansions, worst)
    except NotRecordedError:
        return None


@dataclass(frozen=True, slots=True)
class Rival:
    """The chosen plan, with which other plans are compared.

    Attributes:
        chosen: Whether a plan was chosen.
        cost: Its cost, micro-nats; None if there is none, or the trace cannot tell.
        refused: The steps that the robot refused.
        sought: Whether a plan was sought at this decision.
    """

    chosen: bool
    cost: int | None
    refused: Refused
    sought: bool


def beaten(insight: Insight, plan: Found, rival: Rival) -> str:
    """Return why a plan was not chosen although there is one."""
    p = f"{prob(plan.cost):.3g}"
    if rival.cost is not None and plan.cost > rival.cost:
        return f"its best plan has p = {p}, the chosen one p = {prob(rival.cost):.3g}"
    if said := rival.refused.objection(insight, plan):
        return f"{said}; else its plan would have p = {p}"
    if rival.cost is None and rival.chosen:
        return f"its best plan has p = {p}; what that of the chosen one had cannot be told"
    if rival.cost is None:
        said = "the run ended before it was taken up" if rival.sought else "no plan was sought any more"
        return f"its best plan has p = {p}, but {said}"
    if plan.cost < rival.cost:
        return f"its best plan has p = {p}, the chosen one only p = {prob(rival.cost):.3g}; the search did not find it"
    rule = (
        "of equally likely plans the one is taken whose risks come later, then the one about the object known earlier"
    )
    return f"its plan is as good; {rule}"
