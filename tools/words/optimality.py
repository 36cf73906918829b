"""How near the plan of a search is to the best plan, in words."""

import math
from collections.abc import Sequence


def optimality(within: float | None) -> str:
    """Return what is known of a plan beside the best one.

    Args:
        within: At most this many times the cost (-ln p) of the best plan; 1: it is the best; None: nothing is known.
    """
    if within is None:
        return "no bound is known"
    return "optimal" if within == 1.0 else f"within {_upwards(within):.2f} of the best"


def optimality_of_all(within: Sequence[float | None]) -> str:
    """Return what is known of the plans of a run: how many are the best, how near the others are, how many unknown."""
    best, bounds = within.count(1.0), [factor for factor in within if factor is not None and factor > 1.0]
    parts = [f"{best} optimal"] if best else []
    parts += [f"{len(bounds)} {optimality(max(bounds))}"] if bounds else []
    parts += [f"{unknown} of which no bound is known"] if (unknown := within.count(None)) else []
    return ", ".join(parts) or "none found"


def _upwards(factor: float) -> float:
    """Return a factor rounded to hundredths, never to a better one."""
    return math.ceil(round(100.0 * factor, 4)) / 100.0
