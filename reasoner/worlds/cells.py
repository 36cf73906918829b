"""Cells: the finitely many kinds of object that the words of a formula tell apart.

The words cut the types, the colours and the weights into parts. A cell is a choice of one part of each; one more cell
holds the object that does not exist. So an object is one finite variable, a word is a set of its cells, and words that
overlap or exclude each other do so in every formula. Type, colour and weight are independent of each other.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import ColourMeaning, HsvUnion, HsvVolume, Meaning, TypeIs, WeightInterval

Array = NDArray[np.float64]
Asked = Callable[[Meaning], Sequence[float]]  # the probability of a property, for each of some objects
ABSENT: Final = 0  # the cell of the object that does not exist
MOST_COLOURS: Final = 256  # colours that overlap in more ways than this are refused


@dataclass(frozen=True, slots=True)
class Quality:
    """The parts into which words cut one quantity: types, colours or weights.

    Attributes:
        parts: The words that hold of each part; the first part has none.
        asked: The properties whose probabilities are asked for.
        weights: Shape (parts - 1, asked): the probability of each further part is that combination of theirs.
    """

    parts: tuple[frozenset[str], ...]
    asked: tuple[Meaning, ...]
    weights: Array

    def probabilities(self, prob: Asked, count: int) -> Array:
        """Return the probability of each part, shape (count, parts); rounding never makes one negative."""
        asked = np.array([prob(meaning) for meaning in self.asked], dtype=np.float64).reshape(len(self.asked), count)
        found = np.clip((self.weights @ asked).T, 0.0, 1.0)
        total = found.sum(axis=1, keepdims=True)
        return np.concatenate([np.maximum(0.0, 1.0 - total), found / np.maximum(total, 1.0)], axis=1)


@dataclass(frozen=True, slots=True)
class Cells:
    """The cells of the words of a formula.

    Attributes:
        qualities: How the words cut types, colours and weights.
        masks: The cells of each word, as bits of a number.
        count: The number of cells.
    """

    qualities: tuple[Quality, ...]
    masks: Mapping[str, int]
    count: int

    @classmethod
    def of(cls, meanings: Mapping[str, Meaning]) -> "Cells":
        """Return the cells of some words with their meanings."""
        qualities = tuple(_quality(kind, meanings) for kind in (TypeIs, (HsvVolume, HsvUnion), WeightInterval))
        sets = [frozenset[str]()]
        for quality in qualities:
            sets = [words | part for words in sets for part in quality.parts]
        masks = {word: sum(1 << 1 + i for i, words in enumerate(sets) if word in words) for word in sorted(meanings)}
        return cls(qualities, masks, 1 + len(sets))

    @property
    def present(self) -> int:
        """The cells in which the object exists."""
        return (1 << self.count) - 1 - (1 << ABSENT)

    def table(self, exists: Sequence[float], prob: Asked) -> Array:
        """Return the probability of each cell for several objects, shape (n, count).

        Args:
            exists: P(it exists) of each object.
            prob: Function from a property to P(it has it), given that it exists, of each object.
        """
        found = np.array(exists, dtype=np.float64).reshape(-1, 1)
        for quality in self.qualities:
            if len(quality.parts) > 1:
                parts = quality.probabilities(prob, len(exists))
                found = (found[:, :, None] * parts[:, None, :]).reshape(len(exists), -1)
        return np.concatenate([1.0 - np.array(exists, dtype=np.float64).reshape(-1, 1), found], axis=1)


@lru_cache(1024)
def bits(mask: int, count: int) -> Array:
    """Return the bits of a mask as numbers 0 and 1, the lowest first, shape (count,)."""
    return np.array([float(mask >> i & 1) for i in range(count)])


def _quality(kind: type | tuple[type, ...], meanings: Mapping[str, Meaning]) -> Quality:
    own = {word: meaning for word, meaning in sorted(meanings.items()) if isinstance(meaning, kind)}
    if kind is TypeIs:
        asked = tuple(sorted(set(own.values()), key=str))
        groups = [frozenset(word for word in own if own[word] == meaning) for meaning in asked]
        return Quality((frozenset(), *groups), asked, np.eye(len(asked)))
    if kind is WeightInterval:
        return _weights({word: meaning for word, meaning in own.items() if isinstance(meaning, WeightInterval)})
    return _colours({word: meaning for word, meaning in own.items() if isinstance(meaning, HsvVolume | HsvUnion)})


# ---------------------------------------------------------------- weights


def _weights(own: Mapping[str, WeightInterval]) -> Quality:
    """Cut the weights at every end of an interval; parts with no word belong to the first one."""
    if len(set(own.values())) == 1:
        (meaning,) = set(own.values())
        return Quality((frozenset(), frozenset(own)), (meaning,), np.eye(1))
    ends = sorted({meaning.at_least_kg for meaning in own.values()} | {_end(meaning) for meaning in own.values()})
    asked, words = [], []
    for low, high in pairwise(ends):
        inside = frozenset(word for word, each in own.items() if each.at_least_kg <= low and high <= _end(each))
        if inside:
            asked.append(WeightInterval(at_least_kg=low, below_kg=None if high == np.inf else high))
            words.append(inside)
    return Quality((frozenset(), *words), tuple(asked), np.eye(len(asked)))


def _end(interval: WeightInterval) -> float:
    return np.inf if interval.below_kg is None else interval.below_kg


# ---------------------------------------------------------------- colours

_Box = tuple[tuple[float, float], ...]  # hue, saturation, value; none wraps


def _colours(own: Mapping[str, ColourMeaning]) -> Quality:
    """Cut the colours by all words at once.

    The probability of "these words and no others" is, by inclusion and exclusion, a sum over the larger sets of words
    that have a colour in common.
    """
    met: list[tuple[frozenset[str], tuple[_Box, ...]]] = []
    for word, meaning in own.items():
        boxes = _boxes(meaning)
        met += [(frozenset({word}), boxes)] + [
            (words | {word}, common) for words, other in met if (common := _common(other, boxes))
        ]
        if len(met) > MOST_COLOURS:
            raise ValueError(f"{', '.join(own)} overlap in more than {MOST_COLOURS} ways")
    known = {_boxes(meaning): meaning for meaning in own.values()}
    asked = tuple(known.get(boxes) or _meaning(boxes) for _, boxes in met)
    sets = [words for words, _ in met]
    weights = np.array([[(-1.0) ** len(t - s) if s <= t else 0.0 for t in sets] for s in sets])
    return Quality((frozenset(), *sets), asked, weights.reshape(len(sets), len(sets)))


def _boxes(meaning: ColourMeaning) -> tuple[_Box, ...]:
    """Return the boxes of a colour, those cut in two whose hue wraps, sorted."""
    return tuple(
        sorted((hue, box.saturation, box.value) for box in meaning.boxes for hue in _arcs(*box.hue) if hue[0] < hue[1])
    )


def _arcs(low: float, high: float) -> tuple[tuple[float, float], ...]:
    return ((low, high),) if low <= high else ((low, 1.0), (0.0, high))


def _common(some: Iterable[_Box], others: tuple[_Box, ...]) -> tuple[_Box, ...]:
    """Return the boxes that two colours have in common, sorted."""
    found = [
        tuple((max(a[0], b[0]), min(a[1], b[1])) for a, b in zip(one, other, strict=True))
        for one in some
        for other in others
    ]
    return tuple(sorted(box for box in found if all(low < high for low, high in box)))


def _meaning(boxes: tuple[_Box, ...]) -> ColourMeaning:
    volumes = tuple(HsvVolume(hue=hue, saturation=saturation, value=value) for hue, saturation, value in boxes)
    return volumes[0] if len(volumes) == 1 else HsvUnion(boxes=volumes)
