"""B9: a colour word is integrated over the set of colours so called."""

import math

import numpy as np
import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, green, seen_as
from numpy.random import PCG64, Generator, SeedSequence
from scipy.integrate import quad

from skolem.traces.messages import HsvBelief, HsvVolume

Interval = tuple[float, float]


def believed_colour(rgb: tuple[float, float, float]) -> tuple[HsvBelief, float]:
    """Return the colour of a can after one noisy look, and what the belief says of green."""
    robot = Handler(at_five_percent([can()], colour_sd_rgb=0.08))
    robot.see(seen_as(STANDS, rgb=rgb))
    return robot.belief.snapshot(0).objects["can1"].colour, robot.belief.prob_property("can1", green())


def axis(mean: float, variance: float, span: Interval, turns: int) -> float:
    """Return the mass of a Gaussian in an interval by quadrature: wrapped around 1, or truncated to 0..1."""

    def density(x: float) -> float:
        return sum(
            math.exp(-((x + turn - mean) ** 2) / (2.0 * variance)) for turn in range(-turns, turns + 1)
        ) / math.sqrt(math.tau * variance)

    inside = quad(density, *span, points=[mean % 1.0])[0]
    return float(inside / quad(density, 0.0, 1.0, points=[mean % 1.0])[0])


@pytest.mark.parametrize("rgb", [(0.08, 0.64, 0.08), (0.3, 0.6, 0.1), (0.3, 0.42, 0.3), (0.1, 0.3, 0.25)])
def test_green_is_the_integral_by_quadrature(rgb: tuple[float, float, float]) -> None:
    """ "Finding the distribution on the color and integrating the probability over the set of colors." """
    colour, said = believed_colour(rgb)
    volume: HsvVolume = green()
    spans = (volume.hue, volume.saturation, volume.value)
    parts = [axis(m, v, s, t) for m, v, s, t in zip(colour.mean, colour.variance, spans, (3, 0, 0), strict=True)]
    assert said == pytest.approx(math.prod(parts), abs=1e-6)
    assert 0.0 <= said <= 1.0


@pytest.mark.parametrize("rgb", [(0.3, 0.6, 0.1), (0.1, 0.3, 0.25)])
def test_green_is_the_share_of_sampled_colours(rgb: tuple[float, float, float]) -> None:
    """ "Integrating the probability over the set of colors defined to be" green, by Monte Carlo."""
    colour, said = believed_colour(rgb)
    draws = Generator(PCG64(SeedSequence([7]))).normal(colour.mean, np.sqrt(colour.variance), size=(400_000, 3))
    draws = draws[((draws[:, 1:] >= 0.0) & (draws[:, 1:] <= 1.0)).all(axis=1)]
    h, s, v = draws[:, 0] % 1.0, draws[:, 1], draws[:, 2]
    volume = green()
    inside = (h >= volume.hue[0]) & (h <= volume.hue[1]) & (s >= volume.saturation[0]) & (s <= volume.saturation[1])
    inside &= (v >= volume.value[0]) & (v <= volume.value[1])
    assert said == pytest.approx(inside.mean(), abs=4.0 * 0.5 / math.sqrt(len(draws)))
