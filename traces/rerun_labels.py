"""Labels in a rerun recording: of believed objects, with a line to each, and of regions; laid out for the first eye.

A label of an object reads `anchor: type p, colour, Den p`.
"""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import rerun as rr

from skolem.traces.messages import Belief, Denotation, ObjectBelief, ObjectType, RegionBelief
from skolem.traces.rerun_belief import SIGMAS, likely_type
from skolem.traces.rerun_eye import EYE, VIEW_PX
from skolem.traces.rerun_layout import HEIGHT_PX, Seen, Wish, around, arrange, dots, half_size
from skolem.traces.rerun_rows import Rows, When
from skolem.traces.rerun_shapes import FRAME, OUTLINE, Rgba, Xyz, colour_word, point_on

UNSURE: Final = 0.5  # anchors less likely to exist are drawn without label
_CERTAIN: Final = 0.995  # likelier types are shown without their probability
_WHITE: Final[Rgba] = (235, 235, 235, 255)
_LINE: Final[Rgba] = (160, 160, 160, 255)
_ABOVE_PX: Final = 32.0  # from the top of an object to the middle of its label
_CORNER_PX: Final = 16.0  # from the corner of a region to the middle of its label
_NEARER: Final = 0.7  # times as far from the eye as its object is the end of a line, so that no table hides it
_TEXT_PX: Final = 2.0  # from the upper edge of a label to its point, as the viewer draws it
_EDGE_PX, _LIMB_M = 14.0, 0.32  # as thick as the outline of a region and a limb of the robot count
_EDGE_WORTH_PX, _TOP_WORTH_PX, _LEG_WORTH_PX, _LIMB_WORTH_PX = 200.0, 45.0, 150.0, 500.0  # of such a piece: see Seen
_THING_WORTH_PX, _THING_PX = 500.0, 18.0  # of a thing, and of how much around it: a label there reads as its own
_SHORT_M: Final = 0.02  # shorter limbs are not to be seen
Limb = tuple[Xyz, Xyz]


@dataclass(frozen=True, slots=True)
class _Label:
    """A label before it has its place.

    Attributes:
        entity: What it is of.
        text: What it says.
        of: The points it may stand at [m]; the one that it speaks of, if there is a line.
        above_px: How far above that its middle wants to be.
        colour: Of the text.
        line: Whether a line leads to it.
    """

    entity: str
    text: str
    of: tuple[Xyz, ...]
    above_px: float
    colour: Rgba
    line: bool


class Labels:
    """Draws all labels, once per decision."""

    def __init__(self, rows: Rows) -> None:
        """Begin without labels."""
        self._rows = rows
        self._framed: set[str] = set()
        self._drawn: set[str] = set()

    def believed(
        self,
        belief: Belief,
        denotation: Denotation | None,
        when: When,
        types: Mapping[str, ObjectType],
        things: Iterable[Sequence[Xyz]],
        limbs: Iterable[Limb],
    ) -> None:
        """Draw the labels of a belief.

        Args:
            belief: What is believed.
            denotation: P(Den) at the same step, if it is recorded.
            when: On the timelines.
            types: What objects can be.
            things: Corners of each true thing that is to be seen [m].
            limbs: Start and end of each of the robot's limbs [m].
        """
        labels = [*_of_tables(belief, types), *_of_regions(belief, types), *_of_objects(belief, denotation, types)]
        seen = [*map(_thing, things), *_believed(belief, types), *_edges(belief, types)]
        seen += _limbs(limbs)
        wishes = [_wish(label) for label in labels]
        for label, wish, middle in zip(labels, wishes, arrange(wishes, seen, VIEW_PX), strict=True):
            self._draw(label, wish, middle, when)
        now = {label.entity for label in labels}
        for gone in sorted(self._drawn - now):
            self._rows.add(f"{gone}/label", when, rr.LineStrips3D([]), rr.Points3D([]))
        self._drawn = now

    def _draw(self, label: _Label, wish: Wish, middle: tuple[float, float], when: When) -> None:
        entity = f"{label.entity}/label"
        if entity not in self._framed:
            self._framed.add(entity)
            self._rows.static(entity, FRAME)
        column, row, _ = EYE.pixels(label.of)[0]
        (half_width, half_height), (x, y) = half_size(wish.text), middle
        end = np.clip((column, row), (x - half_width, y - half_height), (x + half_width, y + half_height))
        foot = EYE.moved(label.of[0], float(end[0] - column), float(end[1] - row), _NEARER)
        line = [[label.of[0], foot]] if label.line else []
        at = EYE.moved(label.of[0], x - column, y - HEIGHT_PX / 2.0 + _TEXT_PX - row)
        self._rows.add(
            entity,
            when,
            rr.LineStrips3D(line, radii=[0.0015] * len(line), colors=[_LINE] * len(line)),
            rr.Points3D([at], radii=[0.0], labels=[label.text], colors=[label.colour], show_labels=True),
        )


def text_of(anchor: str, known: ObjectBelief, kind: ObjectType, denotation: Denotation | None) -> str:
    """Return what is believed of an object, in one short line; of what no hand can take, only what it is called."""
    if not kind.graspable:
        return anchor
    name = likely_type(known)
    parts = [name if known.type[name] > _CERTAIN else f"{name} {two_digits(known.type[name])}"]
    if known.colour_seen:
        parts.append(colour_word(known.colour.mean))
    if denotation is not None:
        parts += [f"Den {two_digits(table[anchor])}" for table in denotation.probability.values() if anchor in table]
    return f"{anchor}: {', '.join(parts)}"


def two_digits(p: float) -> str:
    """Return a probability as `.07`."""
    return f"{p:.2f}".removeprefix("0")


def _kinds(belief: Belief, types: Mapping[str, ObjectType]) -> list[tuple[str, ObjectBelief, ObjectType]]:
    """Return the objects that are likely to exist, and what they most likely are."""
    found = ((anchor, belief.objects[anchor]) for anchor in belief.anchors)
    return [(anchor, known, types[likely_type(known)]) for anchor, known in found if known.exists >= UNSURE]


def _of_tables(belief: Belief, types: Mapping[str, ObjectType]) -> list[_Label]:
    """Return the labels of supports, each below the edge that is nearest to the eye."""
    labels = []
    for anchor, known, kind in _kinds(belief, types):
        if kind.shape == "table":
            x, y, z = kind.size_m
            sides = [(x / 2.0, 0.0), (-x / 2.0, 0.0), (0.0, y / 2.0), (0.0, -y / 2.0)]
            points = [point_on(known.world_T_object, (*side, z / 2.0)) for side in sides]
            nearest = (points[int(np.argmax(EYE.pixels(points)[:, 1]))],)
            labels.append(_Label(f"belief/{anchor}", text_of(anchor, known, kind, None), nearest, 0.0, _WHITE, False))
    return labels


def _of_objects(belief: Belief, denotation: Denotation | None, types: Mapping[str, ObjectType]) -> list[_Label]:
    """Return the labels of all else, each above its object and with a line to it."""
    return [
        _Label(
            f"belief/{anchor}",
            text_of(anchor, known, kind, denotation),
            (point_on(known.world_T_object, (0.0, 0.0, kind.size_m[2])),),
            _ABOVE_PX,
            _WHITE,
            True,
        )
        for anchor, known, kind in _kinds(belief, types)
        if kind.shape != "table"
    ]


def _of_regions(belief: Belief, types: Mapping[str, ObjectType]) -> list[_Label]:
    """Return the labels of regions, each above an upper corner of the outline."""
    labels = []
    for name, region in belief.regions.items():
        upper = tuple(region_corners(belief, region, types)[1::2])
        text = f"{name}: {100.0 * region.seen:.0f} % seen"
        labels.append(_Label(f"regions/{name}", text, upper, _CORNER_PX, OUTLINE, False))
    return labels


def _wish(label: _Label) -> Wish:
    pixels = [(float(column), float(row)) for column, row, _ in EYE.pixels(label.of)]
    near = tuple((column, row - label.above_px) for column, row in pixels)
    return Wish(label.text, near, pixels[0] if label.line else None)


def region_corners(belief: Belief, region: RegionBelief, types: Mapping[str, ObjectType]) -> list[Xyz]:
    """Return the corners of a region in the world [m]: each two that differ in one of three bits bound an edge."""
    support = belief.objects[region.support]
    x, y, z = types[likely_type(support)].size_m
    corners = itertools.product((-x / 2.0, x / 2.0), (-y / 2.0, y / 2.0), (z, z + region.height_m))
    return [point_on(support.world_T_object, corner) for corner in corners]


def _edges(belief: Belief, types: Mapping[str, ObjectType]) -> list[Seen]:
    """Return the outlines of regions, and tables' legs and the edges of their tops, as something to be seen."""
    found = []
    for region in belief.regions.values():
        pixels = EYE.pixels(region_corners(belief, region, types))[:, :2]
        for one, bit in itertools.product(range(len(pixels)), (1, 2, 4)):
            if not one & bit:
                found += dots(pixels[one], pixels[one | bit], _EDGE_PX, _EDGE_WORTH_PX)
    for _, known, kind in _kinds(belief, types):
        if kind.shape == "table":
            x, y, z = kind.size_m
            corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
            points = [point_on(known.world_T_object, (u / 2.0, v / 2.0, h)) for h in (z, 0.0) for u, v in corners]
            pixels = EYE.pixels(points)[:, :2]
            for i, above in enumerate(pixels[:4]):
                found += dots(above, pixels[(i + 1) % 4], _EDGE_PX, _TOP_WORTH_PX)
                found += dots(above, pixels[i + 4], _EDGE_PX, _LEG_WORTH_PX)
    return found


def _believed(belief: Belief, types: Mapping[str, ObjectType]) -> list[Seen]:
    """Return the believed objects as something to be seen, tables apart, and how unsure their places are."""
    found = []
    for _, known, kind in _kinds(belief, types):
        if kind.shape != "table":
            x, y, z = kind.size_m
            spread = SIGMAS * float(max(known.covariance[0], known.covariance[3])) ** 0.5
            wide = [(i * max(x / 2.0, spread), j * max(y / 2.0, spread), z) for i in (-1, 1) for j in (-1, 1)]
            corners = [*wide, *((i * x / 2.0, j * y / 2.0, 0.0) for i in (-1, 1) for j in (-1, 1))]
            found.append(_thing([point_on(known.world_T_object, corner) for corner in corners]))
    return found


def _limbs(limbs: Iterable[Limb]) -> list[Seen]:
    """Return limbs as something to be seen."""
    long = [limb for limb in limbs if math.dist(*limb) > _SHORT_M]
    pixels = EYE.pixels(point for limb in long for point in limb)
    found = []
    for start, end in zip(pixels[::2], pixels[1::2], strict=True):
        found += dots(start[:2], end[:2], 2.0 * _LIMB_M / float(start[2] + end[2]), _LIMB_WORTH_PX)
    return found


def _thing(corners: Iterable[Xyz]) -> Seen:
    return *around(EYE.pixels(corners)[:, :2], _THING_PX), _THING_WORTH_PX
