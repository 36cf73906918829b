"""C6: the price of a weighing is the probability of its favourable outcome."""

import math

import numpy as np
import pytest
from kit.papers import HEAVY
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.weight import WeightBelief, WeightSensor
from skolem.traces.messages import GRAVITY


@pytest.mark.parametrize(("sd_newton", "drift_newton"), [(0.4, 0.05), (0.5, 0.2), (0.6, 0.0), (1.5, 0.0)])
def test_the_chance_of_a_favourable_weighing_agrees_with_weighing(sd_newton: float, drift_newton: float) -> None:
    """ "-log p where p is the probability that the action will have the desired outcome": at the scenarios' noise."""
    belief = WeightBelief(math.log(0.3), 0.36, WeightSensor(sd_newton / GRAVITY, drift_newton / GRAVITY))
    draws = Generator(PCG64(SeedSequence([1])))
    kg = np.exp(draws.normal(belief.mean, 0.6, 20_000))
    kg = kg[kg >= 0.4][:2000]
    readings = kg + draws.normal(0.0, math.sqrt(belief.sensor.variance(1)), len(kg))
    often = np.mean([belief.updated(float(reading)).prob(HEAVY) >= 0.9 for reading in readings])
    assert belief.prob_favourable(HEAVY, 0.9) == pytest.approx(often, abs=0.04)
