"""Bands: what must be known of a quantity so that a word follows from it.

A band is the condition of a Gaussian fluent (see `gaussians`): any belief inside makes the word true of the object with
a given probability. How many observations it takes follows from the sensor at the values that the word means.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.planning.gaussians import MOST_OBSERVATIONS, UNIT, axes_of, holds
from skolem.reasoner.protocols import Gaussian
from skolem.reasoner.terms import ANY, Term, compound
from skolem.traces.messages import ColourMeaning, HsvVolume, Quantity, WeightInterval

Sensor = Callable[[NDArray[np.float64]], NDArray[np.float64]]  # covariance of one observation of a value
Band = tuple[Term, Term, Term]  # mu, Sigma, Delta

_STANDARD: Final = NormalDist()
_SUREST: Final = 1.0 - 0.5e-6  # a greater probability is 0 micro-nats, and no finite bound gives it
_LEAST_VARIANCE: Final = 1e-12  # of a quantity that is as good as certain
_TURNS: Final = 3  # of the hue to either side that a wide belief reaches
_LEAST_REACH: Final = 1.5 / UNIT  # of a band to either side: one thousandth is left after rounding
_HALVINGS: Final = 40  # of the interval in which a margin is sought
_FAR_SDS: Final = 8.0


@dataclass(frozen=True, slots=True)
class _Span:
    """An interval of one axis; no mass lies beyond an open edge."""

    low: float
    high: float
    open_low: bool = False
    open_high: bool = False

    @property
    def everything(self) -> bool:
        return self.open_low and self.open_high

    def widest(self, sd: float) -> float:
        """Return the largest margin from the closed edges, in sds, that leaves the least reach."""
        edges = 2 - self.open_low - self.open_high
        return (self.high - self.low - 2.0 * _LEAST_REACH) / (sd * edges) if edges else math.inf

    def mass(self, margin: float, sd: float) -> float:
        """Return the least mass inside of a Gaussian whose mean is `margin` sds or more from each closed edge.

        The Gaussian is cut off at an open edge. The least is that of the mean nearest to the closed edge.
        """
        if self.everything:
            return 1.0
        left = _STANDARD.cdf((self.high - self.low) / sd - margin)  # of the mass on the other edge's side
        if self.open_low or self.open_high:
            return 1.0 - _STANDARD.cdf(-margin) / left
        return _STANDARD.cdf(margin) - (1.0 - left)

    def inner(self, margin: float, sd: float) -> tuple[float, float]:
        """Return the means that are `margin` sds or more from each closed edge."""
        off = margin * sd
        return self.low if self.open_low else self.low + off, self.high if self.open_high else self.high - off


def band(meaning: ColourMeaning | WeightInterval, belief: Gaussian, sensor: Sensor, p: float) -> Band | None:
    """Return (mu, Sigma, Delta) such that any belief inside has P(meaning) >= p; None if too many looks were needed.

    A fluent bounds one box: of a colour of several it is the one that the belief is likeliest to be in, of those for
    which the sensor is not too weak.

    Args:
        meaning: Of the word.
        belief: On the quantity, present.
        sensor: Covariance of one observation of a value of the quantity.
        p: Probability that the word needs.
    """
    if isinstance(meaning, WeightInterval):
        return _band("weight", [_weights(meaning, belief)], belief, sensor, p)
    likely = sorted(meaning.boxes, key=lambda box: -_mass(_colours(box), belief))
    found = (_band("colour", _colours(box), belief, sensor, p) for box in likely)
    return next(filter(None, found), None)


def expected(belief: Gaussian, mu: Term, delta: Term) -> NDArray[np.float64]:
    """Return the mean of the belief if the value lies within mu +- delta; mu itself on an axis without delta."""
    centre, reach = dict(axes_of(mu)), dict(axes_of(delta))
    value = np.array(belief.mean, dtype=np.float64)
    for axis, middle in centre.items():
        half = reach.get(axis, 0.0)
        value[axis] = _expected(belief, axis, middle - half, middle + half)
    return value


def _band(quantity: Quantity, spans: Sequence[_Span], belief: Gaussian, sensor: Sensor, p: float) -> Band | None:
    """Return the band of one box or interval that the fewest observations reach.

    Sigma follows from the present variance and from the sensor at the value that is expected in the box. A band that
    holds already asks for nothing that could be found out: then a narrower one is taken.
    """
    prior = np.diagonal(belief.covariance).tolist()
    value = np.array([_expected(belief, axis, span.low, span.high) for axis, span in enumerate(spans)])
    noise = np.diagonal(sensor(value)).tolist()
    for count in range(1, MOST_OBSERVATIONS + 1):
        sds = [
            math.ceil(UNIT * math.sqrt(1 / (1 / max(v, _LEAST_VARIANCE) + count / max(r, _LEAST_VARIANCE))))
            for v, r in zip(prior, noise, strict=True)
        ]
        found = _reached(spans, sds, p)
        if found is not None and not holds(quantity, belief, *found, ANY):
            return found
    return None


def _reached(spans: Sequence[_Span], sds: Sequence[int], p: float) -> Band | None:
    """Return the band for standard deviations, in thousandths; None if the word does not follow even in its middle.

    All closed edges are kept off by one margin in standard deviations, except on axes too narrow for it: what those
    lack the others give. An axis with no closed edge is not bounded.
    """
    sized = [(span, sd / UNIT) for span, sd in zip(spans, sds, strict=True)]
    widest = [span.widest(sd) for span, sd in sized]
    if min(widest) <= 0.0:
        return None

    def inside(margin: float) -> float:
        return math.prod(span.mass(min(margin, most), sd) for (span, sd), most in zip(sized, widest, strict=True))

    low, high = 0.0, _FAR_SDS
    if inside(high) < min(p, _SUREST):
        return None
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if inside(middle) >= min(p, _SUREST) else (middle, high)
    mu: list[Term] = []
    delta: list[Term] = []
    for (span, sd), most in zip(sized, widest, strict=True):
        first, last = span.inner(min(high, most), sd)
        centre = round(UNIT * (first + last) / 2.0)
        mu.append(ANY if span.everything else centre)
        delta.append(ANY if span.everything else math.floor(min(UNIT * last - centre, centre - UNIT * first)))
    bounds = [ANY if span.everything else sd for span, sd in zip(spans, sds, strict=True)]
    return compound("v", *mu), compound("sd", *bounds), compound("tol", *delta)


def _expected(belief: Gaussian, axis: int, low: float, high: float) -> float:
    """Return the mean of one axis of the belief given that it lies in an interval, by the nearest turn of a hue."""
    mean, sd = float(belief.mean[axis]), math.sqrt(max(float(belief.covariance[axis, axis]), _LEAST_VARIANCE))
    a, b = (low - mean) / sd, (high - mean) / sd
    mass = _STANDARD.cdf(b) - _STANDARD.cdf(a)
    if mass < 1e-9:  # far out: the nearer end
        return min(max(mean, low), high)
    return min(max(mean + sd * (_STANDARD.pdf(a) - _STANDARD.pdf(b)) / mass, low), high)


def _mass(spans: Sequence[_Span], belief: Gaussian) -> float:
    """Return P(the colour lies in the box), but for a factor that is the same for all boxes."""
    mass = 1.0
    for axis, span in enumerate(spans):
        mean, variance = float(belief.mean[axis]), float(belief.covariance[axis, axis])
        normal = NormalDist(mean, math.sqrt(max(variance, _LEAST_VARIANCE)))
        turns = range(-_TURNS, _TURNS + 1) if axis == 0 else (0,)
        mass *= sum(normal.cdf(span.high + turn) - normal.cdf(span.low + turn) for turn in turns)
    return mass


def _colours(box: HsvVolume) -> list[_Span]:
    """Return the spans of hue, saturation and value."""
    low, high = box.hue
    any_hue = high - low >= 1.0
    hue = _Span(low, high if high >= low else high + 1.0, any_hue, any_hue)
    return [hue, *(_Span(low, high, low <= 0, high >= 1) for low, high in (box.saturation, box.value))]


def _weights(meaning: WeightInterval, belief: Gaussian) -> _Span:
    """Return the span of ln kg; an open end lies beyond all that is believed."""
    mean, sd = float(belief.mean[0]), math.sqrt(float(belief.covariance[0, 0]))
    far = max(mean, math.log(max(meaning.at_least_kg, 1e-3))) + 6 * sd
    near = min(mean, far) - 12 * sd
    low = math.log(meaning.at_least_kg) if meaning.at_least_kg > 0 else near
    high = math.log(meaning.below_kg) if meaning.below_kg is not None else far
    return _Span(low, high, meaning.at_least_kg <= 0, meaning.below_kg is None)
