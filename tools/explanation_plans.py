"""Plans sought again as the robot sought them: for one reading of the goal, or by way of one region."""

from collections.abc import Callable

from skolem.reasoner.instances import Instance
from skolem.reasoner.regression import Found, Subgoal, regress
from skolem.reasoner.terms import prob
from skolem.tools.explanation import Insight
from skolem.tools.recalled_geometry import NotRecordedError

IMPLAUSIBLE = 0.001  # as the queries @plausible and @searchable have it


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
        refused: What the plan must do without.
    """
    try:
        return regress([root], insight.posed.offers, lambda _: 0, refused, insight.given.limits.expansions, worst)
    except NotRecordedError:
        return None


def beaten(cost: int, best: int | None) -> str:
    """Return why a plan was not chosen although there is one.

    Args:
        cost: Of the plan, micro-nats.
        best: Of the best plan there is, for any reading; None if there is none.
    """
    if best is not None and cost > best:
        return f"its best plan has p = {prob(cost):.3g}, the chosen one p = {prob(best):.3g}"
    return "its plan is as good; what is risky comes later in the chosen one, or it comes first in the belief"
