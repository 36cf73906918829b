import colorsys
from functools import cache

import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from skolem.estimation.colour import ColourBelief, ColourSensor
from skolem.traces.messages import HsvBelief, HsvVolume

Array = NDArray[np.float64]
RED = HsvVolume(hue=(0.95, 0.05), saturation=(0.25, 1.0), value=(0.15, 1.0))
GREEN = HsvVolume(hue=(0.22, 0.45), saturation=(0.25, 1.0), value=(0.15, 1.0))
ANY = HsvVolume(hue=(0.0, 1.0), saturation=(0.0, 1.0), value=(0.0, 1.0))
BOXES = (  # degrees, percent: those of the vocabulary
    ((0, 360), (0, 100), (0, 15)),
    ((0, 360), (0, 20), (15, 80)),
    ((345, 15), (40, 100), (20, 100)),
    ((15, 45), (30, 100), (15, 60)),
    ((90, 162), (40, 100), (20, 100)),
    ((200, 260), (40, 100), (20, 100)),
)
WORDS = tuple(
    HsvVolume(hue=(h / 360, i / 360), saturation=(s / 100, t / 100), value=(v / 100, w / 100))
    for (h, i), (s, t), (v, w) in BOXES
)
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
    hue = seen.matched()[0][0]
    assert min(hue, 1.0 - hue) < 0.01
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
    assert once.matched()[0] == pytest.approx(colorsys.rgb_to_hsv(0.1, 0.7, 0.1), abs=0.02)
    assert once.seen
    assert once.prob(GREEN) > 0.99


def test_hue_of_a_grey_says_nothing() -> None:
    grey = PRIOR.updated((0.4, 0.4, 0.401))
    hue, saturation, _ = grey.matched()[1]
    assert hue > 0.5 / 12.0  # of a uniform one
    assert saturation < 0.1 * PRIOR.variance[1]


@pytest.mark.parametrize("saturation", [0.9, 0.3])
def test_noise_of_an_observed_colour_is_what_noise_of_its_channels_makes(saturation: float) -> None:
    draws = Generator(PCG64(SeedSequence([2])))
    sensor = ColourSensor(gain=1.0, sd_rgb=0.01)
    pixels = np.array(colorsys.hsv_to_rgb(0.33, saturation, 0.6)) + draws.normal(size=(3000, 3)) * 0.01
    observed = np.array([colorsys.rgb_to_hsv(*pixel) for pixel in pixels.clip(0, 1).tolist()])
    assert observed.std(axis=0) == pytest.approx(np.sqrt(sensor.variance(saturation, 0.6)), rel=0.25)


def drawn(at: ColourBelief, count: int, seed: int) -> Array:
    """Return colours of a belief that was not updated, HSV, shape (n, 3) with n near `count`."""
    draws = Generator(PCG64(SeedSequence([seed]))).normal(at.mean, np.sqrt(at.variance), size=(count, 3))
    draws = draws[((draws[:, 1:] >= 0.0) & (draws[:, 1:] <= 1.0)).all(axis=1)]
    return np.column_stack([draws[:, 0] % 1.0, draws[:, 1:]])


def rgb_of(hsv: Array) -> Array:
    """Return RGB of colours, shape (n, 3)."""
    h, s, v = hsv.T
    k = (np.array([[5.0], [3.0], [1.0]]) + 6.0 * h) % 6.0
    return np.asarray((v - v * s * np.clip(np.minimum(k, 4.0 - k), 0.0, 1.0)).T)


def inside(volume: HsvVolume, hsv: Array) -> NDArray[np.bool_]:
    return np.array([volume.contains((h, s, v)) for h, s, v in hsv.tolist()])


WIDE = ColourBelief((0.5, 0.6, 0.6), (0.25, 0.09, 0.09), ColourSensor(gain=0.8, sd_rgb=0.08))


@cache
def sampled() -> tuple[Array, tuple[tuple[HsvVolume, NDArray[np.bool_]], ...]]:
    """Return colours drawn from a wide belief, and which of them lie in each of three volumes."""
    colours = drawn(WIDE, 200_000, 4)
    volumes = (RED, GREEN, ANY.model_copy(update={"saturation": (0.0, 0.25)}))
    return colours, tuple((volume, inside(volume, colours)) for volume in volumes)


@pytest.mark.parametrize("rgb", [(0.1, 0.6, 0.2), (0.3, 0.32, 0.28), (0.05, 0.03, 0.06), (0.7, 0.6, 0.72)])
@pytest.mark.parametrize("looks", [1, 4])
def test_belief_after_looks_is_that_of_bayes_rule_over_sampled_colours(rgb: tuple[float, ...], looks: int) -> None:
    colours, volumes = sampled()
    errors = Generator(PCG64(SeedSequence([5]))).normal(size=(looks, 3)) * 0.02
    seen, log_weight = WIDE, np.zeros(len(colours))
    for z in (np.array(rgb) + errors).tolist():
        seen = seen.updated((max(z[0], 1e-3), max(z[1], 1e-3), max(z[2], 1e-3)))
        log_weight -= 0.5 * ((0.8 * rgb_of(colours) - np.maximum(z, 1e-3)) ** 2).sum(axis=1) / 0.08**2
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    for volume, within in volumes:
        assert seen.prob(volume) == pytest.approx(weight @ within, abs=0.02)
    assert seen.matched()[0][1:] == pytest.approx(weight @ colours[:, 1:], abs=0.01)


def test_channel_read_as_nothing_is_not_taken_for_exactly_nothing() -> None:
    """A dark channel's readings end at 0; their mean lies above the truth, and the belief must not follow it."""
    truth, sensor = np.array([0.30, 0.02, 0.02]), ColourSensor(gain=1.0, sd_rgb=0.06)
    seen, plain = ColourBelief((0.5, 0.6, 0.6), (0.25, 0.09, 0.09), sensor), []
    for error in Generator(PCG64(SeedSequence([6]))).normal(size=(40, 3)) * 0.06:
        z = np.clip(truth + error, 0.0, 1.0).tolist()
        plain.append(z)
        seen = seen.updated((z[0], z[1], z[2]))
    assert np.mean(plain, axis=0)[1] > truth[1] + 0.01
    assert seen.rgb == pytest.approx(truth, abs=0.02)


@pytest.mark.parametrize("times", [1.0, 2.0, 3.0])
def test_what_is_claimed_of_a_word_is_how_often_it_is_true(times: float) -> None:
    """Saturated, dark, grey and pastel colours at 1 to 3 times the shipped scenarios' noise, after 1 to 4 looks."""
    sensor = ColourSensor(gain=0.83, sd_rgb=0.03 * times)
    draws = Generator(PCG64(SeedSequence([7, int(times)])))
    low, high = np.array([0.0, 0.0, 0.02]), np.array([1.0, 1.0, 1.0])
    claims: list[float] = []
    truths: list[bool] = []
    for _ in range(150):
        hsv = draws.uniform(low, high)
        seen, rgb = ColourBelief((0.5, 0.6, 0.6), (0.25, 0.09, 0.09), sensor), rgb_of(hsv[None])[0]
        for _ in range(int(draws.integers(1, 5))):
            z = np.clip(0.83 * rgb + draws.normal(size=3) * sensor.sd_rgb, 0.0, 1.0).tolist()
            seen = seen.updated((z[0], z[1], z[2]))
        claims += [seen.prob(volume) for volume in WORDS]
        truths += inside_each(hsv)
    claimed, true = np.array(claims), np.array(truths)
    bins = np.minimum((10.0 * claimed).astype(int), 9)
    off = [abs(claimed[bins == b].sum() - true[bins == b].sum()) for b in range(10)]
    assert sum(off) / len(claimed) < 0.03
    sure = claimed >= 0.9
    assert true[sure].mean() > claimed[sure].mean() - 3.0 * (0.1 / sure.sum()) ** 0.5 * 0.5 - 0.01


def inside_each(hsv: Array) -> list[bool]:
    return [volume.contains((hsv[0], hsv[1], hsv[2])) for volume in WORDS]


@pytest.mark.parametrize("p", [0.5, 0.9, 0.95])
@pytest.mark.parametrize("volume", [GREEN, RED], ids=["green", "red"])
def test_chance_of_a_favourable_look_agrees_with_looking(volume: HsvVolume, p: float) -> None:
    sensor = ColourSensor(gain=0.8, sd_rgb=0.08)
    start = ColourBelief((0.4, 0.6, 0.6), (0.0625, 0.04, 0.04), sensor)
    colours = drawn(start, 8000, 3)
    kept = colours[inside(volume, colours)][:250]
    errors = Generator(PCG64(SeedSequence([8]))).normal(size=(len(kept), 3)) * sensor.sd_rgb
    readings = np.clip(0.8 * rgb_of(kept) + errors, 0.0, 1.0).tolist()
    lifted = np.mean([start.updated((r, g, b)).prob(volume) >= p for r, g, b in readings])
    assert start.prob_favourable(volume, p) == pytest.approx(lifted, abs=0.15)


def test_belief_that_cannot_be_lifted_has_no_favourable_look() -> None:
    assert PRIOR.prob_favourable(ANY.model_copy(update={"value": (0.5, 0.501)}), 0.9) == 0.0
    assert PRIOR.prob_favourable(GREEN, 0.0) == pytest.approx(1.0)
