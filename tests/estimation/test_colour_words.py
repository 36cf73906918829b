"""Colour words of several boxes: what a belief about a colour says of them, beside drawn colours and looks."""

import colorsys
import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.random import PCG64, Generator, SeedSequence

from skolem.estimation.belief import Gaussian
from skolem.estimation.colour import ColourBelief, ColourSensor
from skolem.reasoner.planning import bands
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import ANY, Compound
from skolem.traces.messages import ColourMeaning, HsvBelief, HsvVolume

MEANINGS = Rulebook.load(Queries).vocabulary.meanings
COLOURS = {word: meaning for word, meaning in MEANINGS.items() if isinstance(meaning, ColourMeaning)}
SENSOR = ColourSensor(gain=0.83, sd_rgb=0.03)
DRAWS = 20_000
BELIEFS = st.builds(
    lambda mean, sd: ColourBelief.of(HsvBelief(mean=mean, variance=(sd[0] ** 2, sd[1] ** 2, sd[2] ** 2)), SENSOR),
    st.tuples(*[st.floats(0.0, 1.0)] * 3),
    st.tuples(*[st.floats(0.01, 0.5)] * 3),
)


def drawn(belief: ColourBelief, count: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return colours of a belief, shape (n, 3), by rejecting those out of range."""
    draws = Generator(PCG64(SeedSequence([11]))).normal(belief.mean, np.sqrt(belief.variance), size=(8 * count, 3))
    draws[:, 0] %= 1.0
    return draws[((draws[:, 1:] >= 0.0) & (draws[:, 1:] <= 1.0)).all(axis=1)][:count]


@settings(max_examples=15, deadline=None)
@given(BELIEFS, st.sampled_from(sorted(COLOURS)))
def test_a_word_is_as_likely_as_drawn_colours_have_it(belief: ColourBelief, word: str) -> None:
    colours = drawn(belief, DRAWS)
    share = np.mean([COLOURS[word].contains((h, s, v)) for h, s, v in colours.tolist()])
    assert belief.prob(COLOURS[word]) == pytest.approx(share, abs=5.0 * 0.5 / math.sqrt(len(colours)))


@given(BELIEFS)
def test_the_words_share_out_all_of_a_belief(belief: ColourBelief) -> None:
    assert sum(belief.prob(meaning) for meaning in COLOURS.values()) == pytest.approx(1.0, abs=1e-6)


@settings(max_examples=30, deadline=None)
@given(BELIEFS, st.sampled_from(sorted(COLOURS)), st.floats(0.5, 0.98))
def test_a_belief_inside_the_band_has_the_word(belief: ColourBelief, word: str, p: float) -> None:
    """Whichever box the band takes, at each of its corners."""
    found = band(belief, COLOURS[word], p)
    if found is None:
        return
    bounds = [[0 if each == ANY else each for each in bound.args] for bound in found]
    mean, sd, reach = np.array(bounds, dtype=np.float64) / 1000.0
    for corner in np.ndindex(2, 2, 2):
        at = mean + reach * (2 * np.array(corner) - 1)
        clipped = (float(at[0]), *np.clip(at[1:], 0.0, 1.0).tolist())
        inside = ColourBelief((clipped[0], clipped[1], clipped[2]), tuple((sd**2).tolist()), SENSOR)
        assert inside.prob(COLOURS[word]) >= p - 1e-3


@pytest.mark.parametrize(("mean", "index"), [((0.33, 0.8, 0.8), 3), ((0.19, 0.7, 0.8), 0), ((0.4, 0.5, 0.3), 3)])
def test_the_band_is_of_the_box_that_the_belief_is_likeliest_in(mean: tuple[float, float, float], index: int) -> None:
    green = COLOURS["green"]
    box = green.boxes[index]
    found = band(ColourBelief(mean, (4e-4, 1e-3, 1e-3), SENSOR), green, 0.9)
    assert found is not None
    h, s, v = (float(each) / 1000.0 for each in found[0].args if isinstance(each, int))
    assert box.contains((h, s, v))


def test_a_box_too_narrow_for_the_sensor_leaves_the_band_to_another() -> None:
    narrow = HsvVolume(hue=(0.300, 0.304), saturation=(0.0, 1.0), value=(0.0, 1.0))
    wide = HsvVolume(hue=(0.304, 0.6), saturation=(0.0, 1.0), value=(0.0, 1.0))
    belief = ColourBelief((0.302, 0.5, 0.5), (1e-6, 1e-2, 1e-2), ColourSensor(gain=0.83, sd_rgb=0.2))
    assert band(belief, narrow, 0.99) is None
    union = COLOURS["green"].model_copy(update={"boxes": (narrow, wide)})
    assert band(belief, union, 0.99) == band(belief, wide, 0.99) is not None


@pytest.mark.parametrize("word", ["green", "brown", "pink"])
def test_looks_lift_the_belief_as_often_as_said(word: str) -> None:
    meaning, p = COLOURS[word], 0.9
    belief = ColourBelief((0.5, 0.6, 0.6), (0.25, 0.09, 0.09), SENSOR)
    colours = [hsv for hsv in drawn(belief, 8_000).tolist() if meaning.contains(tuple(hsv))]
    noise = Generator(PCG64(SeedSequence([12]))).normal(0.0, SENSOR.sd_rgb, size=(len(colours), 3))
    seen = np.clip(SENSOR.gain * np.array([colorsys.hsv_to_rgb(*hsv) for hsv in colours]) + noise, 0.0, 1.0)
    after = [belief.updated(tuple(rgb)).prob(meaning) for rgb in seen.tolist()]
    share = np.mean(np.array(after) >= p)
    said = belief.prob_favourable(meaning, p)
    assert said == pytest.approx(share, abs=0.1)


def band(belief: ColourBelief, meaning: ColourMeaning, p: float) -> tuple[Compound, Compound, Compound] | None:
    believed = Gaussian(np.array(belief.mean), np.diag(belief.variance), 1.0)
    found = bands.band(meaning, believed, lambda at: np.diag(belief.sensor.variance(*at.tolist()[1:])), p)
    if found is None:
        return None
    mu, sigma, delta = found
    assert isinstance(mu, Compound)
    assert isinstance(sigma, Compound)
    assert isinstance(delta, Compound)
    return mu, sigma, delta
