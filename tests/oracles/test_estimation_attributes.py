"""Updates of colour, type and weight against Bayes' rule by numeric integration, written without their code."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from skolem.estimation.attributes import TypeBelief, after_evidence, after_miss
from skolem.estimation.colour import ColourBelief, ColourSensor
from skolem.estimation.weight import WeightBelief, WeightSensor
from skolem.traces.messages import HsvBelief, HsvVolume, WeightInterval

Array = NDArray[np.float64]
CAMERA = ColourSensor(0.83, 0.03)
WRIST = WeightSensor(0.04, 0.02)
VOLUMES = {
    "red": HsvVolume(hue=(0.93, 0.06), saturation=(0.3, 1.0), value=(0.2, 1.0)),
    "green": HsvVolume(hue=(0.25, 0.42), saturation=(0.3, 1.0), value=(0.2, 1.0)),
    "pale": HsvVolume(hue=(0.0, 1.0), saturation=(0.0, 0.5), value=(0.6, 1.0)),
}


def normal(x: Array, mean: float, variance: float) -> Array:
    return np.asarray(np.exp(-0.5 * (x - mean) ** 2 / variance))


def mass(x: Array, density: Array, low: float, high: float) -> float:
    """Return the share of a density on a fine even grid that lies between two numbers."""
    inside = (x >= low) & (x <= high)
    return float(density[inside].sum() / density.sum())


def hue_mass(x: Array, density: Array, low: float, high: float) -> float:
    return mass(x, density, low, high) if low <= high else mass(x, density, low, 1.0) + mass(x, density, 0.0, high)


# ---------------------------------------------------------------- colour


@pytest.mark.parametrize("rgb", [(0.75, 0.12, 0.11), (0.7, 0.1, 0.13), (0.1, 0.62, 0.15), (0.55, 0.5, 0.45)])
def test_colour_is_that_of_bayes_rule_on_a_fine_grid_of_colours(rgb: tuple[float, float, float]) -> None:
    prior = HsvBelief(mean=(0.97, 0.6, 0.7), variance=(0.02, 0.04, 0.03))
    belief = ColourBelief.of(prior, CAMERA).updated(rgb)
    h, s, v = ((np.arange(n) + 0.5) / n for n in (600, 100, 100))
    k = (np.array([5.0, 3.0, 1.0])[:, None] + 6.0 * h) % 6.0
    missing = np.clip(np.minimum(k, 4.0 - k), 0.0, 1.0)  # of each channel at full saturation, shape (3, 600)
    wrapped = sum((normal(h + turn, prior.mean[0], prior.variance[0]) for turn in range(-2, 3)), np.zeros_like(h))
    density = wrapped[:, None, None] * np.outer(normal(s, 0.6, 0.04), normal(v, 0.7, 0.03))
    for channel, less in zip(rgb, missing, strict=True):
        true = v * (1.0 - s[None, :, None] * less[:, None, None])
        density = density * normal(CAMERA.gain * true, channel, CAMERA.sd_rgb**2)
    density /= density.sum()
    for volume in VOLUMES.values():
        low, high = volume.hue
        around = (h >= low) & (h <= high) if low <= high else (h >= low) | (h <= high)
        boxes = [(x >= span[0]) & (x <= span[1]) for x, span in ((s, volume.saturation), (v, volume.value))]
        expected = density[np.ix_(around, *boxes)].sum()
        assert belief.prob(volume) == pytest.approx(expected, abs=0.01)


def test_colours_learnt_apart_and_pooled_are_as_if_learnt_together() -> None:
    prior = ColourBelief.of(HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.09, 0.09, 0.09)), CAMERA)
    first, second = (0.7, 0.1, 0.13), (0.75, 0.12, 0.11)
    together = prior.updated(first).updated(second)
    pooled = prior.updated(first).fused(prior.updated(second), prior)
    assert pooled.rgb == pytest.approx(together.rgb, abs=1e-12)
    assert pooled.precision == pytest.approx(together.precision, rel=1e-12)
    assert prior.fused(prior, prior) == prior


# ---------------------------------------------------------------- type


def test_type_is_that_of_bayes_rule_over_every_history_of_readings() -> None:
    names, right = ("bottle", "carton", "soda"), 0.8
    told = {"bottle": 0.5, "carton": 0.2, "soda": 0.3}
    readings = ({"bottle": -1.0, "carton": -9.0, "soda": -0.2}, {"bottle": -3.0, "carton": -0.1, "soda": -2.0})
    belief = TypeBelief(told, names, right)
    joint = dict(told)
    for reading in readings:
        belief = belief.updated(reading)
        weights = {name: math.exp(value) for name, value in reading.items()}
        total = sum(weights.values())
        for true in names:
            seen_as = {name: right if name == true else (1.0 - right) / 2.0 for name in names}
            joint[true] *= sum(seen_as[name] * weights[name] / total for name in names)
    for name in names:
        assert belief.prob(name) == pytest.approx(joint[name] / sum(joint.values()), abs=1e-12)


def test_types_learnt_apart_and_pooled_are_as_if_learnt_together() -> None:
    prior = TypeBelief({"bottle": 0.5, "carton": 0.2, "soda": 0.3}, ("bottle", "carton", "soda"), 0.8)
    a, b = {"bottle": -1.0, "carton": -9.0, "soda": -0.2}, {"bottle": -3.0, "carton": -0.1, "soda": -2.0}
    pooled = prior.updated(a).fused(prior.updated(b), prior)
    assert pooled.probabilities == pytest.approx(prior.updated(a).updated(b).probabilities, abs=1e-12)


def test_existence_is_that_of_bayes_rule() -> None:
    for p in (0.01, 0.5, 0.99):
        assert after_miss(p, 0.7) == pytest.approx(p * 0.3 / (p * 0.3 + 1.0 - p), abs=1e-12)
        assert after_evidence(p, 9.0) == pytest.approx(p * 0.9 / (p * 0.9 + (1.0 - p) * 0.1), abs=1e-12)


# ---------------------------------------------------------------- weight


@pytest.mark.parametrize("readings", [(0.42,), (0.35, 0.47, 0.41), (-0.03,), (0.02, 0.01), (1.6, 1.7)])
@pytest.mark.parametrize("interval", [(0.0, 0.4), (0.4, None), (0.38, 0.46)])
def test_weight_is_that_of_bayes_rule_over_weight_and_bias(
    readings: tuple[float, ...], interval: tuple[float, float | None]
) -> None:
    belief = WeightBelief(math.log(0.4), 0.36, WRIST)
    for kg in readings:
        belief = belief.updated(kg)
    u: Array = (math.log(0.4) - 6.0 + (np.arange(8000, dtype=np.float64) + 0.5) / 800.0)[:, None]
    bias = np.linspace(-0.12, 0.12, 481, dtype=np.float64)[None, :]
    density = normal(u, math.log(0.4), 0.36) * normal(bias, 0.0, WRIST.drift_kg**2)
    for kg in readings:
        density = density * normal(np.exp(u) + bias, kg, WRIST.sd_kg**2)
    low, high = interval
    inside = (np.exp(u) >= low) & (np.exp(u) < (math.inf if high is None else high))
    expected = float((density * inside).sum() / density.sum())
    assert belief.prob(WeightInterval(at_least_kg=low, below_kg=high)) == pytest.approx(expected, abs=1e-3)


def test_weighings_of_two_anchors_of_one_object_count_as_weighings_of_it() -> None:
    prior = WeightBelief(math.log(0.4), 0.36, WRIST)
    together = prior.updated(0.4).updated(0.5).updated(0.45)
    pooled = prior.updated(0.4).updated(0.5).fused(prior.updated(0.45))
    assert pooled.matched() == pytest.approx(together.matched())
    assert prior.fused(prior) == prior
