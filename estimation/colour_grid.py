"""The density of a colour over hue, saturation and value, given a prior in HSV and readings in RGB.

At a fixed hue and saturation, the RGB of a surface is proportional to its value. So a Gaussian over RGB is also one
over the value. The grid is over hue and saturation only, and the value is integrated in closed form. The grid covers
the mass: a few hundredths of the circle for a bright red, the whole circle for a grey.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

Array = NDArray[np.float64]
Triple = tuple[float, float, float]
FINE, COARSE = (48, 32), (24, 16)  # number of cells of the grid: hues, saturations
ZOOMS = 4  # greatest number of times that the grid is narrowed to the mass
NEGLIGIBLE = 18.0  # nats between the densest cell and a negligible one: 6 sds
FAR_SDS = 8.0  # half width of the first grid
SHRUNK = 0.7  # a grid that would keep a greater share of its width is narrow enough
LEAST_VARIANCE = 1e-12  # least variance of a belief in computations
LEAST_MASS = 1e-300


@dataclass(frozen=True, slots=True)
class Readings:
    """The readings of an RGB, channel by channel.

    Attributes:
        mean: Mean of the readings, shape (3,).
        precision: Precision of the mean, shape (3,); 0 for a channel without a reading.
    """

    mean: Array
    precision: Array


@dataclass(frozen=True, slots=True)
class ColourGrid:
    """A density over cells of hue and saturation, with a Gaussian over the value in each, truncated to 0..1.

    Attributes:
        hues: Borders of the cells, shape (n + 1,), ascending over at most one turn.
        saturations: Borders of the cells, shape (m + 1,), ascending within 0..1.
        weight: Density times the mass of the untruncated Gaussian, up to a factor, shape (n, m).
        value, sd: Mean and sd of the Gaussian over the value before truncation, shape (n, m).
    """

    hues: Array
    saturations: Array
    weight: Array
    value: Array
    sd: Array

    def mass(self, hue: tuple[float, float], saturation: tuple[float, float], value: tuple[float, float]) -> float:
        """Return the probability of a box in HSV; the interval of hue wraps if its first end is the larger."""
        joint = self.joint(hue, saturation, value)
        whole = self.weight * self.between(0.0, 1.0)
        return min(1.0, float(joint.sum()) / max(float(whole.sum()), LEAST_MASS))

    def joint(self, hue: tuple[float, float], saturation: tuple[float, float], value: tuple[float, float]) -> Array:
        """Return the mass of each cell within a box, in units of `weight`, shape (n, m)."""
        low, high = hue
        high = high if high >= low else high + 1.0
        width = np.diff(self.hues)
        turns = range(math.floor(self.hues[0] - high) - 1, math.ceil(self.hues[-1] - low) + 2)
        around = np.minimum(sum((_overlap(self.hues, low + k, high + k) for k in turns), np.zeros(len(width))), width)
        up = _overlap(self.saturations, *saturation)
        shares = np.outer(around / width, up / np.diff(self.saturations))
        return np.asarray(shares * self.weight * self.between(max(value[0], 0.0), min(value[1], 1.0)))

    def between(self, low: float, high: float) -> Array:
        """Return the mass of each cell's Gaussian between two values, shape (n, m)."""
        return np.asarray(ndtr((high - self.value) / self.sd) - ndtr((low - self.value) / self.sd))

    def moments(self) -> tuple[Triple, Triple]:
        """Return mean and variance of hue (around the circle), saturation and value."""
        inside = np.maximum(self.between(0.0, 1.0), LEAST_MASS)
        p = self.weight * inside
        p = p / p.sum()
        hues, saturations = _middles(self.hues), _middles(self.saturations)
        by_hue, by_saturation = p.sum(axis=1), p.sum(axis=0)
        hue = math.atan2(by_hue @ np.sin(math.tau * hues), by_hue @ np.cos(math.tau * hues)) / math.tau
        off = hues - hue
        off = off - np.round(off)
        saturation = float(by_saturation @ saturations)
        a, b = -self.value / self.sd, (1.0 - self.value) / self.sd
        at_a, at_b = (np.exp(-0.5 * x * x) / math.sqrt(math.tau) for x in (a, b))
        means = np.clip(self.value + self.sd * (at_a - at_b) / inside, 0.0, 1.0)
        spread = 1.0 + (a * at_a - b * at_b) / inside - ((at_a - at_b) / inside) ** 2
        value = float((p * means).sum())
        variance = float((p * (self.sd**2 * np.clip(spread, 0.0, 1.0) + (means - value) ** 2)).sum())
        variances = (float(by_hue @ off**2), float(by_saturation @ (saturations - saturation) ** 2), variance)
        h, s, v = (max(each, LEAST_VARIANCE) for each in variances)
        return (hue % 1.0, saturation, value), (h, s, v)


def colour_grid(
    mean: Triple,
    variance: Triple,
    gain: float,
    readings: Readings,
    first: tuple[Triple, Triple] | None,
    cells: tuple[int, int] = FINE,
) -> ColourGrid:
    """Return the density of a colour.

    Args:
        mean: Mean of the prior: independent Gaussians over hue (wrapped), saturation and value (truncated to 0..1).
        variance: Variance of the prior.
        gain: Factor from the true RGB to the reading.
        readings: The readings.
        first: HSV of the readings alone and its sds, which bound the first grid; None if there are no readings.
        cells: Number of hues and of saturations.
    """
    sds = [math.sqrt(max(v, LEAST_VARIANCE)) for v in variance]
    windows = []
    for axis in (0, 1):
        low, high = mean[axis] - FAR_SDS * sds[axis], mean[axis] + FAR_SDS * sds[axis]
        if first is not None:
            at = first[0][axis]
            if axis == 0:
                at = mean[0] + math.remainder(at - mean[0], 1.0)
            reach = FAR_SDS * first[1][axis]
            low, high = _met((low, high), (at - reach, at + reach))
        windows.append((low, high))
    hues, saturations = _whole_turn(*windows[0]), (max(windows[1][0], 0.0), min(windows[1][1], 1.0))
    for _ in range(ZOOMS):
        grid, log_weight = _cells(mean, sds, gain, readings, hues, saturations, cells)
        kept = log_weight > log_weight.max() - NEGLIGIBLE
        narrower = (_kept(grid.hues, kept.any(axis=1)), _kept(grid.saturations, kept.any(axis=0)))
        shrunk = [(b - a) / (d - c) for (a, b), (c, d) in zip(narrower, (hues, saturations), strict=True)]
        if min(shrunk) > SHRUNK:
            break
        hues, saturations = narrower
    return grid


def _cells(
    mean: Triple,
    sds: list[float],
    gain: float,
    readings: Readings,
    hues: tuple[float, float],
    saturations: tuple[float, float],
    cells: tuple[int, int],
) -> tuple[ColourGrid, Array]:
    """Return the grid over some hues and saturations, and the logarithm of the mass of each cell, shape (n, m)."""
    hue_borders = np.linspace(*hues, cells[0] + 1)
    saturation_borders = np.linspace(*saturations, cells[1] + 1)
    h, s = _middles(hue_borders), _middles(saturation_borders)
    least = 1.0 - pure_rgb(h)  # 1 less each channel at full saturation and value, shape (3, n)
    seen = gain * (1.0 - s[None, None, :] * least[:, :, None])  # reading at value 1, shape (3, n, m)
    weighted = readings.precision[:, None, None] * seen
    precision = (weighted * seen).sum(axis=0) + sds[2] ** -2
    pull = np.tensordot(readings.mean, weighted, axes=1) + mean[2] * sds[2] ** -2
    value, sd = pull / precision, 1.0 / np.sqrt(precision)
    misfit = readings.precision @ readings.mean**2 + (mean[2] / sds[2]) ** 2 - pull * value
    log_weight = -0.5 * misfit + np.log(sd) + _log_wrapped(h, mean[0], sds[0])[:, None]
    log_weight = log_weight - 0.5 * ((s - mean[1]) / sds[1]) ** 2
    inside = ndtr((1.0 - value) / sd) - ndtr(-value / sd)
    log_mass = log_weight + np.log(np.maximum(inside, LEAST_MASS))
    weight = np.exp(np.minimum(log_weight - log_mass.max(), 600.0))
    return ColourGrid(hue_borders, saturation_borders, weight, value, sd), log_mass


def pure_rgb(hues: Array) -> Array:
    """Return the RGB, shape (3, n), of hues, shape (n,), at full saturation and value."""
    away = np.abs((hues[None, :] * 6.0 - np.array([0.0, 2.0, 4.0])[:, None] + 3.0) % 6.0 - 3.0)  # for each channel
    return np.asarray(np.clip(2.0 - away, 0.0, 1.0))


def _log_wrapped(hues: Array, mean: float, sd: float) -> Array:
    """Return the logarithm of the density of a Gaussian wrapped at 1, up to a constant, shape (n,)."""
    turns = math.ceil(FAR_SDS * sd) + 1
    off = (hues - mean) - np.round(hues - mean)
    squared = ((off[:, None] - np.arange(-turns, turns + 1)) / sd) ** 2
    nearest = squared.min(axis=1)
    return np.asarray(-0.5 * nearest + np.log(np.exp(-0.5 * (squared - nearest[:, None])).sum(axis=1)))


def _met(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    """Return the intersection of two intervals, or the least interval over both if it is empty."""
    low, high = max(a[0], b[0]), min(a[1], b[1])
    return (low, high) if low < high else (min(a[0], b[0]), max(a[1], b[1]))


def _whole_turn(low: float, high: float) -> tuple[float, float]:
    """Return an interval of hues, cut to one turn about its middle if it is longer."""
    return (low, high) if high - low < 1.0 else ((low + high) / 2.0 - 0.5, (low + high) / 2.0 + 0.5)


def _kept(borders: Array, kept: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the interval of the kept cells and one more cell at each side."""
    index = np.flatnonzero(kept)
    return float(borders[max(index[0] - 1, 0)]), float(borders[min(index[-1] + 2, len(borders) - 1)])


def _middles(borders: Array) -> Array:
    return (borders[1:] + borders[:-1]) / 2.0


def _overlap(borders: Array, low: float, high: float) -> Array:
    """Return the length of each cell within an interval, shape (n,)."""
    return np.asarray(np.maximum(np.minimum(borders[1:], high) - np.maximum(borders[:-1], low), 0.0))
