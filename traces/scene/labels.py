"""Labels in a rerun recording, laid out for the first eye: of believed objects, with a line to each, and of regions.

A label of an object reads `anchor: type p, colour, meant p`. The label of a region gives the share of its positions
that could still hide an object, and P(its contents are known): `_reg1_: 0 % unsearched, known .33`.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import rerun as rr

from skolem.traces.messages import Belief, Denotation, ObjectBelief, ObjectType
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.scene.eye import VIEW_PX, Eye
from skolem.traces.scene.layout import HEIGHT_PX, Wish, arrange, half_size
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.seen import in_sight, likely, region_corners
from skolem.traces.scene.shapes import FRAME, OUTLINE, Rgba, Xyz, colour_word, point_on
from skolem.traces.scene.stage import Limb

_CERTAIN: Final = 0.995  # likelier types are shown without their probability
_WHITE: Final[Rgba] = (235, 235, 235, 255)
_LINE: Final[Rgba] = (160, 160, 160, 255)
_ABOVE_PX: Final = 32.0  # from the top of an object to the middle of its label
_CORNER_PX: Final = 16.0  # from the corner of a region to the middle of its label
_NEARER: Final = 0.7  # distance from the eye to the end of a line, as a share of its object's: no table hides it
_TEXT_PX: Final = 2.0  # from the upper edge of a label to its point in the viewer


@dataclass(frozen=True, slots=True)
class _Label:
    """A label without position.

    Attributes:
        entity: Its entity.
        text: Its text.
        of: The points at which it may stand [m]; with a line, the one point of its object.
        above_px: The best distance of its middle above the point.
        colour: Colour of the text.
        line: Whether a line leads to it.
    """

    entity: str
    text: str
    of: tuple[Xyz, ...]
    above_px: float
    colour: Rgba
    line: bool


class Labels:
    """Draws all labels, once for each decision."""

    def __init__(self, rows: Rows) -> None:
        """Start without labels."""
        self._rows = rows
        self._framed: set[str] = set()
        self._drawn: set[str] = set()

    def believed(
        self,
        eye: Eye,
        belief: Belief,
        denotation: Denotation | None,
        when: When,
        types: Mapping[str, ObjectType],
        things: Iterable[Sequence[Xyz]],
        limbs: Iterable[Limb],
    ) -> None:
        """Draw the labels of a belief.

        Args:
            eye: The eye for which they are laid out.
            belief: The belief.
            denotation: P(Den) at the same step, if it is recorded.
            when: Position on the timelines.
            types: The object types.
            things: Corners of each visible true object [m].
            limbs: Start and end of each of the robot's limbs [m].
        """
        labels = [*_of_tables(eye, belief, types), *_of_regions(belief, types), *_of_objects(belief, denotation, types)]
        seen = in_sight(eye, belief, types, things, limbs)
        wishes = [_wish(eye, label) for label in labels]
        for label, wish, middle in zip(labels, wishes, arrange(wishes, seen, VIEW_PX), strict=True):
            self._draw(eye, label, wish, middle, when)
        now = {label.entity for label in labels}
        for gone in sorted(self._drawn - now):
            self._rows.add(f"{gone}/label", when, rr.LineStrips3D([]), rr.Points3D([]))
        self._drawn = now

    def _draw(self, eye: Eye, label: _Label, wish: Wish, middle: tuple[float, float], when: When) -> None:
        entity = f"{label.entity}/label"
        if entity not in self._framed:
            self._framed.add(entity)
            self._rows.static(entity, FRAME)
        column, row, _ = eye.pixels(label.of)[0]
        (half_width, half_height), (x, y) = half_size(wish.text), middle
        end = np.clip((column, row), (x - half_width, y - half_height), (x + half_width, y + half_height))
        foot = eye.moved(label.of[0], float(end[0] - column), float(end[1] - row), _NEARER)
        line = [[label.of[0], foot]] if label.line else []
        at = eye.moved(label.of[0], x - column, y - HEIGHT_PX / 2.0 + _TEXT_PX - row)
        self._rows.add(
            entity,
            when,
            rr.LineStrips3D(line, radii=[0.0015] * len(line), colors=[_LINE] * len(line)),
            rr.Points3D([at], radii=[0.0], labels=[label.text], colors=[label.colour], show_labels=True),
        )


def text_of(anchor: str, known: ObjectBelief, kind: ObjectType, denotation: Denotation | None) -> str:
    """Return the belief about an object in one short line; for an object that no hand can grasp, only its name."""
    if not kind.graspable:
        return anchor
    name = likeliest(known.type)
    parts = [name if known.type[name] > _CERTAIN else f"{name} {two_digits(known.type[name])}"]
    if known.colour_seen:
        parts.append(colour_word(known.colour.mean))
    if denotation is not None:
        parts += [f"meant {two_digits(table[anchor])}" for table in denotation.probability.values() if anchor in table]
    return f"{anchor}: {', '.join(parts)}"


def two_digits(p: float) -> str:
    """Return a probability as `.07`."""
    return f"{p:.2f}".removeprefix("0")


def _of_tables(eye: Eye, belief: Belief, types: Mapping[str, ObjectType]) -> list[_Label]:
    """Return the labels of supports, each below the edge nearest to the eye."""
    labels = []
    for each in likely(belief, types):
        anchor, known, kind = each.anchor, each.known, each.kind
        if kind.shape == "table":
            x, y, z = kind.size_m
            sides = [(x / 2.0, 0.0), (-x / 2.0, 0.0), (0.0, y / 2.0), (0.0, -y / 2.0)]
            points = [point_on(known.world_T_object, (*side, z / 2.0)) for side in sides]
            nearest = (points[int(np.argmax(eye.pixels(points)[:, 1]))],)
            labels.append(_Label(f"belief/{anchor}", text_of(anchor, known, kind, None), nearest, 0.0, _WHITE, False))
    return labels


def _of_objects(belief: Belief, denotation: Denotation | None, types: Mapping[str, ObjectType]) -> list[_Label]:
    """Return the labels of all other objects, each above its object and with a line to it."""
    return [
        _Label(
            f"belief/{each.anchor}",
            text_of(each.anchor, each.known, each.kind, denotation),
            (point_on(each.known.world_T_object, (0.0, 0.0, each.kind.size_m[2])),),
            _ABOVE_PX,
            _WHITE,
            True,
        )
        for each in likely(belief, types)
        if each.kind.shape != "table"
    ]


def _of_regions(belief: Belief, types: Mapping[str, ObjectType]) -> list[_Label]:
    """Return the labels of regions, each above an upper corner of the outline."""
    labels = []
    for name, region in belief.regions.items():
        upper = tuple(region_corners(belief, region, types)[1::2])
        text = f"{name}: {100.0 * region.hidden:.0f} % unsearched, known {two_digits(region.seen)}"
        labels.append(_Label(f"regions/{name}", text, upper, _CORNER_PX, OUTLINE, False))
    return labels


def _wish(eye: Eye, label: _Label) -> Wish:
    pixels = [(float(column), float(row)) for column, row, _ in eye.pixels(label.of)]
    near = tuple((column, row - label.above_px) for column, row in pixels)
    return Wish(label.text, near, pixels[0] if label.line else None)
