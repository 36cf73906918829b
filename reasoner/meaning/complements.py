"""Complements: the properties of an object that does not have a given property.

The complement of a type or a colour is one property. That of a weight interval is one for each side of it: either makes
the object lie outside.
"""

from collections.abc import Iterator, Mapping
from itertools import pairwise

from skolem.traces.messages import ColourMeaning, HsvUnion, HsvVolume, Meaning, TypeIs, TypeIsNot, WeightInterval

_Span = tuple[float, float]
_WHOLE = (0.0, 1.0)


def complements(name: str, meaning: Meaning) -> Mapping[str, Meaning]:
    """Return the properties, by name, of which an object has one exactly if it lacks the given one.

    The names are no words of the vocabulary, since no word has two underscores in a row.

    Args:
        name: Name of the property.
        meaning: Its meaning.
    """
    match meaning:
        case TypeIs(type=kind):
            return {f"not__{name}": TypeIsNot(type=kind)}
        case TypeIsNot(type=kind):
            return {f"not__{name}": TypeIs(type=kind)}
        case WeightInterval():
            return dict(_outside(name, meaning))
    return {f"not__{name}": HsvUnion(boxes=tuple(_other_colours(meaning)))}


def _outside(name: str, interval: WeightInterval) -> Iterator[tuple[str, Meaning]]:
    below, above = interval.at_least_kg > 0.0, interval.below_kg is not None
    both = below and above
    if below:
        yield f"not__{name}{'__below' * both}", WeightInterval(at_least_kg=0.0, below_kg=interval.at_least_kg)
    if interval.below_kg is not None:
        yield f"not__{name}{'__above' * both}", WeightInterval(at_least_kg=interval.below_kg)


def _other_colours(colour: ColourMeaning) -> Iterator[HsvVolume]:
    """Yield disjoint boxes that fill what a colour leaves.

    Saturation is cut first: what is grey enough has no certain hue, so that its box must not bound the hue.
    """
    for saturation in _pieces(edge for box in colour.boxes for edge in box.saturation):
        there = [box for box in colour.boxes if _covers(box.saturation, saturation)]
        for value in _pieces(edge for box in there for edge in box.value):
            taken = [box.hue for box in there if _covers(box.value, value)]
            for hue in _free(taken):
                yield HsvVolume(hue=hue, saturation=saturation, value=value)


def _pieces(edges: Iterator[float]) -> list[_Span]:
    """Return the intervals into which edges cut 0..1."""
    cuts = sorted({0.0, 1.0, *(min(max(edge, 0.0), 1.0) for edge in edges)})
    return list(pairwise(cuts))


def _covers(span: _Span, piece: _Span) -> bool:
    return span[0] <= piece[0] and piece[1] <= span[1]


def _free(taken: list[_Span]) -> list[_Span]:
    """Return the arcs of the circle of hues that no interval covers; an interval with low > high wraps."""
    if not taken:
        return [_WHOLE]
    flat = [part for low, high in taken for part in ([(low, high)] if low <= high else [(low, 1.0), (0.0, high)])]
    free: list[_Span] = []
    reached = 0.0
    for low, high in sorted(flat):
        if low > reached:
            free.append((reached, low))
        reached = max(reached, high)
    if reached < 1.0:
        free.append((reached, 1.0))
    if len(free) > 1 and free[0][0] == 0.0 and free[-1][1] == 1.0:
        return [(free[-1][0], free[0][1]), *free[1:-1]]
    return free
