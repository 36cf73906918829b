"""Positions of labels in a picture: near their objects, without covering one another or what is to be seen.

All units are pixels, columns to the right and rows downwards. One label after another takes the position with the least
cost, so the first label in the list has the first choice.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Rectangle = tuple[float, float, float, float]  # left, top, right, bottom
Seen = tuple[
    float, float, float, float, float
]  # a rectangle, and its worth: the distance a label moves to keep it free
Boxes = NDArray[np.float64]  # rectangles, shape (n, 4), or `Seen`, shape (n, 5)
LETTER_PX, MARGIN_PX, HEIGHT_PX = 6.4, 12.0, 23.0  # the viewer's text: width of a letter, both margins, height
_GAP_PX: Final = 8.0  # least gap between two labels
_STEP_PX: Final = (13.0, 9.0)  # between positions to try, sideways and upwards
_REACH: Final = (18, 18)  # number of them to each side, and upwards and downwards
_CLASH, _OUT, _DOWN, _LOOSE = 4000.0, 4000.0, 1.2, 3.0  # costs, in pixels of distance: see `_cost`
_LINE_PX, _LINE_WORTH_PX = 6.0, 20.0  # assumed thickness of a line to a label, and worth of each piece of that length
_MOST_DOTS: Final = 200  # of a line; only a line far beyond the picture would have more
_ALONG: Final = np.linspace(0.0, 1.0, 16)  # points on a line at which crossings are tested


@dataclass(frozen=True, slots=True)
class Wish:
    """A label that needs a position.

    Attributes:
        text: Its text.
        near: Pixels; its middle is to be near any of them.
        line: The pixel at which a line to the label starts; None: there is no line.
    """

    text: str
    near: tuple[tuple[float, float], ...]
    line: tuple[float, float] | None = None


def arrange(
    wishes: Sequence[Wish], seen: Iterable[Seen], room: tuple[float, float], scale: float = 1.0
) -> list[tuple[float, float]]:
    """Return the middle of each label.

    Args:
        wishes: The labels.
        seen: The rectangles that labels should not cover.
        room: Columns and rows of the picture.
        scale: Pixels of the picture for one pixel of the viewer.
    """
    before, taken = np.array([*seen], np.float64).reshape(-1, 5), np.empty((0, 4))
    middles = []
    for wish in wishes:
        half = np.array(half_size(wish.text)) * scale
        tried = [_best(wish, near, half, before, taken, room, scale) for near in wish.near]
        x, y = middle = min(tried)[1]
        middles.append(middle)
        wide, high = half + _GAP_PX * scale
        taken = np.vstack((taken, (x - wide, y - high, x + wide, y + high)))
        if wish.line is not None:
            end = np.clip(wish.line, middle - half, middle + half)
            before = np.vstack((before, dots(np.array(wish.line), end, _LINE_PX * scale, _LINE_WORTH_PX)))
    return middles


def half_size(text: str) -> tuple[float, float]:
    """Return half the width and half the height of a label, in pixels of the viewer."""
    return (len(text) * LETTER_PX + MARGIN_PX) / 2.0, HEIGHT_PX / 2.0


def around(points: NDArray[np.float64], margin: float = 0.0) -> Rectangle:
    """Return the rectangle around pixels, shape (n, 2), and a margin."""
    left, top = points.min(axis=0) - margin
    right, bottom = points.max(axis=0) + margin
    return float(left), float(top), float(right), float(bottom)


def dots(start: NDArray[np.float64], end: NDArray[np.float64], spacing: float, worth: float) -> list[Seen]:
    """Return a line in the picture as squares, `spacing` pixels wide and apart."""
    count = min(_MOST_DOTS, max(1, round(float(np.linalg.norm(end - start)) / spacing)))
    along = start + (end - start) * ((np.arange(count) + 0.5) / count)[:, None]
    return [(*around(point[None, :], spacing / 2.0), worth) for point in along]


def _best(
    wish: Wish,
    near: tuple[float, float],
    half: NDArray[np.float64],
    seen: Boxes,
    taken: Boxes,
    room: tuple[float, float],
    scale: float,
) -> tuple[float, tuple[float, float]]:
    """Return the cost and the middle of the best position near a pixel."""
    columns, rows = (
        middle + scale * step * np.arange(-reach, reach + 1.0)
        for middle, step, reach in zip(near, _STEP_PX, _REACH, strict=True)
    )
    cost = _cost(_Places(columns, rows, half), near, seen, taken, room, scale)
    if wish.line is None:
        cost += (_LOOSE - 1.0) * _distance(columns - near[0], rows - near[1], scale)
    else:
        centres, start = np.stack(np.meshgrid(columns, rows), axis=-1), np.asarray(wish.line)
        cost += _CLASH * _crossed(start, np.clip(start, centres - half, centres + half), taken)
    row, column = np.unravel_index(np.argmin(cost), cost.shape)
    return float(cost[row, column]), (float(columns[column]), float(rows[row]))


@dataclass(frozen=True, slots=True)
class _Places:
    """Positions for one label: each column with each row, and half the label's width and height."""

    columns: NDArray[np.float64]
    rows: NDArray[np.float64]
    half: NDArray[np.float64]

    def common(self, found: Boxes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the overlap of rectangles with the label: breadth by column, and height by row."""
        breadth, height = (
            np.clip(
                np.minimum(middles[:, None] + half, found[:, axis + 2])
                - np.maximum(middles[:, None] - half, found[:, axis]),
                0.0,
                None,
            )
            for axis, (middles, half) in enumerate(zip((self.columns, self.rows), self.half, strict=True))
        )
        return breadth, height


def _cost(
    places: _Places, near: tuple[float, float], seen: Boxes, taken: Boxes, room: tuple[float, float], scale: float
) -> NDArray[np.float64]:
    """Return the cost of each position, shape (rows, columns): distance, covered things, other labels, the margins."""
    distance = _distance(places.columns - near[0], places.rows - near[1], scale)
    breadth, height = places.common(seen)
    covered = _summed(height * (seen[:, 4] / _area(seen)), breadth)
    breadth, height = places.common(taken)
    clashes = _summed((height > 0.0).astype(np.float64), (breadth > 0.0).astype(np.float64))
    outside = [
        (middles < half) | (middles > end - half)
        for middles, half, end in zip((places.columns, places.rows), places.half, room, strict=True)
    ]
    margins = outside[0][None, :] | outside[1][:, None]
    return np.asarray(distance + covered + _CLASH * clashes + _OUT * margins)


def _summed(height: NDArray[np.float64], breadth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sums over all rectangles, shape (rows, columns), in one thread and in a fixed order."""
    return np.asarray(np.einsum("rn,cn->rc", height, breadth, optimize=False))


def _distance(right: NDArray[np.float64], down: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Return distances in pixels of the viewer, shape (rows, columns); distances downwards count more than upwards."""
    return np.hypot(right[None, :], (np.where(down > 0.0, _DOWN, 1.0) * down)[:, None]) / scale


def _crossed(start: NDArray[np.float64], ends: NDArray[np.float64], taken: Boxes) -> NDArray[np.float64]:
    """Return the number of rectangles that the line to each end crosses; ends of shape (rows, columns, 2)."""
    points = start + _ALONG[:, None, None, None] * (ends - start)
    count = np.zeros(ends.shape[:2])
    for left, top, right, bottom in taken:
        x, y = points[..., 0], points[..., 1]
        count += np.any((x >= left) & (x <= right) & (y >= top) & (y <= bottom), axis=0)
    return count


def _area(found: Boxes) -> NDArray[np.float64]:
    """Return the areas, each above zero."""
    sides = np.maximum(found[:, 2:4] - found[:, :2], 1e-3)
    return np.asarray(sides[:, 0] * sides[:, 1])
