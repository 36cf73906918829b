import colorsys
import math

import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.colour import ColourBelief, ColourSensor
from skolem.traces.messages import HsvBelief, HsvVolume

RED = HsvVolume(hue=(0.95, 0.05), saturation=(0.25, 1.0), value=(0.15, 1.0))
GREEN = HsvVolume(hue=(0.22, 0.45), saturation=(0.25, 1.0), value=(0.15, 1.0))
ANY = HsvVolume(hue=(0.0, 1.0), saturation=(0.0, 1.0), value=(0.0, 1.0))
SENSOR = ColourSensor(gain=0.8, sd_rgb=0.02)
PRIOR = ColourBelief.of(HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1)), SENSOR)


def belief(mean: tuple[float, float, float], sd: tuple[float, float, float]) -> ColourBelief:
    h, s, v = sd
    return ColourBelief(mean, (h * h, s * s, v * v), SENSOR)


def test_hue_wraps_at_red() -> None:
    mean, sd = (0.99, 0.8, 0.6), (0.04, 0.15, 0.2)
    draws = Generator(PCG64(SeedSequence([0]))).normal(mean, sd, size=(400_000, 3))
    draws = draws[((draws[:, 1:] > 0.0) & (draws[:, 1:] < 1.0)).all(axis=1)]
    hue = draws[:, 0] % 1.0
    counted = (((hue >= 0.95) | (hue <= 0.05)) & (draws[:, 1] > 0.25) & (draws[:, 2] > 0.15)).mean()
    assert belief(mean, sd).prob(RED) == pytest.approx(0.7658, abs=1e-4)
    assert belief(mean, sd).prob(RED) == pytest.approx(counted, abs=3e-3)


def test_red_seen_just_above_and_just_below_hue_zero_stays_red() -> None:
    seen = PRIOR
    for hue in (0.985, 0.015, 0.99, 0.01):
        red, green, blue = (0.8 * c for c in colorsys.hsv_to_rgb(hue, 0.9, 0.8))
        seen = seen.updated((red, green, blue))
    assert min(seen.mean[0], 1.0 - seen.mean[0]) < 0.01
    assert seen.prob(RED) > 0.999


def test_anything_has_some_colour() -> None:
    for at in (PRIOR, belief((0.99, 1.0, 0.0), (1.5, 0.01, 3.0))):
        assert at.prob(ANY) == pytest.approx(1.0)


def test_complementary_hues_share_the_mass() -> None:
    rest = RED.model_copy(update={"hue": (0.05, 0.95)})
    whole = RED.model_copy(update={"hue": (0.0, 1.0)})
    assert PRIOR.prob(RED) + PRIOR.prob(rest) == pytest.approx(PRIOR.prob(whole))


def test_shading_is_taken_out() -> None:
    once = PRIOR.updated((0.8 * 0.1, 0.8 * 0.7, 0.8 * 0.1))
    assert once.mean == pytest.approx(colorsys.rgb_to_hsv(0.1, 0.7, 0.1), abs=0.01)
    assert once.seen
    assert once.prob(GREEN) > 0.99


def test_hue_of_a_grey_says_nothing() -> None:
    grey = PRIOR.updated((0.4, 0.4, 0.401))
    assert grey.variance[0] > 0.4 * PRIOR.variance[0]
    assert grey.variance[1] < 0.1 * PRIOR.variance[1]


@pytest.mark.parametrize("saturation", [0.9, 0.3])
def test_noise_of_an_observed_colour_is_what_noise_of_its_channels_makes(saturation: float) -> None:
    draws = Generator(PCG64(SeedSequence([2])))
    sensor = ColourSensor(gain=1.0, sd_rgb=0.01)
    pixels = np.array(colorsys.hsv_to_rgb(0.33, saturation, 0.6)) + draws.normal(size=(3000, 3)) * 0.01
    observed = np.array([colorsys.rgb_to_hsv(*pixel) for pixel in pixels.clip(0, 1).tolist()])
    assert observed.std(axis=0) == pytest.approx(np.sqrt(sensor.variance(saturation, 0.6)), rel=0.25)


def test_truncated_gaussian_stays_one_under_observation() -> None:
    """The posterior of a truncated Gaussian has the parent that the Kalman update gives."""
    prior, z, r = belief((0.3, 0.85, 0.5), (0.05, 0.2, 0.1)), 0.93, SENSOR.variance(0.93, 0.5)[1]
    x = np.linspace(0, 1, 20001)
    density = np.exp(-0.5 * (x - 0.85) ** 2 / 0.04 - 0.5 * (x - z) ** 2 / r)
    exact = density[x >= 0.9].sum() / density.sum()
    red, green, blue = (0.8 * c for c in colorsys.hsv_to_rgb(0.3, z, 0.5))
    volume = HsvVolume(hue=(0.0, 1.0), saturation=(0.9, 1.0), value=(0.0, 1.0))
    assert prior.updated((red, green, blue)).prob(volume) == pytest.approx(exact, abs=5e-4)


@pytest.mark.parametrize("p", [0.5, 0.9, 0.95])
@pytest.mark.parametrize("volume", [GREEN, RED], ids=["green", "red"])
def test_chance_of_a_favourable_look_agrees_with_looking(volume: HsvVolume, p: float) -> None:
    draws = Generator(PCG64(SeedSequence([3])))
    start = belief((0.4, 0.6, 0.6), (0.25, 0.2, 0.2))
    low, high = volume.hue
    colours = draws.normal(start.mean, np.sqrt(start.variance), size=(20000, 3))
    hue = (colours[:, 0] - low) % 1.0 < (high - low) % 1.0
    kept = colours[hue & (colours[:, 1:] > (0.25, 0.15)).all(axis=1) & (colours[:, 1:] < 1.0).all(axis=1)][:600]
    likely = np.sqrt(SENSOR.variance(min(max(start.mean[1], 0.25), 1.0), start.mean[2]))
    lifted = 0
    for colour in kept:
        z = colour + draws.normal(size=3) * likely
        gain = np.array(start.variance) / (np.array(start.variance) + likely**2)
        off = np.array([math.remainder(z[0] - start.mean[0], 1.0), *(np.clip(z[1:], 0, 1) - start.mean[1:])])
        h, s, v = (np.array(start.mean) + gain * off).tolist()
        a, b, c = np.sqrt((1.0 - gain) * start.variance).tolist()
        lifted += belief((h, s, v), (a, b, c)).prob(volume) >= p
    assert start.prob_favourable(volume, p) == pytest.approx(lifted / len(kept), abs=0.06)


def test_belief_that_cannot_be_lifted_has_no_favourable_look() -> None:
    assert PRIOR.prob_favourable(GREEN, 1.0) == 0.0
    assert PRIOR.prob_favourable(GREEN, 0.0) == pytest.approx(1.0)
