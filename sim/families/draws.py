"""Keyed random streams of a world: equal (family, seed, stream, attempt) give equal draws, whatever else is drawn."""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import TypeVar

from numpy.random import PCG64, Generator, SeedSequence

T = TypeVar("T")
DIGITS = 4  # of every drawn number, since a world is judged by the numbers in its file


class Stream(IntEnum):
    """The purpose of a stream; the numbers are part of a seed's meaning and are never reused."""

    ROOM = 1
    THINGS = 2
    PLACES = 3
    GOAL = 4
    TOLD = 5
    EVENTS = 6


def stream(family: str, seed: int, purpose: Stream, attempt: int) -> Generator:
    """Return the generator of one purpose in one attempt at a world."""
    key = int.from_bytes(family.encode(), "big")
    return Generator(PCG64(SeedSequence([seed, key, int(purpose), attempt])))


def pick(draw: Generator, options: Sequence[T]) -> T:
    """Return one of the options, with equal probabilities."""
    return options[int(draw.integers(len(options)))]


def between(draw: Generator, low: float, high: float) -> float:
    """Return a uniform draw from an interval, rounded to `DIGITS`."""
    return round(float(draw.uniform(low, high)), DIGITS)


def poisson(draw: Generator, mean: float, least: int, most: int) -> tuple[int, float]:
    """Return a draw from a Poisson distribution truncated to two bounds, and the mean of that distribution."""
    numbers = range(least, most + 1)
    shares = [mean**n / math.factorial(n) for n in numbers]
    total = sum(shares)
    drawn = int(draw.choice(len(shares), p=[share / total for share in shares])) + least
    return drawn, round(sum(n * share for n, share in zip(numbers, shares, strict=True)) / total, DIGITS)
