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
@pytest.mark.parametrize("word", VOLUMES)
def test_colour_is_that_of_bayes_rule_on_the_circle_and_on_the_intervals(
    rgb: tuple[float, float, float], word: str
) -> None:
    prior, volume = HsvBelief(mean=(0.97, 0.6, 0.7), variance=(0.004, 0.04, 0.03)), VOLUMES[word]
    belief = ColourBelief.of(prior, CAMERA).updated(rgb)
    z, noise = CAMERA.hsv(rgb), CAMERA.variance(*CAMERA.hsv(rgb)[1:])
    x = (np.arange(40_000) + 0.5) / 40_000
    hue = np.zeros_like(x), np.zeros_like(x)
    for k in range(-3, 4):
        hue[0][:] += normal(x + k, prior.mean[0], prior.variance[0])
        hue[1][:] += normal(x + k, z[0], noise[0])
    expected = hue_mass(x, hue[0] * hue[1], *volume.hue)
    for axis, span in ((1, volume.saturation), (2, volume.value)):
        density = normal(x, prior.mean[axis], prior.variance[axis]) * normal(x, z[axis], noise[axis])
        expected *= mass(x, density, *span)
    # the circle: a prior of .06 turns is one Gaussian of several; a half turn away their ratio is e^-31
    assert belief.prob(volume) == pytest.approx(expected, abs=2e-3)


def test_colours_learnt_apart_and_pooled_are_as_if_learnt_together() -> None:
    prior = ColourBelief.of(HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.09, 0.09, 0.09)), CAMERA)
    first, second = (0.7, 0.1, 0.13), (0.75, 0.12, 0.11)
    together = prior.updated(first).updated(second)
    pooled = prior.updated(first).fused(prior.updated(second), prior)
    assert pooled.mean == pytest.approx(together.mean, abs=1e-9)
    assert pooled.variance == pytest.approx(together.variance, rel=1e-9)
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
