"""What is believed of an object's colour, and how a camera observes it."""

import colorsys
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from skolem.estimation.attributes import ROUNDING
from skolem.traces.messages import HsvBelief, HsvVolume

Array = NDArray[np.float64]
UNIFORM_SD = 12**-0.5  # of a hue of which nothing is known
HUE_NODES, LEVEL_NODES = 96, 24  # of the quadrature over readings
LEAST_VARIANCE = 1e-12  # of a belief that is as good as certain


@dataclass(frozen=True, slots=True)
class ColourSensor:
    """How a mean colour is observed: the true RGB times `gain`, plus noise of `sd_rgb` per channel."""

    gain: float
    sd_rgb: float

    def hsv(self, rgb: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the HSV of the surface that was seen as `rgb`."""
        red, green, blue = (min(1.0, max(0.0, channel / self.gain)) for channel in rgb)
        return colorsys.rgb_to_hsv(red, green, blue)

    def variance(self, saturation: float, value: float) -> tuple[float, float, float]:
        """Return the variance of an observed (hue, saturation, value), to first order in the RGB noise.

        The hue of a colour with largest channel v and range s v errs by sqrt(2) sd / (6 s v); a grey's is unknown.
        """
        sd = max(self.sd_rgb / self.gain, 1e-4)
        v = max(value, sd)
        hue = math.sqrt(2.0) * sd / (6.0 * max(saturation, 1e-3) * v)
        level = sd * math.hypot(1.0, 1.0 - saturation) / v
        return (min(hue, UNIFORM_SD) ** 2, level**2, sd**2)


@dataclass(frozen=True, slots=True)
class ColourBelief:
    """Independent Gaussians over hue (wrapped at 1), saturation and value (truncated to 0..1).

    Attributes:
        mean, variance: Of each, before wrapping or truncation.
        sensor: How it is observed.
        seen: Whether it has been.
    """

    mean: tuple[float, float, float]
    variance: tuple[float, float, float]
    sensor: ColourSensor
    seen: bool = False

    @classmethod
    def of(cls, prior: HsvBelief, sensor: ColourSensor) -> "ColourBelief":
        """Return the belief of a message; means are brought into the range they can have."""
        hue, saturation, value = prior.mean
        return cls((hue % 1.0, _clip(saturation), _clip(value)), prior.variance, sensor)

    def updated(self, rgb: tuple[float, float, float]) -> "ColourBelief":
        """Return the belief after a mean colour was observed; Kalman on each axis, the hue's innovation wrapped."""
        z = self.sensor.hsv(rgb)
        noise = self.sensor.variance(z[1], z[2])
        gain = [v / (v + r) for v, r in zip(self.variance, noise, strict=True)]
        off = [math.remainder(z[0] - self.mean[0], 1.0), z[1] - self.mean[1], z[2] - self.mean[2]]
        hue, saturation, value = (m + k * d for m, k, d in zip(self.mean, gain, off, strict=True))
        h, s, v = ((1.0 - k) * old for k, old in zip(gain, self.variance, strict=True))
        return replace(self, mean=(hue % 1.0, saturation, value), variance=(h, s, v), seen=True)

    def fused(self, other: "ColourBelief", prior: "ColourBelief") -> "ColourBelief":
        """Return the belief of one who knows what both do; `prior` is what is known of any object, and so of both."""
        pooled = [
            _pooled(m, v, m2, v2, m0, v0, axis == 0)
            for axis, (m, v, m2, v2, m0, v0) in enumerate(
                zip(self.mean, self.variance, other.mean, other.variance, prior.mean, prior.variance, strict=True)
            )
        ]
        (h, hv), (s, sv), (v, vv) = pooled
        return replace(self, mean=(h, s, v), variance=(hv, sv, vv), seen=self.seen or other.seen)

    def observation_variance(self) -> tuple[float, float, float]:
        """Return the variance of one observation at the mean."""
        return self.sensor.variance(self.mean[1], self.mean[2])

    def prob(self, volume: HsvVolume) -> float:
        """Return P(the colour lies in the volume)."""
        h, s, v = (math.sqrt(max(variance, LEAST_VARIANCE)) for variance in self.variance)
        hue = _hue_mass(np.array(self.mean[0]), h, volume.hue)
        saturation = _level_mass(np.array(self.mean[1]), s, volume.saturation)
        return float(hue * saturation * _level_mass(np.array(self.mean[2]), v, volume.value))

    def prob_favourable(self, volume: HsvVolume, p: float) -> float:
        """Return P(one look lifts the belief in the volume to at least `p` | the colour lies in it).

        Given the volume the axes stay independent, and an axis reads z with density N(z; m, v + r) P(volume | z).
        """
        likely = (_clip(self.mean[1], *volume.saturation), _clip(self.mean[2], *volume.value))
        noise = self.sensor.variance(*likely)
        low, high = volume.hue
        spans = ((low, high if high >= low else high + 1.0), volume.saturation, volume.value)
        h, s, v = (
            _readings(axis == 0, self.mean[axis], self.variance[axis], noise[axis], spans[axis]) for axis in range(3)
        )
        belief, weight = np.outer(s[0], v[0]).ravel(), np.outer(s[1], v[1]).ravel()
        order = np.argsort(belief, kind="stable")
        at_least = np.append(np.cumsum(weight[order][::-1])[::-1], 0.0)  # weight of the readings from each on
        needed = (p - ROUNDING) / np.maximum(h[0], ROUNDING)
        return min(1.0, float(h[1] @ at_least[np.searchsorted(belief[order], needed)]))


def _pooled(
    mean: float, variance: float, mean2: float, variance2: float, mean0: float, variance0: float, wraps: bool
) -> tuple[float, float]:
    """Return mean and variance of an axis from a belief and from what a second one says beyond the prior of both."""
    learnt = max(1.0 / max(variance2, LEAST_VARIANCE) - 1.0 / max(variance0, LEAST_VARIANCE), 0.0)
    if learnt == 0.0:
        return mean, variance
    off, back = mean2 - mean, mean0 - mean2
    if wraps:
        off, back = math.remainder(off, 1.0), math.remainder(back, 1.0)
    pull = off / max(variance2, LEAST_VARIANCE) - (off + back) / max(variance0, LEAST_VARIANCE)
    total = 1.0 / max(variance, LEAST_VARIANCE) + learnt
    moved = mean + pull / total
    return (moved % 1.0 if wraps else moved), 1.0 / total


def _clip(x: float, low: float = 0.0, high: float = 1.0) -> float:
    return min(high, max(low, x))


def _hue_mass(mean: Array, sd: float, span: tuple[float, float]) -> Array:
    """Return the mass of wrapped Gaussians in an interval that wraps if low > high, of the shape of `mean`."""
    low, high = span
    high = high if high >= low else high + 1.0
    turns = math.ceil(8.0 * sd) + 2
    k = np.arange(-turns, turns + 1)
    at = mean[..., None] - k
    return np.asarray(np.minimum(1.0, (ndtr((high - at) / sd) - ndtr((low - at) / sd)).sum(axis=-1)))


def _level_mass(mean: Array, sd: float, span: tuple[float, float]) -> Array:
    """Return the mass, in an interval, of Gaussians truncated to 0..1, of the shape of `mean`.

    Means beyond the range, which a noisy reading can have, count as its end: the sensor saturates there.
    """
    mean = np.clip(mean, 0.0, 1.0)
    low, high = max(span[0], 0.0), min(span[1], 1.0)
    inside = ndtr((high - mean) / sd) - ndtr((low - mean) / sd)
    return np.asarray(inside / (ndtr((1.0 - mean) / sd) - ndtr(-mean / sd)))


def _readings(
    is_hue: bool, mean: float, variance: float, noise: float, span: tuple[float, float]
) -> tuple[Array, Array]:
    """Return (belief in `span` after a reading, weight of the reading given `span`) over readings of one axis."""
    if not is_hue and span[0] <= 0.0 and span[1] >= 1.0:
        return np.ones(1), np.ones(1)
    reach = 5.0 * math.sqrt(noise)
    z = np.linspace(span[0] - reach, span[1] + reach, HUE_NODES if is_hue else LEVEL_NODES)
    gain, left = variance / (variance + noise), math.sqrt(max(variance * noise / (variance + noise), LEAST_VARIANCE))
    off = z - mean
    if is_hue:
        off = off - np.round(off)
        given = belief = _hue_mass(mean + gain * off, left, span)
    else:  # what exceeds the range is reported as its end
        given = _level_mass(mean + gain * off, left, span)
        belief = _level_mass(mean + gain * (np.clip(z, 0.0, 1.0) - mean), left, span)
    weight = np.exp(-0.5 * off**2 / (variance + noise)) * given
    total = weight.sum()
    return belief, (weight / total if total > 0.0 else np.zeros_like(weight))
