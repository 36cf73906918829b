"""The belief on an object's weight, and the wrist as its sensor."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from skolem.estimation.attributes import ROUNDING
from skolem.traces.messages import WeightInterval

Array = NDArray[np.float64]
WEIGHT_NODES = 401  # number of nodes of the grid over ln(kg)
QUANTILES, NOISE_NODES = 64, 9  # number of weights at which readings are tried, and of readings at each weight
LEAST_VARIANCE = 1e-12  # least variance of a belief in computations


@dataclass(frozen=True, slots=True)
class WeightSensor:
    """A sensor of weight in kg, with noise of `sd_kg` per reading and a bias of sd `drift_kg` common to all of them."""

    sd_kg: float
    drift_kg: float

    def variance(self, count: int) -> float:
        """Return the variance of the mean of `count` readings."""
        return max(self.drift_kg**2 + self.sd_kg**2 / count, 1e-8)


@dataclass(frozen=True, slots=True)
class WeightBelief:
    """A log-normal prior and the mean of the readings in kg; a grid over ln(kg) joins them.

    Attributes:
        mean, variance: Mean and variance of ln(kg) before any reading.
        sensor: The sensor of the readings.
        kg: Mean of the readings.
        count: Number of readings.
    """

    mean: float
    variance: float
    sensor: WeightSensor
    kg: float = 0.0
    count: int = 0

    def updated(self, kg: float) -> "WeightBelief":
        """Return the belief after a reading in kg, which may be negative."""
        return replace(self, kg=(self.kg * self.count + kg) / (self.count + 1), count=self.count + 1)

    def fused(self, other: "WeightBelief") -> "WeightBelief":
        """Return the belief after the readings of both."""
        count = self.count + other.count
        kg = (self.kg * self.count + other.kg * other.count) / count if count else 0.0
        return replace(self, kg=kg, count=count)

    def matched(self) -> tuple[float, float]:
        """Return mean and variance of ln(kg)."""
        if not self.count:
            return self.mean, self.variance
        u, p = self._grid()
        mean = float(p @ u)
        return mean, float(p @ (u - mean) ** 2)

    def observation_variance(self, log_kg: float) -> float:
        """Return the variance of one reading in ln(kg), to first order at the weight `log_kg`."""
        return self.sensor.variance(1) / math.exp(2.0 * log_kg)

    def prob(self, interval: WeightInterval) -> float:
        """Return P(the weight lies in the interval)."""
        low, high = log_span(interval)
        if not self.count:
            sd = math.sqrt(max(self.variance, LEAST_VARIANCE))
            return float(ndtr((high - self.mean) / sd) - ndtr((low - self.mean) / sd))
        mass = np.interp([low, high], *self.cumulated())
        return min(1.0, max(0.0, float(mass[1] - mass[0])))

    def cumulated(self) -> tuple[Array, Array]:
        """Return weights in ln(kg), ascending, and the probability below each; it is linear between them."""
        u, p = self._grid()
        if not self.count:
            return u, np.asarray(ndtr((u - self.mean) / math.sqrt(max(self.variance, LEAST_VARIANCE))))
        edges = np.concatenate([u[:1], (u[1:] + u[:-1]) / 2.0, u[-1:]])
        return edges, np.concatenate([[0.0], np.cumsum(p)])

    def prob_favourable(self, interval: WeightInterval, p: float) -> float:
        """Return P(one reading raises the belief in the interval to at least `p` | the weight lies in it).

        Readings are tried at quantiles of the weights inside, with Gauss-Hermite nodes of the noise around each. A grid
        over all readings would be far coarser than the noise if the prior includes heavy objects.
        """
        u, mass = self._grid()
        low, high = log_span(interval)
        inside = (u >= low) & (u < high)
        if not inside.any():
            return 0.0
        expected, variance = self._next_reading(np.exp(u))
        share = np.cumsum(mass[inside]) - 0.5 * mass[inside]
        middles = np.interp((np.arange(QUANTILES) + 0.5) / QUANTILES * mass[inside].sum(), share, expected[inside])
        offsets, weights = np.polynomial.hermite_e.hermegauss(NOISE_NODES)
        z = (middles[:, None] + math.sqrt(variance) * offsets).ravel()
        distance = (z[:, None] - expected[None, :]) ** 2
        likelihood = np.exp(-0.5 * (distance - distance.min(axis=1, keepdims=True)) / variance) * mass
        reached = likelihood[:, inside].sum(axis=1) >= (p - ROUNDING) * likelihood.sum(axis=1)
        return float(
            reached.reshape(QUANTILES, NOISE_NODES) @ weights @ np.ones(QUANTILES) / (QUANTILES * weights.sum())
        )

    def _next_reading(self, kg: Array) -> tuple[Array, float]:
        """Return mean, (n,), and variance of the next reading per true weight; past readings show part of the bias."""
        drift, single = self.sensor.drift_kg**2, self.sensor.sd_kg**2
        if not self.count:
            return kg, self.sensor.variance(1)
        shown = drift / max(drift + single / self.count, LEAST_VARIANCE)
        return kg + shown * (self.kg - kg), max(drift * (1.0 - shown) + single, 1e-8)

    def _grid(self) -> tuple[Array, Array]:
        """Return ln(kg), shape (n,), and the probability of each cell; further passes narrow the grid to the mass."""
        sd = math.sqrt(max(self.variance, LEAST_VARIANCE))
        u = np.linspace(self.mean - 7.0 * sd, self.mean + 7.0 * sd, WEIGHT_NODES)
        for _ in range(2):
            log_p = self._log_density(u)
            kept = np.nonzero(log_p >= log_p.max() - 40.0)[0]
            first, last = max(kept[0] - 1, 0), min(kept[-1] + 1, WEIGHT_NODES - 1)
            u = np.linspace(u[first], u[last], WEIGHT_NODES)
        log_p = self._log_density(u)
        p = np.exp(log_p - log_p.max())
        return u, p / p.sum()

    def _log_density(self, u: Array) -> Array:
        log_p = -0.5 * (u - self.mean) ** 2 / max(self.variance, LEAST_VARIANCE)
        if self.count:
            log_p = log_p - 0.5 * (self.kg - np.exp(u)) ** 2 / self.sensor.variance(self.count)
        return np.asarray(log_p)


def log_span(interval: WeightInterval) -> tuple[float, float]:
    """Return the interval in ln(kg)."""
    low = math.log(interval.at_least_kg) if interval.at_least_kg > 0.0 else -math.inf
    high = math.inf if interval.below_kg is None else math.log(interval.below_kg)
    return low, high
