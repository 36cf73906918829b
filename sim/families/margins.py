"""Margins: distances of colours from the border of their word, in standard deviations of one reading."""

import colorsys
import itertools
import math

from skolem.sim.families.words import Hsv, Words

RGB_SD = 0.03 / 0.83  # of a reading, in terms of the true colour: the sensor's sd divided by the shading
WEIGHT_SD_KG = 0.4 / 9.81  # of one weighing
MAX_SD = 5.0  # greatest margin that is computed
STEP_SD = 0.5
_CORNERS = [d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)]
DIRECTIONS = tuple(tuple(c / math.hypot(*d) for c in d) for d in _CORNERS)


def colour_margin(hsv: Hsv, words: Words) -> float:
    """Return the radius in RGB within which all colours have the same word as this one, or none if it has none."""
    if hsv not in words.margins:
        words.margins[hsv] = _margin(hsv, words)
    return words.margins[hsv]


def _margin(hsv: Hsv, words: Words) -> float:
    word, rgb = words.colour_of(hsv), colorsys.hsv_to_rgb(*hsv)
    for i in range(1, round(MAX_SD / STEP_SD) + 1):
        radius = i * STEP_SD * RGB_SD
        for direction in DIRECTIONS:
            moved = [c + radius * d for c, d in zip(rgb, direction, strict=True)]
            if min(moved) >= 0.0 and max(moved) <= 1.0 and not _called(colorsys.rgb_to_hsv(*moved), word, words):
                return (i - 1) * STEP_SD
    return MAX_SD


def _called(hsv: Hsv, word: str | None, words: Words) -> bool:
    """Return whether a colour has a word; with None, whether it has no word."""
    return words.colour_of(hsv) is None if word is None else words.colours[word].contains(hsv)
