"""The distance of a search's plan from the best plan, in words."""

import math
from collections.abc import Sequence


def optimality(within: float | None) -> str:
    """Return the known bound on a plan's cost, relative to the best plan, in words.

    Args:
        within: Bound on the cost (-ln p) as a multiple of the best plan's cost; 1: it is the best; None: no bound.
    """
    if within is None:
        return "no bound is known"
    return "optimal" if within == 1.0 else f"within {_upwards(within):.2f} of the best"


def optimality_of_all(within: Sequence[float | None]) -> str:
    """Return for the plans of a run the number of best plans, the bounds of others, and the number without bound."""
    best, bounds = within.count(1.0), [factor for factor in within if factor is not None and factor > 1.0]
    parts = [f"{best} optimal"] if best else []
    parts += [f"{len(bounds)} {optimality(max(bounds))}"] if bounds else []
    parts += [f"{unknown} of which no bound is known"] if (unknown := within.count(None)) else []
    return ", ".join(parts) or "none found"


def _upwards(factor: float) -> float:
    """Return a factor rounded up to hundredths."""
    return math.ceil(round(100.0 * factor, 4)) / 100.0
