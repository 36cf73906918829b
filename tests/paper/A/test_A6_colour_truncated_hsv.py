"""A6: a colour is a truncated Gaussian in hue, saturation and value."""

import pytest
from kit.papers import colour, green
from kit.searches import table_prior

from skolem.estimation.belief import Belief
from skolem.traces.messages import HsvBelief, HsvVolume, PriorObject

Triple = tuple[float, float, float]
ALL = (0.0, 1.0)


def coloured(mean: Triple, sd: Triple) -> Belief:
    """Return a belief in one object whose prior states a colour."""
    h, s, v = sd
    thing = PriorObject(
        anchor="o",
        type={"soda": 1.0},
        world_T_object=(1.0, 0.0, 0.7, 0.0),
        sd_xy_m=0.01,
        sd_theta_rad=1.0,
        colour=HsvBelief(mean=mean, variance=(h * h, s * s, v * v)),
    )
    return Belief(table_prior(objects=[thing]))


def test_a_colour_word_is_the_mass_in_a_box() -> None:
    """ "Truncated Gaussian in hue-saturation-value space." """
    inside, outside = (coloured((hue, 0.8, 0.8), (0.01, 0.05, 0.05)) for hue in (0.35, 0.63))
    assert inside.prob_property("o", green()) > 0.999
    assert outside.prob_property("o", green()) < 1e-9
    last = max(box.hue[1] for box in green().boxes)
    edge = coloured((last, 0.8, 0.8), (0.01, 0.02, 0.02))
    assert edge.prob_property("o", green()) == pytest.approx(0.5, abs=1e-6)


def test_no_mass_lies_beyond_the_range_of_saturation_and_value() -> None:
    """ "Truncated": the mass outside of 0..1 is 0, that inside is 1."""
    wide = coloured((0.35, 0.95, 0.05), (0.05, 0.4, 0.4))
    beyond = HsvVolume(hue=ALL, saturation=(1.0, 2.0), value=ALL)
    below = HsvVolume(hue=ALL, saturation=ALL, value=(-1.0, 0.0))
    assert wide.prob_property("o", beyond) == wide.prob_property("o", below) == 0.0
    assert wide.prob_property("o", HsvVolume(hue=ALL, saturation=ALL, value=ALL)) == pytest.approx(1.0)
    halves = [HsvVolume(hue=ALL, saturation=half, value=ALL) for half in ((0.0, 0.6), (0.6, 1.0))]
    assert sum(wide.prob_property("o", half) for half in halves) == pytest.approx(1.0)


@pytest.mark.parametrize("hue", [0.98, 0.0, 0.01])
def test_red_goes_on_through_hue_zero(hue: float) -> None:
    """ "The set of colors defined to be red." """
    red = colour("red")
    assert any(box.hue[0] > box.hue[1] for box in red.boxes)
    assert coloured((hue, 0.9, 0.8), (0.006, 0.05, 0.05)).prob_property("o", red) > 0.99


def test_hues_on_either_side_of_zero_average_to_red_and_not_to_cyan() -> None:
    """ "Truncated Gaussian": hue is an angle, of which nothing is cut off."""
    red = colour("red")
    assert coloured((0.99, 0.9, 0.8), (0.02, 0.05, 0.05)).prob_property("o", red) > 0.9
    assert coloured((0.5, 0.9, 0.8), (0.02, 0.05, 0.05)).prob_property("o", red) < 1e-9
