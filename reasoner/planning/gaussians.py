"""Gaussian fluents B(phi, mu, Sigma, Delta, p): their test, and their regression through an observation.

Bounds are terms in thousandths of the quantity's unit (metres, radians, ln kg, or 0..1 for a colour axis):
`v(..)` a mean, `sd(..)` the standard deviations of a diagonal Sigma, `tol(..)` the half widths Delta; `any` in a slot
puts no bound on that axis.
"""

import bisect
import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.protocols import Gaussian
from skolem.reasoner.terms import ANY, Compound, Term, nll
from skolem.traces.messages import Quantity

UNIT: Final = 1000.0
MOST_OBSERVATIONS: Final = 64  # of each axis; at a price of .1 nats each more would not be worth planning
_LEAST_VARIANCE: Final = 1e-12  # added to what is inverted
_STEPS: Final = 8  # of a plan that may lead together to one thousandth less
_TURN: Final = {
    "pose": (None, None, 2 * math.pi),
    "colour": (1.0, None, None),
    "weight": (None,),
}  # period of each axis


def holds(quantity: Quantity, belief: Gaussian, mu: Term, sigma: Term, delta: Term, p: Term) -> bool:
    """Return |mu - M| <= Delta and S <= Sigma (Loewner order) and P_b >= p (section "Belief representation")."""
    if isinstance(p, int) and nll(belief.probability) > p:
        return False
    return _covered(belief.covariance, sigma) and _near(quantity, belief.mean, mu, delta)


def _covered(covariance: NDArray[np.float64], sigma: Term) -> bool:
    """Return whether the equi-probability contour of the covariance lies inside Sigma's, on the bounded axes."""
    axes = axes_of(sigma)
    if not axes:
        return True
    index = [i for i, _ in axes]
    slack = np.diag([bound**2 for _, bound in axes]) - covariance[np.ix_(index, index)]
    return float(np.linalg.eigvalsh(slack)[0]) >= -1e-9 * float(np.trace(slack + 2 * covariance[np.ix_(index, index)]))


def _near(quantity: Quantity, mean: NDArray[np.float64], mu: Term, delta: Term) -> bool:
    turns = _TURN[quantity]
    centre, reach = dict(axes_of(mu)), dict(axes_of(delta))
    for axis in sorted(centre.keys() & reach.keys()):
        distance = centre[axis] - float(mean[axis])
        turn = turns[axis]
        if turn is not None:
            distance = (distance + turn / 2) % turn - turn / 2
        if abs(distance) > reach[axis]:
            return False
    return True


def axes_of(bound: Term) -> list[tuple[int, float]]:
    """Return the bounded axes with their bounds in units."""
    if not isinstance(bound, Compound):
        return []
    return [(i, value / UNIT) for i, value in enumerate(bound.args) if isinstance(value, int)]


def observations(sigma: Term, observation: NDArray[np.float64], present: NDArray[np.float64]) -> int | None:
    """Return how many observations bring a belief within `sigma`, at least one; None if they are too many to plan.

    Args:
        sigma: Bound on the covariance.
        observation: Covariance of one, shape (n, n).
        present: Covariance of the belief, shape (n, n).
    """
    least = _LEAST_VARIANCE * np.eye(len(present))

    def suffice(count: int) -> bool:
        gain = present @ np.linalg.inv(present + observation / count + least)
        return _covered(present - gain @ present, sigma)

    counts = range(1, MOST_OBSERVATIONS * max(1, len(axes_of(sigma))) + 1)
    found = bisect.bisect_left(counts, True, key=suffice)
    return counts[found] if found < len(counts) else None


def before_observation(sigma: Term, observation: NDArray[np.float64]) -> Term:
    """Return the Sigma needed before one observation for `sigma` to hold after it; `any` if none is needed.

    The observation's covariance is bounded by a diagonal one (Gershgorin). Each axis is regressed by
    v_before = v_after v_sensor / (v_sensor - v_after). The bound is rounded down to a thousandth. If that is no
    progress, it is raised by a thousandth, provided a few steps reach it: else no number would seem to help.
    """
    if not isinstance(sigma, Compound):
        return ANY
    axes, rows = axes_of(sigma), observation.tolist()
    needed: dict[int, Term] = {}
    for axis, sd in axes:
        sensor = sum(abs(rows[axis][other]) for other, _ in axes)
        after = sd**2
        if sensor <= after:
            needed[axis] = ANY
        else:
            before, more = math.floor(UNIT * math.sqrt(after * sensor / (sensor - after))), round(UNIT * sd) + 1
            few = after > 0 and 1 / (more / UNIT) ** 2 + _STEPS / sensor >= 1 / after
            needed[axis] = max(before, more) if few else before
    bounds = tuple(needed.get(axis, ANY) for axis in range(len(sigma.args)))
    return ANY if all(bound == ANY for bound in bounds) else Compound(sigma.name, bounds)


def before_reading(p: float, right: float) -> float:
    """Return the belief needed before a discrete reading to believe p after it; the reading is right with P = `right`.

    The result is at most .2 below p: one reading is not trusted to turn the belief around, several are. However
    unlikely the value is now, some number of readings gets there; the price of the prior makes trying expensive.
    """
    wrong = 1 - right
    needed = p * wrong / (p * wrong + (1 - p) * right) if p < 1 else 1.0
    return max(needed, p - 0.2)
