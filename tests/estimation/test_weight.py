import math

import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.weight import WeightBelief, WeightSensor
from skolem.traces.messages import WeightInterval

HEAVY = WeightInterval(at_least_kg=0.4)
LIGHT = WeightInterval(at_least_kg=0.0, below_kg=0.4)
PRIOR = WeightBelief(math.log(0.3), 0.7**2, WeightSensor(sd_kg=0.08, drift_kg=0.0))


@pytest.mark.parametrize("reading", [0.5, 0.42, 0.1])
def test_reading_near_the_threshold_is_weighed_exactly(reading: float) -> None:
    u = np.linspace(math.log(0.3) - 6.0, math.log(0.3) + 6.0, 1_000_001)
    density = np.exp(-0.5 * (u - math.log(0.3)) ** 2 / 0.49 - 0.5 * (reading - np.exp(u)) ** 2 / 0.0064)
    exact = density[u >= math.log(0.4)].sum() / density.sum()
    assert PRIOR.updated(reading).prob(HEAVY) == pytest.approx(exact, abs=2e-4)


def test_object_that_weighs_100_grams_is_not_heavy() -> None:
    sensor = WeightSensor(sd_kg=0.04, drift_kg=0.04)
    weighed = WeightBelief(math.log(0.3), 0.36, sensor).updated(0.1)
    assert weighed.prob(HEAVY) < 1e-3


def test_reading_below_zero_means_light() -> None:
    weighed = PRIOR.updated(-0.03)
    assert weighed.prob(HEAVY) < 1e-3
    assert weighed.matched()[0] < PRIOR.mean


def test_nearly_exact_scales_are_believed() -> None:
    weighed = WeightBelief(math.log(0.3), 0.49, WeightSensor(sd_kg=0.0, drift_kg=0.0)).updated(0.5)
    mean, variance = weighed.matched()
    assert mean == pytest.approx(math.log(0.5), abs=1e-4)
    assert variance < 1e-6
    assert weighed.prob(HEAVY) == pytest.approx(1.0)


def test_complementary_intervals_share_the_mass() -> None:
    for weight in (PRIOR, PRIOR.updated(0.42)):
        assert weight.prob(HEAVY) + weight.prob(LIGHT) == pytest.approx(1.0)


def test_repeated_readings_average_their_noise_but_not_the_bias_of_the_run() -> None:
    free, biased = PRIOR, WeightBelief(PRIOR.mean, PRIOR.variance, WeightSensor(sd_kg=0.08, drift_kg=0.05))
    for _ in range(100):
        free, biased = free.updated(0.5), biased.updated(0.5)
    assert math.sqrt(free.matched()[1]) * 0.5 == pytest.approx(0.008, rel=0.1)
    assert math.sqrt(biased.matched()[1]) * 0.5 == pytest.approx(0.05, rel=0.15)


@pytest.mark.parametrize("past", [(), (0.45, 0.38)], ids=["first reading", "third reading"])
def test_chance_of_a_favourable_reading_agrees_with_weighing(past: tuple[float, ...]) -> None:
    belief = WeightBelief(math.log(0.3), 0.36, WeightSensor(sd_kg=0.06, drift_kg=0.04))
    draws = Generator(PCG64(SeedSequence([1])))
    kg = np.exp(draws.normal(belief.mean, 0.6, size=400_000))
    bias = draws.normal(size=kg.shape) * 0.04
    likelihood = np.ones_like(kg)
    for reading in past:
        belief = belief.updated(reading)
        likelihood *= np.exp(-0.5 * ((reading - kg - bias) / 0.06) ** 2)
    chosen = draws.choice(len(kg), size=1000, p=likelihood * (kg >= 0.4) / (likelihood * (kg >= 0.4)).sum())
    readings = kg[chosen] + bias[chosen] + draws.normal(size=len(chosen)) * 0.06
    lifted = np.mean([belief.updated(z).prob(HEAVY) >= 0.9 for z in readings.tolist()])
    assert belief.prob_favourable(HEAVY, 0.9) == pytest.approx(lifted, abs=0.05)


def test_beliefs_of_two_anchors_fuse_into_the_belief_after_all_readings() -> None:
    readings = (0.2, 0.3, 0.7, 0.5)
    one, other, both = PRIOR, PRIOR, PRIOR
    for kg in readings[:3]:
        one = one.updated(kg)
    other = other.updated(readings[3])
    for kg in readings:
        both = both.updated(kg)
    for fused in (one.fused(other), other.fused(one)):
        assert fused.count == 4
        assert fused.kg == pytest.approx(both.kg)
        assert fused.prob(HEAVY) == pytest.approx(both.prob(HEAVY))
    assert PRIOR.fused(PRIOR) == PRIOR


def test_belief_that_cannot_be_lifted_has_no_favourable_reading() -> None:
    assert PRIOR.prob_favourable(WeightInterval(at_least_kg=1e6), 0.9) == 0.0
    assert PRIOR.prob_favourable(HEAVY, 0.0) == pytest.approx(1.0)
