"""Types, colours and weights of objects, drawn from the same distributions as the prior states."""

import math

from numpy.random import Generator

from skolem.sim.families.draws import DIGITS, between, pick
from skolem.sim.families.margins import WEIGHT_SD_KG, colour_margin
from skolem.sim.families.ranges import Variant
from skolem.sim.families.words import Hsv, Words

MEDIAN_KG, SIGMA = 0.3, 0.6  # of weights
KG = (0.05, 1.2)  # weights outside are drawn again
CONFIDENT = (0.8, 0.9, 0.95)  # share of the likeliest type
TALL, SHORT = ("bottle", "carton"), ("can", "soda")
ROUND = ("bottle", "can", "soda")
STRANGERS = {"bottle": 0.15, "can": 0.2, "carton": 0.15, "soda": 0.5}  # types of objects that are not in the prior
CROWD = {"can": 0.1, "soda": 0.9}
MOST_DRAWS = 10_000  # of one colour or weight; palettes and margins of the families make more draws unlikely


def shares_around(draw: Generator, likeliest: tuple[str, ...], others: tuple[str, ...]) -> dict[str, float]:
    """Return the prior of a type: a likely type and one or two others, with their shares."""
    first = pick(draw, likeliest)
    rest = [kind for kind in others if kind != first]
    share = pick(draw, CONFIDENT)
    count = min(int(draw.integers(1, 3)), len(rest))
    chosen = sorted(str(kind) for kind in draw.choice(rest, count, replace=False))
    return {first: share} | {kind: round((1.0 - share) / count, DIGITS) for kind in chosen}


def type_of(draw: Generator, shares: dict[str, float]) -> str:
    """Return a type, drawn from its shares."""
    kinds = sorted(shares)
    return kinds[int(draw.choice(len(kinds), p=[shares[kind] for kind in kinds]))]


def colour(draw: Generator, variant: Variant, words: Words) -> Hsv:
    """Return a colour of the palette whose margin to the border of its word is in the variant's range."""
    palette = variant.palette
    low, high = variant.margin_sd
    for _ in range(MOST_DRAWS):
        hue, saturation, value = (between(draw, *span) for span in (palette.hue, palette.saturation, palette.value))
        if words.colour_of((hue, saturation, value)) and low <= colour_margin((hue, saturation, value), words) <= high:
            return hue, saturation, value
    raise AssertionError(f"no colour of the palette {palette} has a margin of {low:g} to {high:g} deviations")


def weight(draw: Generator, variant: Variant, words: Words) -> float:
    """Return a mass, kg, whose margin to the borders of words is in the variant's range."""
    low, high = variant.margin_sd
    for _ in range(MOST_DRAWS):
        kg = round(MEDIAN_KG * math.exp(SIGMA * float(draw.standard_normal())), DIGITS)
        away = min((abs(kg - border) for border in words.weight_borders()), default=math.inf)
        if KG[0] <= kg <= KG[1] and low <= away / WEIGHT_SD_KG <= high:
            return kg
    raise AssertionError(f"no mass has a margin of {low:g} to {high:g} deviations")
