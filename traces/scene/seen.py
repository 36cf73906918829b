"""The visible parts of the world in the picture, each with its worth, which keeps labels away from it."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from skolem.traces.messages import Belief, ObjectBelief, ObjectType, RegionBelief
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.scene.belief import SIGMAS
from skolem.traces.scene.eye import Eye
from skolem.traces.scene.layout import Seen, around, dots
from skolem.traces.scene.shapes import Xyz, point_on
from skolem.traces.scene.stage import Limb

UNSURE: Final = 0.5  # anchors less likely to exist are drawn without label
_EDGE_PX, _LIMB_M = 14.0, 0.40  # assumed thickness of the outline of a region and of a limb of the robot
_EDGE_WORTH_PX, _TOP_WORTH_PX, _LEG_WORTH_PX, _LIMB_WORTH_PX = 200.0, 45.0, 150.0, 6000.0  # worth of a piece: see Seen
_THING_WORTH_PX, _THING_PX = 500.0, 18.0  # worth of an object, and margin around it: a label there looks like its own
_SHORT_M: Final = 0.02  # shorter limbs are not visible


def in_sight(
    eye: Eye,
    belief: Belief,
    types: Mapping[str, ObjectType],
    things: Iterable[Sequence[Xyz]],
    limbs: Iterable[Limb],
) -> list[Seen]:
    """Return the rectangles that labels should not cover.

    Args:
        eye: The eye.
        belief: The belief, which is drawn.
        types: The object types.
        things: Corners of each visible true object [m].
        limbs: Start and end of each of the robot's limbs [m].
    """
    found = [_thing(eye, corners) for corners in things]
    return [*found, *_believed(eye, belief, types), *_edges(eye, belief, types), *_limbs(eye, limbs)]


@dataclass(frozen=True, slots=True)
class Likely:
    """An object that is likely to exist: the belief about it, and its likeliest type."""

    anchor: str
    known: ObjectBelief
    kind: ObjectType


def likely(belief: Belief, types: Mapping[str, ObjectType]) -> list[Likely]:
    """Return the objects that are likely to exist."""
    found = ((anchor, belief.objects[anchor]) for anchor in belief.anchors)
    return [Likely(anchor, known, types[likeliest(known.type)]) for anchor, known in found if known.exists >= UNSURE]


def region_corners(belief: Belief, region: RegionBelief, types: Mapping[str, ObjectType]) -> list[Xyz]:
    """Return the corners of a region in the world [m]; two corners whose indices differ in one bit share an edge."""
    support = belief.objects[region.support]
    x, y, z = types[likeliest(support.type)].size_m
    corners = itertools.product((-x / 2.0, x / 2.0), (-y / 2.0, y / 2.0), (z, z + region.height_m))
    return [point_on(support.world_T_object, corner) for corner in corners]


def _edges(eye: Eye, belief: Belief, types: Mapping[str, ObjectType]) -> list[Seen]:
    """Return the rectangles of outlines of regions, of tables' legs and of the edges of their tops."""
    found = []
    for region in belief.regions.values():
        pixels = eye.pixels(region_corners(belief, region, types))[:, :2]
        for one, bit in itertools.product(range(len(pixels)), (1, 2, 4)):
            if not one & bit:
                found += dots(pixels[one], pixels[one | bit], _EDGE_PX, _EDGE_WORTH_PX)
    for each in likely(belief, types):
        known, kind = each.known, each.kind
        if kind.shape == "table":
            x, y, z = kind.size_m
            corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
            points = [point_on(known.world_T_object, (u / 2.0, v / 2.0, h)) for h in (z, 0.0) for u, v in corners]
            pixels = eye.pixels(points)[:, :2]
            for i, above in enumerate(pixels[:4]):
                found += dots(above, pixels[(i + 1) % 4], _EDGE_PX, _TOP_WORTH_PX)
                found += dots(above, pixels[i + 4], _EDGE_PX, _LEG_WORTH_PX)
    return found


def _believed(eye: Eye, belief: Belief, types: Mapping[str, ObjectType]) -> list[Seen]:
    """Return the rectangles of believed objects but tables, and of the ellipsoids of their positions."""
    found = []
    for each in likely(belief, types):
        known, kind = each.known, each.kind
        if kind.shape != "table":
            x, y, z = kind.size_m
            spread = SIGMAS * float(max(known.covariance[0], known.covariance[3])) ** 0.5
            wide = [(i * max(x / 2.0, spread), j * max(y / 2.0, spread), z) for i in (-1, 1) for j in (-1, 1)]
            corners = [*wide, *((i * x / 2.0, j * y / 2.0, 0.0) for i in (-1, 1) for j in (-1, 1))]
            found.append(_thing(eye, [point_on(known.world_T_object, corner) for corner in corners]))
    return found


def _limbs(eye: Eye, limbs: Iterable[Limb]) -> list[Seen]:
    """Return the rectangles of limbs."""
    long = [limb for limb in limbs if math.dist(*limb) > _SHORT_M]
    pixels = eye.pixels(point for limb in long for point in limb)
    found = []
    for start, end in zip(pixels[::2], pixels[1::2], strict=True):
        found += dots(start[:2], end[:2], 2.0 * _LIMB_M / float(start[2] + end[2]), _LIMB_WORTH_PX)
    return found


def _thing(eye: Eye, corners: Iterable[Xyz]) -> Seen:
    return *around(eye.pixels(corners)[:, :2], _THING_PX), _THING_WORTH_PX
