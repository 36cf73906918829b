"""Colour words: the boxes that facts give them, which words overlap, and which colours have no word."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.rulebook.arguments import Position, Range, integers
from skolem.reasoner.terms import Compound, Term
from skolem.traces.errors import Fault
from skolem.traces.messages import ColourMeaning, HsvUnion, HsvVolume

MOST_GAPS: Final = 5  # told one by one, the largest first
_HUE: Final = Range("a hue", 0, 360, "degrees", turns=True)
_PERCENT: Final = Range("a number", 0, 100, "percent")
_TOP: Final = (360, 100, 100)  # degrees, percent, percent
_Span = tuple[int, int]
_Sides = tuple[_Span, _Span, _Span]  # hue, which does not wrap, saturation and value


@dataclass(frozen=True, slots=True)
class ColourBox:
    """A sound fact of a colour, and its position."""

    fact: Compound
    position: Position
    volume: HsvVolume

    def parts(self) -> list[_Sides]:
        """Return the box in degrees and percent, in two parts if its hues wrap."""
        return _parts(self.volume)


def colour_boxes(stated: Iterable[tuple[Compound, Position]], faults: list[Fault]) -> list[ColourBox]:
    """Return the boxes of one word by fact, and add what is wrong with them; they share no colour."""
    read = [(fact, position, _volume(fact, position, faults)) for fact, position in stated]
    boxes = [ColourBox(fact, position, volume) for fact, position, volume in read if volume is not None]
    for one, other in combinations(boxes, 2):
        if share_colour(one.volume, other.volume):
            remedy = "let them share no colour, or make them one"
            faults.append(other.position.fault(f"{other.fact} overlaps {one.fact} in {one.position}; {remedy}"))
    return boxes


def meaning_of(boxes: Sequence[ColourBox]) -> ColourMeaning | None:
    """Return the meaning of a word with these boxes; None if it has none."""
    volumes = tuple(box.volume for box in boxes)
    return HsvUnion(boxes=volumes) if len(volumes) > 1 else volumes[0] if volumes else None


def in_words(volume: HsvVolume) -> str:
    """Return a box in degrees and percent."""
    return _told(_span(volume.hue, _TOP[0]), _span(volume.saturation, _TOP[1]), _span(volume.value, _TOP[2]))


def share_colour(one: HsvVolume, other: HsvVolume) -> bool:
    """Return whether some colour is in both boxes, whose sides are whole degrees and percents."""
    return any(
        all(max(s[0], t[0]) < min(s[1], t[1]) for s, t in zip(mine, its, strict=True))
        for mine in _parts(one)
        for its in _parts(other)
    )


def overlaps(words: Mapping[str, Sequence[ColourBox]]) -> list[Fault]:
    """Return a warning for every two words that share a colour, at the user's own fact if there is one."""
    found = []
    for first, second in combinations(sorted(words), 2):
        shared = next(((a, b) for a in words[first] for b in words[second] if share_colour(a.volume, b.volume)), None)
        if shared is not None:
            a, b = shared
            position = a.position if a.position.own else b.position
            found.append(position.fault(f"warning: the colours {first} and {second} overlap"))
    return found


def gaps(words: Mapping[str, Sequence[ColourBox]]) -> list[Fault]:
    """Return a warning for every box of colours that have no word, the largest first, and one for all beyond a few.

    A warning stands at a fact of the user's own if there is one, since what ships has no gap.
    """
    boxes = [box for word in sorted(words) for box in words[word]]
    if not boxes:
        return []
    empty = sorted(_uncovered(boxes), key=lambda sides: (-_size(sides), sides))
    texts = [f"warning: no colour for {_told(*sides)}" for sides in empty[:MOST_GAPS]]
    found = [_beside(sides, boxes).fault(text) for sides, text in zip(empty, texts, strict=False)]
    if len(empty) > MOST_GAPS:
        share = 100.0 * sum(map(_size, empty)) / _size(tuple((0, top) for top in _TOP))
        rest = f"warning: no colour in {len(empty) - MOST_GAPS} more places; together {share:.2g} % of all have none"
        found.append(_beside(empty[MOST_GAPS], boxes).fault(rest))
    return found


def _volume(fact: Compound, position: Position, faults: list[Fault]) -> HsvVolume | None:
    problems = [
        (at + 1, f"{name} from {fact.args[at]} to {fact.args[at + 1]} is empty; {remedy}")
        for at, name, remedy in (
            (1, "hue", "let it end elsewhere"),
            (3, "saturation", f"let it end above {fact.args[3]}"),
            (5, "value", f"let it end above {fact.args[5]}"),
        )
        if _empty(fact.args[at], fact.args[at + 1], turns=at == 1)
    ]
    faults += [position.fault(f"colour {fact.args[0]}: {problem}", at) for at, problem in problems]
    values = integers(fact, position, faults, [_HUE] * 2 + [_PERCENT] * 4)
    if values is None or problems:
        return None
    hue, (s, s2, v, v2) = values[:2], (value / 100 for value in values[2:])
    return HsvVolume(hue=(hue[0] / 360, hue[1] / 360), saturation=(s, s2), value=(v, v2))


def _empty(low: Term, high: Term, turns: bool) -> bool:
    """Return whether the interval between two numbers is empty; with `turns` it may wrap around."""
    if not isinstance(low, int) or not isinstance(high, int):
        return False
    return low % 360 == high % 360 and high - low != 360 if turns else low >= high


def _parts(volume: HsvVolume) -> list[_Sides]:
    low, high = _span(volume.hue, _TOP[0])
    s, v = _span(volume.saturation, _TOP[1]), _span(volume.value, _TOP[2])
    arcs = [(low, high)] if low < high else [(low, _TOP[0]), (0, high)]
    return [(arc, s, v) for arc in arcs if arc[0] < arc[1]]


def _span(bounds: tuple[float, float], whole: int) -> _Span:
    return round(whole * bounds[0]), round(whole * bounds[1])


def _told(hue: _Span, saturation: _Span, value: _Span) -> str:
    (h, h2), (s, s2), (v, v2) = hue, saturation, value
    return f"hue {h} to {h2} degrees, saturation {s} to {s2} %, value {v} to {v2} %"


def _size(sides: Iterable[_Span]) -> int:
    return math.prod(high - low for low, high in sides)


# ---------------------------------------------------------------- gaps


def _uncovered(boxes: Sequence[ColourBox]) -> list[_Sides]:
    """Return boxes that fill what no box covers.

    The faces of all boxes divide the space into cells, each of which is in a box or outside of all.
    """
    parts = [part for box in boxes for part in box.parts()]
    edges = [sorted({0, top, *(at for part in parts for at in part[axis])}) for axis, top in enumerate(_TOP)]
    free = np.ones([len(each) - 1 for each in edges], dtype=np.bool_)
    for part in parts:
        free[_cells(part, edges)] = False
    found = []
    while free.any():
        sides = _grown(free, edges)
        free[_cells(sides, edges)] = False
        found.append(sides)
    return found


def _cells(sides: _Sides, edges: Sequence[list[int]]) -> tuple[slice, ...]:
    return tuple(slice(each.index(low), each.index(high)) for (low, high), each in zip(sides, edges, strict=True))


def _grown(free: NDArray[np.bool_], edges: Sequence[list[int]]) -> _Sides:
    """Return the box that the first free cell grows to, along value, then saturation, then hue."""
    at = [int(i) for i in np.argwhere(free)[0]]
    ends = [i + 1 for i in at]
    for axis in (2, 1, 0):
        while ends[axis] < free.shape[axis]:
            longer = tuple(slice(i, end + (k == axis)) for k, (i, end) in enumerate(zip(at, ends, strict=True)))
            if not free[longer].all():
                break
            ends[axis] += 1
    hue, saturation, value = ((each[i], each[end]) for each, i, end in zip(edges, at, ends, strict=True))
    return hue, saturation, value


def _beside(gap: _Sides, boxes: Sequence[ColourBox]) -> Position:
    """Return the position of a box of the user's own if there is one, and of those of one that touches the gap."""

    def order(box: ColourBox) -> tuple[bool, bool]:
        return not box.position.own, not any(_touch(gap, part) for part in box.parts())

    return min(boxes, key=order).position


def _touch(gap: _Sides, part: _Sides) -> bool:
    """Return whether two boxes share more than an edge; hue 0 is hue 360."""
    meets = [max(s[0], t[0]) <= min(s[1], t[1]) for s, t in zip(gap, part, strict=True)]
    meets[0] = meets[0] or {gap[0][0] % 360, gap[0][1] % 360} & {part[0][0] % 360, part[0][1] % 360} != set()
    inside = [max(s[0], t[0]) < min(s[1], t[1]) for s, t in zip(gap, part, strict=True)]
    return all(meets) and sum(inside) >= 2
