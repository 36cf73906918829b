"""Colours and turns of drawn things."""

import math

import pytest

from skolem.traces.scene.shapes import colour_word, point_on, rgba


@pytest.mark.parametrize(
    ("hsv", "word"),
    [
        ((0.33, 0.9, 0.8), "green"),
        ((0.63, 0.9, 0.8), "blue"),
        ((0.99, 0.9, 0.8), "red"),
        ((1.02, 0.9, 0.8), "red"),
        ((0.8, 0.9, 0.8), "violet"),
        ((0.3, 0.1, 0.8), "grey"),
        ((0.3, 0.9, 0.1), "black"),
    ],
)
def test_colours_have_the_names_that_people_use(hsv: tuple[float, float, float], word: str) -> None:
    assert colour_word(hsv) == word


def test_hue_wraps_and_saturation_and_value_are_cut() -> None:
    assert rgba((1.0 / 3.0 - 1.0, 1.2, 1.1)) == (0, 255, 0, 255)


def test_a_point_on_an_object_turns_with_it() -> None:
    assert point_on((1.0, 2.0, 0.5, math.pi / 2.0), (0.3, 0.0, 0.1)) == pytest.approx((1.0, 2.3, 0.6))
