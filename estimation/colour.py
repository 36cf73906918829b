"""The belief on an object's colour, and the camera as its sensor.

Words are about hue, saturation and value, but noise acts on red, green and blue. So the belief keeps the prior in HSV
and the readings in RGB, channel by channel. A posterior in HSV would have to take its noise from a noisy reading.
"""

import colorsys
import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from skolem.estimation.attributes import ROUNDING
from skolem.estimation.colour_grid import COARSE, FINE, LEAST_VARIANCE, ColourGrid, Readings, Triple, colour_grid
from skolem.traces.messages import ColourMeaning, HsvBelief, HsvVolume

Array = NDArray[np.float64]
UNIFORM_SD = 12**-0.5  # sd of an unknown hue
LOOKS = 32  # number of tried readings of one more look
LEAST_SD = 1e-4  # least sd of a channel, for a sensor without noise
# A channel that reads 0 was at most 0. The likelihood of its mean m is Phi(-m / sd). To second order at m = 0, this is
# the likelihood of a reading at -sqrt(pi / 2) sds with 2 / pi of the precision. The same holds at 1.
CLIPPED_SDS, CLIPPED_PRECISION = math.sqrt(math.pi / 2.0), 2.0 / math.pi
SEQUENCE = tuple(1.1673039782614187**-k for k in range(1, 7))  # additive recurrence in 6 dimensions: x^7 = x + 1
GRIDS = 256  # number of grids kept
AXES = ("hue", "saturation", "value")
NOTHING: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ColourSensor:
    """A sensor of mean colours: it reads the true RGB times `gain`, plus noise of `sd_rgb` per channel."""

    gain: float
    sd_rgb: float

    def hsv(self, rgb: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the HSV of a surface from its reading `rgb`."""
        red, green, blue = (min(1.0, max(0.0, channel / self.gain)) for channel in rgb)
        return colorsys.rgb_to_hsv(red, green, blue)

    @property
    def sd(self) -> float:
        """Sd of one channel of a reading."""
        return max(self.sd_rgb, LEAST_SD * self.gain)

    def variance(self, saturation: float, value: float) -> tuple[float, float, float]:
        """Return the variance of an observed (hue, saturation, value), to first order in the RGB noise.

        The hue of a colour with largest channel v and range s v errs by sqrt(2) sd / (6 s v); a grey's is unknown.
        """
        sd = self.sd / self.gain
        v = max(value, sd)
        hue = math.sqrt(2.0) * sd / (6.0 * max(saturation, 1e-3) * v)
        level = sd * math.hypot(1.0, 1.0 - saturation) / v
        return (min(hue, UNIFORM_SD) ** 2, level**2, sd**2)


@dataclass(frozen=True, slots=True)
class ColourBelief:
    """A prior over hue (wrapped at 1), saturation and value (truncated to 0..1), and the mean of the readings.

    Attributes:
        mean, variance: Mean and variance of the prior, before wrapping or truncation.
        sensor: The sensor of the readings.
        rgb: Mean of the readings, channel by channel.
        precision: Precision of that mean, channel by channel; 0 before the first reading.
    """

    mean: Triple
    variance: Triple
    sensor: ColourSensor
    rgb: Triple = NOTHING
    precision: Triple = NOTHING

    @classmethod
    def of(cls, prior: HsvBelief, sensor: ColourSensor) -> "ColourBelief":
        """Return the belief that a message states; the means are brought into their ranges."""
        hue, saturation, value = prior.mean
        return cls((hue % 1.0, _clip(saturation), _clip(value)), prior.variance, sensor)

    @property
    def seen(self) -> bool:
        """Whether the colour has been observed."""
        return self.precision != NOTHING

    def updated(self, rgb: Triple) -> "ColourBelief":
        """Return the belief after the reading of a mean colour; a channel beyond 0..1 reads as the nearer end."""
        sd = self.sensor.sd
        at = tuple(-CLIPPED_SDS * sd if c <= 0.0 else 1.0 + CLIPPED_SDS * sd if c >= 1.0 else c for c in rgb)
        precision = tuple((1.0 if 0.0 < c < 1.0 else CLIPPED_PRECISION) / sd**2 for c in rgb)
        return self._read(at, precision)

    def _read(self, rgb: tuple[float, ...], precision: tuple[float, ...]) -> "ColourBelief":
        total = tuple(old + new for old, new in zip(self.precision, precision, strict=True))
        mean = tuple(
            old + (new - old) * (share / whole if whole > 0.0 else 0.0)
            for old, new, share, whole in zip(self.rgb, rgb, precision, total, strict=True)
        )
        return replace(self, rgb=_triple(mean), precision=_triple(total))

    def fused(self, other: "ColourBelief", prior: "ColourBelief") -> "ColourBelief":
        """Return the belief that joins the observations of both; `prior` is the belief that both began with."""
        pooled = [
            _pooled(m, v, m2, v2, m0, v0, axis == 0)
            for axis, (m, v, m2, v2, m0, v0) in enumerate(
                zip(self.mean, self.variance, other.mean, other.variance, prior.mean, prior.variance, strict=True)
            )
        ]
        (h, hv), (s, sv), (v, vv) = pooled
        return replace(self, mean=(h, s, v), variance=(hv, sv, vv))._read(other.rgb, other.precision)

    def matched(self) -> tuple[Triple, Triple]:
        """Return mean and variance of hue, saturation and value."""
        return _grid(self).moments() if self.seen else (self.mean, self.variance)

    def prob(self, meaning: ColourMeaning) -> float:
        """Return P(the colour lies in one of the boxes of the meaning)."""
        return min(1.0, sum(self._prob(box) for box in meaning.boxes))

    def _prob(self, volume: HsvVolume) -> float:
        if self.seen:
            return _grid(self).mass(volume.hue, volume.saturation, volume.value)
        h, s, v = (math.sqrt(max(variance, LEAST_VARIANCE)) for variance in self.variance)
        hue = _hue_mass(self.mean[0], h, volume.hue)
        saturation = _level_mass(self.mean[1], s, volume.saturation)
        return hue * saturation * _level_mass(self.mean[2], v, volume.value)

    def prob_favourable(self, meaning: ColourMeaning, p: float) -> float:
        """Return P(one look raises the belief in the meaning to at least `p` | it is true of the colour)."""
        lifted = _lifted(self, meaning)
        return sum(after >= p - ROUNDING for after in lifted) / len(lifted) if lifted else 0.0


@lru_cache(GRIDS)
def _grid(belief: ColourBelief, cells: tuple[int, int] = FINE) -> ColourGrid:
    """Return the density of the colour."""
    readings = Readings(np.array(belief.rgb), np.array(belief.precision))
    return colour_grid(belief.mean, belief.variance, belief.sensor.gain, readings, _first(belief), cells)


def _first(belief: ColourBelief) -> tuple[Triple, Triple] | None:
    """Return the HSV of the readings alone and generous sds, which bound the first grid; None without a reading."""
    if not belief.seen:
        return None
    hsv = belief.sensor.hsv(belief.rgb)
    spread = 2.0 / math.sqrt(min(belief.precision) * belief.sensor.sd**2)
    _, level, value = (math.sqrt(v) for v in belief.sensor.variance(hsv[1], hsv[2]))
    level, value = spread * level, spread * value
    darkest = max(hsv[2] - 3.0 * value, 0.2 * hsv[2])
    hue = math.sqrt(belief.sensor.variance(max(hsv[1] - 3.0 * level, 0.0), darkest)[0])
    return hsv, (spread * hue, level, value)


@lru_cache(GRIDS)
def _lifted(belief: ColourBelief, meaning: ColourMeaning) -> tuple[float, ...]:
    """Return the belief in a meaning after each of some equally likely looks at colours within the meaning.

    The colours are spread evenly over the belief within the boxes, and the errors over the noise of the sensor.
    """
    grid, boxes = _grid(belief), meaning.boxes
    joint = np.cumsum([grid.joint(box.hue, box.saturation, box.value) for box in boxes])
    if not joint[-1] > 0.0:
        return ()
    steps = (0.5 + np.arange(1, LOOKS + 1)[:, None] * np.array(SEQUENCE)) % 1.0
    cells = np.minimum(np.searchsorted(joint, steps[:, 0] * joint[-1]), len(joint) - 1)
    box, i, j = np.unravel_index(cells, (len(boxes), *grid.weight.shape))
    hue, saturation, value = (np.array([getattr(b, axis) for b in boxes])[box] for axis in AXES)
    h = _within(_between(grid.hues, i, steps[:, 1]), hue)
    s = np.clip(_between(grid.saturations, j, steps[:, 2]), saturation[:, 0], saturation[:, 1])
    middle, sd = grid.value[i, j], grid.sd[i, j]
    below, above = np.clip(value, 0.0, 1.0).T
    low, high = ndtr((below - middle) / sd), ndtr((above - middle) / sd)
    share = (0.5 + np.arange(1, LOOKS + 1) * math.sqrt(2.0)) % 1.0
    v = np.clip(middle + sd * ndtri(np.clip(low + share * (high - low), ROUNDING, 1.0 - ROUNDING)), below, above)
    noise = belief.sensor.sd * ndtri(np.clip(steps[:, 3:], ROUNDING, 1.0 - ROUNDING))
    colours = [colorsys.hsv_to_rgb(*hsv) for hsv in zip(h.tolist(), s.tolist(), v.tolist(), strict=True)]
    seen = np.clip(belief.sensor.gain * np.array(colours) + noise, 0.0, 1.0).tolist()
    after = (_grid(belief.updated(_triple(rgb)), COARSE) for rgb in seen)
    return tuple(sum(grid.mass(b.hue, b.saturation, b.value) for b in boxes) for grid in after)


def _between(borders: Array, cells: NDArray[np.intp], share: Array) -> Array:
    """Return the points at given shares of the widths of cells, shape (n,)."""
    return np.asarray(borders[cells] + share * (borders[cells + 1] - borders[cells]))


def _within(hues: Array, spans: Array) -> Array:
    """Return hues, (n,), brought into their spans, (n, 2); a span wraps if its first hue is the larger."""
    low = spans[:, 0]
    width = np.where(spans[:, 1] >= low, spans[:, 1] - low, spans[:, 1] - low + 1.0)
    off = (hues - low) % 1.0
    beyond = np.where(off - width < 1.0 - off, width, 0.0)
    return np.asarray((low + np.where(off > width, beyond, off)) % 1.0)


def _triple(values: "tuple[float, ...] | list[float]") -> Triple:
    a, b, c = values
    return (a, b, c)


def _pooled(
    mean: float, variance: float, mean2: float, variance2: float, mean0: float, variance0: float, wraps: bool
) -> tuple[float, float]:
    """Return mean and variance of an axis from a belief and the observations of a second one with the same prior."""
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


def _hue_mass(mean: float, sd: float, span: tuple[float, float]) -> float:
    """Return the mass of a wrapped Gaussian in an interval that wraps if low > high."""
    low, high = span
    high = high if high >= low else high + 1.0
    turns = math.ceil(8.0 * sd) + 2
    at = mean - np.arange(-turns, turns + 1)
    return min(1.0, float((ndtr((high - at) / sd) - ndtr((low - at) / sd)).sum()))


def _level_mass(mean: float, sd: float, span: tuple[float, float]) -> float:
    """Return the mass, in an interval, of a Gaussian truncated to 0..1."""
    low, high = max(span[0], 0.0), min(span[1], 1.0)
    inside = ndtr((high - mean) / sd) - ndtr((low - mean) / sd)
    return float(inside / (ndtr((1.0 - mean) / sd) - ndtr(-mean / sd)))
