"""Integrals over points: intervals that hold, points that repeat, and rows that are counted."""

import numpy as np
import pytest
from numpy.random import PCG64, Generator, SeedSequence
from scipy.special import ndtr, ndtri

from skolem.reasoner.worlds.sampling import FIRST, LEVEL, MOST, SHIFTS, arrangements, interval, uniforms

BELIEFS = 1000
NARROW = 0.004  # half the width of an interval at the limit


def event(number: int, draw: Generator, dimension: int, points: int) -> tuple[bool, float]:
    """Return whether the interval contains the probability of an event that is known in closed form, and its width."""
    u = uniforms(f"goal {number}", dimension, 0, points // SHIFTS)
    z = ndtri(u)
    match number % 3:
        case 0:  # a Gaussian below a bound
            along = draw.standard_normal(dimension)
            bound = 1.5 * draw.standard_normal()
            truth, p = np.asarray(z @ along <= bound * np.linalg.norm(along)), float(ndtr(bound))
        case 1:  # at least one of several independent events, most of them rare
            each = 0.3 * draw.random(dimension) ** 3
            truth, p = np.asarray((u < each).any(axis=1)), 1.0 - float(np.prod(1.0 - each))
        case _:  # a Gaussian in a box
            half = 3.0 * draw.random(dimension)
            truth, p = np.asarray((np.abs(z) <= half).all(axis=1)), float(np.prod(2.0 * ndtr(half) - 1.0))
    low, high = interval(truth.reshape(SHIFTS, -1).mean(axis=1), points)
    return low <= p <= high, high - low


def test_intervals_contain_known_probabilities_as_often_as_they_claim() -> None:
    draw = Generator(PCG64(SeedSequence([1])))
    missed = sum(not event(number, draw, 1 + number % 12, FIRST)[0] for number in range(BELIEFS))
    assert missed <= 5  # a chance of 6e-4 if each misses with 1 - LEVEL
    assert LEVEL == 0.999


@pytest.mark.parametrize("number", range(6))
def test_intervals_are_narrow_at_the_limit_of_points(number: int) -> None:
    contained, width = event(number, Generator(PCG64(SeedSequence([number]))), 12, MOST)
    assert contained
    assert width <= 2.0 * NARROW


def test_points_repeat_and_those_of_other_goals_differ() -> None:
    once = uniforms("a goal", 3, 0, 128)
    uniforms.cache_clear()
    assert (uniforms("a goal", 3, 0, 128) == once).all()
    assert not (uniforms("another goal", 3, 0, 128) == once).any()


def test_more_points_go_on_where_the_first_ones_end() -> None:
    """Each shift fills the intervals of a coordinate evenly, first with one point each, then with two."""
    both = [uniforms("a goal", 2, *ends).reshape(SHIFTS, 128, 2) for ends in ((0, 128), (128, 256))]
    for count, points in ((1, both[0]), (2, np.concatenate(both, axis=1))):
        cells = np.floor(points[:, :, 0] * 128).astype(int)
        assert all((np.bincount(row, minlength=128) == count).all() for row in cells)


def test_rows_are_counted_by_what_they_show() -> None:
    draw = Generator(PCG64(SeedSequence([2])))
    for relations in (0, 3, 64, 130):
        truth = draw.random((50, relations)) < 0.5
        truth[25:] = truth[:25]
        rows, number = arrangements(truth)
        assert (rows[number] == truth).all()
        assert len(rows) <= 25
