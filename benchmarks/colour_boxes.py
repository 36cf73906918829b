"""Fitting boxes of hue, saturation and value to named colours, so that every colour is in the box of one word.

Black, grey and white keep the boxes that they had. A word with few colours keeps what its colours and those of other
words leave of its box. The rest is divided by a decision tree (Breiman and others, Classification and Regression Trees,
1984) that grows where it gains most. Hues are counted from `CUT`, where no box of the tree goes through.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Final

import numpy as np
from numpy.typing import NDArray

Box = tuple[int, int, int, int, int, int]  # hue from and to, saturation from and to, value from and to
Array = NDArray[np.float64]
Labels = NDArray[np.intp]
CUT: Final = 345  # degrees: where pink ended and red began
TOP: Final = (360, 100, 100)  # degrees, percent, percent
CUBE: Final[Box] = (0, 360, 0, 100, 0, 100)
COLOURED: Final[Box] = (0, 360, 20, 100, 15, 100)  # neither black nor grey nor white
COLOURLESS: Final[dict[str, Box]] = {
    "black": (0, 360, 0, 100, 0, 15),
    "grey": (0, 360, 0, 20, 15, 80),
    "white": (0, 360, 0, 20, 80, 100),
}
# The words with fewer than ten colours, and the boxes that they had; hues from 0.
FEW: Final[dict[str, Box]] = {"lime": (75, 90, 40, 100, 20, 100), "turquoise": (162, 200, 40, 100, 20, 100)}
WORTH: Final = 10.0  # colours: the weight of such a box beside the colours
WIDTH: Final = 10  # degrees or percent: no box of the tree is narrower, or a sensor could hardly tell that it is hit
STEP: Final = 5  # percent: of the lower ends of such a box
LEAVES: Final = 20  # of the tree; the table shows others


@dataclass(frozen=True, slots=True)
class Named:
    """Colours with names.

    Attributes:
        hsv: Shape (n, 3): hue in degrees from 0, saturation and value in percent.
        word: Shape (n,): index into `words`.
        words: The words.
    """

    hsv: Array
    word: Labels
    words: tuple[str, ...]

    def only(self, chosen: NDArray[np.bool_]) -> "Named":
        """Return some of the colours."""
        return Named(self.hsv[chosen], self.word[chosen], self.words)


Boxes = list[tuple[str, Box]]  # each with its word; hues from CUT


def fit(named: Named, leaves: int = LEAVES) -> Boxes:
    """Return boxes that cover all colours without overlap, merged where two make one."""
    turned = _turned(named)
    few = {word: _core(turned, word, _from_cut(box)) for word, box in FEW.items()}
    rest = turned.only(~np.any([inside(box, turned.hsv) for box in few.values()], axis=0))
    found = _grown(rest, leaves, tuple(few.values()))
    for box in few.values():
        found = [piece for word, leaf in found for piece in _without(word, leaf, box)]
    return _merged(sorted([*COLOURLESS.items(), *few.items(), *found]))


def called(boxes: Boxes, named: Named) -> Labels:
    """Return what the boxes call each colour, shape (n,): the index of the word."""
    hsv, found = _turned(named).hsv, np.full(len(named.word), -1, dtype=np.intp)
    for word, box in boxes:
        found[inside(box, hsv)] = named.words.index(word)
    return found


def fact(word: str, box: Box) -> str:
    """Return the fact of a box, with hues from 0."""
    low, high = box[:2]
    hue = (0, 360) if high - low == TOP[0] else ((low + CUT) % TOP[0], (high + CUT - 1) % TOP[0] + 1)
    return f"colour({', '.join(map(str, (word, *hue, *box[2:])))})."


def inside(box: Box, hsv: Array) -> NDArray[np.bool_]:
    """Return which colours are in a box, shape (n,): lower ends belong to it, of the upper ones only 100 percent."""
    low, high = np.array(box[::2]), np.array(box[1::2])
    return np.asarray(((low <= hsv) & ((hsv < high) | (high == TOP))).all(axis=1))


def _turned(named: Named) -> Named:
    turned = named.hsv.copy()
    turned[:, 0] = (turned[:, 0] - CUT) % TOP[0]
    return Named(turned, named.word, named.words)


def _from_cut(box: Box) -> Box:
    return ((box[0] - CUT) % TOP[0], (box[1] - CUT - 1) % TOP[0] + 1, *box[2:])


def _core(named: Named, word: str, box: Box) -> Box:
    """Return the part of a word's box, its vivid end included, with the greatest score.

    The score is the word's own colours less those of others, plus the part's share of `WORTH` by volume.
    """
    here = named.only(inside(box, named.hsv))
    sign = np.where(here.word == named.words.index(word), 1.0, -1.0)
    hue, saturation, value = here.hsv.T
    lows = np.arange(box[4], 100 - WIDTH + 1, STEP)
    bright = value >= lows[:, None]
    scored = [(float("-inf"), box)]
    for low in range(box[0], box[1] - WIDTH + 1):
        for high in range(low + WIDTH, box[1] + 1):
            for pale in range(box[2], 100 - WIDTH + 1, STEP):
                score = bright @ (sign * ((low <= hue) & (hue < high) & (saturation >= pale)))
                score = score + WORTH * (high - low) * (100 - pale) * (100 - lows) / _volume(box)
                best = int(np.argmax(score))
                scored.append((float(score[best]), (low, high, pale, 100, int(lows[best]), 100)))
    return max(scored, key=lambda item: item[0])[1]


def _volume(box: Box) -> int:
    return (box[1] - box[0]) * (box[3] - box[2]) * (box[5] - box[4])


# ---------------------------------------------------------------- the tree


@dataclass(frozen=True, slots=True)
class _Leaf:
    """A box of the tree, its colours, and the best cut through it: what it gains, axis and place."""

    box: Box
    named: Named
    gain: float
    axis: int
    at: int


def _grown(named: Named, leaves: int, walls: Sequence[Box]) -> Boxes:
    """Return the leaves of a tree; no cut is closer than `WIDTH` to a wall of other boxes, but for the wall's plane."""
    tree = [_leaf(COLOURED, named.only(inside(COLOURED, named.hsv)), walls)]
    while len(tree) < leaves:
        i = max(range(len(tree)), key=lambda i: tree[i].gain)
        leaf = tree[i]
        if leaf.gain <= 0.0:
            break
        low, high = _cut(leaf.box, leaf.axis, leaf.at)
        tree[i : i + 1] = [_leaf(box, leaf.named.only(inside(box, leaf.named.hsv)), walls) for box in (low, high)]
    return [(named.words[int(np.argmax(_counts(leaf.named).sum(axis=0)))], leaf.box) for leaf in tree]


def _leaf(box: Box, named: Named, walls: Sequence[Box]) -> _Leaf:
    counts, best = _counts(named), (1e-9, 0, 0)
    total = counts.sum(axis=0)
    for axis in range(3):
        ends = box[2 * axis], box[2 * axis + 1]
        planes = [*ends, *(wall for other in walls for wall in other[2 * axis : 2 * axis + 2])]
        cuts = [
            at
            for at in range(ends[0] + WIDTH, ends[1] - WIDTH + 1)
            if all(at == plane or abs(at - plane) >= WIDTH for plane in planes)
        ]
        if cuts:
            below = (named.hsv[:, axis] < np.array(cuts)[:, None]).astype(np.float64) @ counts
            gain = _impurity(total) - _impurity(below) - _impurity(total - below)
            k = int(np.argmax(gain))
            if gain[k] > best[0] + 1e-9:
                best = (float(gain[k]), axis, cuts[k])
    return _Leaf(box, named, best[0] if best[2] else 0.0, *best[1:])


def _counts(named: Named) -> Array:
    return np.asarray(named.word[:, None] == np.arange(len(named.words)), dtype=np.float64)


def _impurity(counts: Array) -> Array:
    """Return the number of colours times Gini's impurity, over the last axis."""
    total = counts.sum(axis=-1)
    return np.asarray(total - (counts**2).sum(axis=-1) / np.maximum(total, 1.0))


# ---------------------------------------------------------------- boxes


def _cut(box: Box, axis: int, at: int) -> tuple[Box, Box]:
    return _with(box, axis, box[2 * axis], at), _with(box, axis, at, box[2 * axis + 1])


def _with(box: Box, axis: int, low: int, high: int) -> Box:
    a, b, c = ((low, high) if axis == k else box[2 * k : 2 * k + 2] for k in range(3))
    return (a[0], a[1], b[0], b[1], c[0], c[1])


def _without(word: str, box: Box, hole: Box) -> Boxes:
    """Return what is left of a box, in as few pieces as cutting along the faces of the hole makes."""
    if any(max(box[i], hole[i]) >= min(box[i + 1], hole[i + 1]) for i in (0, 2, 4)):
        return [(word, box)]
    return min((_pieces(word, box, hole, axes) for axes in permutations(range(3))), key=len)


def _pieces(word: str, box: Box, hole: Box, axes: Sequence[int]) -> Boxes:
    found: Boxes = []
    for axis in axes:
        low, high = hole[2 * axis : 2 * axis + 2]
        if box[2 * axis] < low:
            below, box = _cut(box, axis, low)
            found.append((word, below))
        if box[2 * axis + 1] > high:
            box, above = _cut(box, axis, high)
            found.append((word, above))
    return found


def _merged(boxes: Boxes) -> Boxes:
    """Return the boxes with those of one word that share a whole face made one, as long as there are such."""
    for i, (word, box) in enumerate(boxes):
        for j in range(i + 1, len(boxes)):
            joint = _joint(box, boxes[j][1]) if boxes[j][0] == word else None
            if joint is not None:
                return _merged(sorted([*boxes[:i], *boxes[i + 1 : j], *boxes[j + 1 :], (word, joint)]))
    return boxes


def _joint(a: Box, b: Box) -> Box | None:
    differ = [axis for axis in range(3) if a[2 * axis : 2 * axis + 2] != b[2 * axis : 2 * axis + 2]]
    if len(differ) != 1:
        return None
    axis = differ[0]
    first, second = sorted((a, b))
    touch = first[2 * axis + 1] == second[2 * axis]
    return _with(first, axis, first[2 * axis], second[2 * axis + 1]) if touch else None
