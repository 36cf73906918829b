"""Bands: any belief inside has the word, and no word that looks can show is refused."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray

from skolem.reasoner import Normal
from skolem.reasoner.planning import gaussians
from skolem.reasoner.planning.bands import Sensor, band, expected
from skolem.reasoner.terms import ANY, Compound, parse_term
from skolem.traces.messages import HsvVolume, WeightInterval

GREEN = HsvVolume(hue=(0.25, 0.45), saturation=(0.4, 1.0), value=(0.2, 1.0))
RED = HsvVolume(hue=(0.95, 0.05), saturation=(0.4, 1.0), value=(0.2, 1.0))
LIME = HsvVolume(hue=(0.211, 0.242), saturation=(0.5, 1.0), value=(0.55, 1.0))
HEAVY = WeightInterval(at_least_kg=0.4)
MIDDLING = WeightInterval(at_least_kg=0.3, below_kg=0.45)
ANYTHING = Normal(np.array([0.5, 0.6, 0.6]), np.diag([0.5, 0.3, 0.3]) ** 2, 1.0)
FINE = np.diag([0.01, 0.03, 0.03]) ** 2
Array = NDArray[np.float64]


def fine(at: Array) -> Array:
    """Return the covariance of a sensor that sees every colour equally well."""
    del at
    return FINE


def camera(sd: float) -> Sensor:
    """Return a sensor of red, green and blue, to first order: it sees little of the hue of what is pale or dark."""

    def sensor(hsv: Array) -> Array:
        _, s, v = hsv.tolist()
        hue = min(math.sqrt(2.0) * sd / (6.0 * max(s, 1e-3) * max(v, sd)), 0.29)
        return np.diag([hue, sd * math.hypot(1.0, 1.0 - s) / max(v, sd), sd]) ** 2

    return sensor


def bounds(found: tuple[object, object, object] | None) -> tuple[Array, Array, Array]:
    """Return mu, Sigma and Delta in units, shape (n,); NaN where there is no bound."""
    assert found is not None
    rows = []
    for bound in found:
        assert isinstance(bound, Compound)
        rows.append([a / 1000 if isinstance(a, int) else math.nan for a in bound.args])
    mu, sd, tol = np.array(rows)
    return mu, sd, tol


@pytest.mark.parametrize("volume", [GREEN, RED, LIME])
@pytest.mark.parametrize("p", [0.5, 0.9, 0.98])
def test_any_belief_inside_a_colour_band_has_the_property(volume: HsvVolume, p: float) -> None:
    mu, sigma, delta = bounds(band(volume, ANYTHING, fine, p))
    rng = np.random.default_rng(1)
    edges = [volume.hue, volume.saturation, volume.value]
    for corner in ([1, 1, 1], [-1, 1, -1], [1, -1, 1], [-1, -1, -1]):
        samples = rng.normal(mu + delta * corner, sigma, size=(40_000, 3))
        width = (edges[0][1] - edges[0][0]) % 1.0
        inside = (samples[:, 0] - edges[0][0]) % 1.0 <= width
        for axis in (1, 2):
            proper = (samples[:, axis] >= 0) & (samples[:, axis] <= 1)
            inside &= (samples[:, axis] >= edges[axis][0]) & (samples[:, axis] <= edges[axis][1]) | ~proper
        assert inside.mean() >= p - 4.0 * math.sqrt(p * (1.0 - p) / len(samples))


@given(st.sampled_from([HEAVY, MIDDLING]), st.floats(-3.0, 1.0), st.floats(0.05, 1.0), st.floats(0.5, 0.98))
def test_any_belief_inside_a_weight_band_has_the_property(
    meaning: WeightInterval, mean: float, sd: float, p: float
) -> None:
    believed = Normal(np.array([mean]), np.array([[sd**2]]), 1.0)
    mu, sigma, delta = bounds(band(meaning, believed, lambda _: np.array([[0.01]]), p))
    low = math.log(meaning.at_least_kg)
    high = math.inf if meaning.below_kg is None else math.log(meaning.below_kg)
    for at in (mu - delta, mu + delta):
        mass = 0.5 * (math.erf((high - at[0]) / sigma[0] / 2**0.5) - math.erf((low - at[0]) / sigma[0] / 2**0.5))
        assert mass >= p - 1e-9


def test_an_axis_without_edges_is_not_bounded() -> None:
    """The hue of a grey cannot be seen: a band that bounded it would never hold."""
    any_hue = HsvVolume(hue=(0.0, 1.0), saturation=(0.4, 1.0), value=(0.2, 1.0))
    found = band(any_hue, ANYTHING, fine, 0.9)
    assert found is not None
    assert [bound.args[0] for bound in found if isinstance(bound, Compound)] == [ANY, ANY, ANY]


def test_the_sensor_counts_at_colours_that_the_word_means_and_not_at_what_is_believed_of_anything() -> None:
    dull = Normal(np.array([0.5, 0.25, 0.35]), np.diag([0.5, 0.3, 0.3]) ** 2, 1.0)
    asked: list[Array] = []

    def sensor(hsv: Array) -> Array:
        asked.append(hsv)
        return FINE

    assert band(LIME, dull, sensor, 0.95) is not None
    (at,) = asked
    assert all(low <= x <= high for x, (low, high) in zip(at, (LIME.hue, LIME.saturation, LIME.value), strict=True))


@pytest.mark.parametrize("times", [1.0, 2.0, 3.0])
@pytest.mark.parametrize("p", [0.9, 0.95, 0.98])
def test_a_narrow_word_is_in_reach_of_a_noisy_camera_by_more_looks(times: float, p: float) -> None:
    """At three times the shipped noise one look has a standard deviation of a whole box of hues."""
    _, sigma, _ = bounds(band(LIME, ANYTHING, camera(0.036 * times), p))
    half = (LIME.hue[1] - LIME.hue[0]) / 2.0
    assert math.erf(half / sigma[0] / 2**0.5) >= p


def test_what_a_narrow_axis_lacks_a_wide_one_gives() -> None:
    """An even share of .9 on three axes is .965 on each: more than the middle of this box of hues has."""
    narrow = HsvVolume(hue=(0.30, 0.34), saturation=(0.2, 1.0), value=(0.2, 1.0))
    known = Normal(np.array([0.5, 0.6, 0.6]), np.diag([0.0102, 0.3, 0.3]) ** 2, 1.0)
    mu, sigma, _ = bounds(band(narrow, known, lambda _: np.diag([100.0, 1e-4, 1e-4]), 0.9))
    assert mu[0] == pytest.approx(0.32)
    even = 2.0 * (0.5 * (1 + math.erf(0.02 / sigma[0] / 2**0.5))) - 1.0
    assert 0.9 < even < 0.9 ** (1 / 3)


def test_a_band_that_holds_already_is_narrowed_until_something_is_left_to_find_out() -> None:
    known = Normal(np.array([0.35, 0.7, 0.6]), np.diag([0.004, 0.02, 0.02]) ** 2, 1.0)
    found = band(GREEN, known, fine, 0.9)
    assert found is not None
    assert not gaussians.holds("colour", known, *found, ANY)


def test_a_sensor_that_shows_nothing_has_no_band() -> None:
    assert band(LIME, ANYTHING, lambda _: np.eye(3) * 25.0, 0.99) is None


@given(st.floats(0.0, 1.0), st.floats(0.01, 0.5), st.integers(0, 1000), st.integers(1, 300))
def test_the_expected_value_lies_within_the_band_and_near_the_mean_if_that_does(
    mean: float, sd: float, mu: int, reach: int
) -> None:
    believed = Normal(np.array([mean]), np.array([[sd**2]]), 1.0)
    (at,) = expected(believed, parse_term(f"v({mu})"), parse_term(f"tol({reach})"))
    assert (mu - reach) / 1000 - 1e-9 <= at <= (mu + reach) / 1000 + 1e-9
    assert (expected(believed, parse_term(f"v({mu})"), ANY) == mu / 1000).all()
    assert (expected(believed, ANY, ANY) == mean).all()
