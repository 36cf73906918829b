"""Gaussian fluents B(phi, mu, Sigma, Delta, p): their test, and their regression through an observation.

Bounds are terms in thousandths of the quantity's unit (metres, radians, ln kg, or 0..1 for a colour axis):
`v(..)` a mean, `sd(..)` the standard deviations of a diagonal Sigma, `tol(..)` the half widths Delta; `any` in a slot
puts no bound on that axis.
"""

import math
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.protocols import Gaussian
from skolem.reasoner.terms import ANY, Compound, Term, compound, nll
from skolem.traces.messages import ColourMeaning, HsvVolume, Quantity, WeightInterval

_UNIT: Final = 1000.0
_SUREST: Final = 1.0 - 0.5e-6  # a greater probability is 0 micro-nats, and no finite bound gives it
_LEAST_VARIANCE: Final = 1e-12  # of a colour that is as good as certain
_TURNS: Final = 3  # of the hue to either side that a wide belief reaches
_MOST_OBSERVATIONS: Final = 8  # if more are needed, the sensor counts as too weak
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
    axes = _axes(sigma)
    if not axes:
        return True
    index = [i for i, _ in axes]
    slack = np.diag([bound**2 for _, bound in axes]) - covariance[np.ix_(index, index)]
    return float(np.linalg.eigvalsh(slack)[0]) >= -1e-9 * float(np.trace(slack + 2 * covariance[np.ix_(index, index)]))


def _near(quantity: Quantity, mean: NDArray[np.float64], mu: Term, delta: Term) -> bool:
    turns = _TURN[quantity]
    centre, reach = dict(_axes(mu)), dict(_axes(delta))
    for axis in sorted(centre.keys() & reach.keys()):
        distance = centre[axis] - float(mean[axis])
        turn = turns[axis]
        if turn is not None:
            distance = (distance + turn / 2) % turn - turn / 2
        if abs(distance) > reach[axis]:
            return False
    return True


def _axes(bound: Term) -> list[tuple[int, float]]:
    """Return the bounded axes with their bounds in units."""
    if not isinstance(bound, Compound):
        return []
    return [(i, value / _UNIT) for i, value in enumerate(bound.args) if isinstance(value, int)]


def before_observation(sigma: Term, observation: NDArray[np.float64]) -> Term:
    """Return the Sigma needed before ONE observation for `sigma` to hold after it; `any` if none is needed.

    The observation's covariance is bounded by a diagonal one (Gershgorin), then each axis is regressed by
    v_before = v_after v_sensor / (v_sensor - v_after), rounded down to a thousandth. If rounding leaves no progress,
    the bound is raised by a thousandth, provided a few observations reach it: else no number would seem to help.
    """
    if not isinstance(sigma, Compound):
        return ANY
    axes, rows = _axes(sigma), observation.tolist()
    needed: dict[int, Term] = {}
    for axis, sd in axes:
        sensor = sum(abs(rows[axis][other]) for other, _ in axes)
        after = sd**2
        if sensor <= after:
            needed[axis] = ANY
        else:
            before, more = math.floor(_UNIT * math.sqrt(after * sensor / (sensor - after))), round(_UNIT * sd) + 1
            few = after > 0 and 1 / (more / _UNIT) ** 2 + _MOST_OBSERVATIONS / sensor >= 1 / after
            needed[axis] = max(before, more) if few else before
    bounds = tuple(needed.get(axis, ANY) for axis in range(len(sigma.args)))
    return ANY if all(bound == ANY for bound in bounds) else Compound(sigma.name, bounds)


def band(
    meaning: ColourMeaning | WeightInterval, belief: Gaussian, observation: NDArray[np.float64], p: float
) -> tuple[Term, Term, Term] | None:
    """Return (mu, Sigma, Delta) such that any belief inside has P(meaning) >= p; None if the sensor is too weak.

    A fluent bounds one box: of a colour of several it is the one that the belief is likeliest to be in, of those for
    which the sensor is not too weak.
    """
    if isinstance(meaning, WeightInterval):
        return _band(meaning, belief, observation, p)
    likely = sorted(meaning.boxes, key=lambda box: -_mass(box, belief)) if len(meaning.boxes) > 1 else meaning.boxes
    return next((found for box in likely if (found := _band(box, belief, observation, p))), None)


def _mass(box: HsvVolume, belief: Gaussian) -> float:
    """Return P(the colour lies in the box), but for a factor that is the same for all boxes."""
    spans = _intervals(box, belief)
    mass = 1.0
    for axis, (low, high, _, _) in enumerate(spans):
        mean, variance = float(belief.mean[axis]), float(belief.covariance[axis, axis])
        normal = NormalDist(mean, math.sqrt(max(variance, _LEAST_VARIANCE)))
        turns = range(-_TURNS, _TURNS + 1) if axis == 0 else (0,)
        mass *= sum(normal.cdf(high + turn) - normal.cdf(low + turn) for turn in turns)
    return mass


def _band(
    meaning: HsvVolume | WeightInterval, belief: Gaussian, observation: NDArray[np.float64], p: float
) -> tuple[Term, Term, Term] | None:
    """Return (mu, Sigma, Delta) of one box or interval.

    Sigma follows from the present variance and the fewest observations that suffice; Delta keeps the mean far enough
    from each edge of the set for an even share p^(1/n) of the mass on each of the n axes.
    """
    prior = np.diagonal(belief.covariance).tolist()
    sensor = np.diagonal(observation).tolist()
    intervals = _intervals(meaning, belief)
    margin = NormalDist().inv_cdf((1 + min(p, _SUREST) ** (1 / len(intervals))) / 2)
    for count in range(1, _MOST_OBSERVATIONS + 1):
        sds = [
            math.ceil(_UNIT * math.sqrt(1 / (1 / v + count / max(r, 1e-12))))
            for v, r in zip(prior, sensor, strict=True)
        ]
        inner = [
            (low if open_low else low + margin * sd / _UNIT, high if open_high else high - margin * sd / _UNIT)
            for (low, high, open_low, open_high), sd in zip(intervals, sds, strict=True)
        ]
        delta = [math.floor(_UNIT * (high - low) / 2) for low, high in inner]
        if min(delta) > 0:
            mu = [round(_UNIT * (low + high) / 2) for low, high in inner]
            return compound("v", *mu), compound("sd", *sds), compound("tol", *delta)
    return None


def _intervals(meaning: HsvVolume | WeightInterval, belief: Gaussian) -> list[tuple[float, float, bool, bool]]:
    """Return per axis (low, high, low edge open, high edge open); no mass lies beyond an open edge."""
    if isinstance(meaning, WeightInterval):
        far = max(float(belief.mean[0]), math.log(max(meaning.at_least_kg, 1e-3))) + 6 * math.sqrt(
            belief.covariance[0, 0]
        )
        near = min(float(belief.mean[0]), far) - 12 * math.sqrt(belief.covariance[0, 0])
        low = math.log(meaning.at_least_kg) if meaning.at_least_kg > 0 else near
        high = math.log(meaning.below_kg) if meaning.below_kg is not None else far
        return [(low, high, meaning.at_least_kg <= 0, meaning.below_kg is None)]
    hue_low, hue_high = meaning.hue
    any_hue = hue_high - hue_low >= 1.0
    hue = (hue_low, hue_high if hue_high >= hue_low else hue_high + 1.0, any_hue, any_hue)
    return [hue, *((low, high, low <= 0, high >= 1) for low, high in (meaning.saturation, meaning.value))]


def before_reading(p: float, right: float) -> float:
    """Return the belief needed before a discrete reading to believe p after it; the reading is right with P = `right`.

    The result is at most .2 below p: one reading is not trusted to turn the belief around, several are. However
    unlikely the value is now, some number of readings gets there; the price of the prior makes trying expensive.
    """
    wrong = 1 - right
    needed = p * wrong / (p * wrong + (1 - p) * right) if p < 1 else 1.0
    return max(needed, p - 0.2)
