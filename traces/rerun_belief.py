"""The believed objects in a rerun recording: outlines in believed colours, how sure their places are, and labels.

An outline has the most likely type's shape. The flat ellipsoid above it covers two standard deviations of the position;
orange marks the base's. A label reads `anchor: type p, colour, Den p`.
"""

import math
from collections.abc import Mapping

import rerun as rr

from skolem.traces.messages import Belief, Denotation, ObjectBelief, ObjectType, Pose4
from skolem.traces.rerun_rows import Rows, When
from skolem.traces.rerun_shapes import FRAME, GREY, Rgba, Shapes, Xyz, colour_word, point_on, rgba, turned

SIGMAS = 2.0
UNSURE = 0.5  # anchors less likely to exist are drawn without label
_LEAST_M, _FLAT_M, _ABOVE_M = 0.004, 0.005, 0.02
_ORANGE: Rgba = (255, 150, 40, 130)
_LABEL_M, _STACK_M, _NEAR_M = 0.16, 0.10, 0.60  # height of a label above its object, between labels, near each other
_CERTAIN = 0.995  # likelier types are shown without their probability
Covariance = tuple[float, float, float, float, float, float]


class Beliefs:
    """Draws what is believed of objects and base, once per decision."""

    def __init__(self, rows: Rows) -> None:
        """Begin without objects."""
        self._rows = rows
        self._shapes = Shapes(rows)
        self._known: set[str] = set()
        rows.static("belief/base", FRAME)

    def believed(
        self, belief: Belief, denotation: Denotation | None, when: When, types: Mapping[str, ObjectType]
    ) -> None:
        """Draw a belief; the descriptions' values, where they are recorded, are of the same step."""
        x, y, theta = belief.world_T_base
        self._rows.add("belief/base", when, spread((x, y, 0.0, theta), belief.base_covariance, _FLAT_M, _ORANGE))
        heights = label_heights(belief, types)
        for anchor in belief.anchors:
            known = belief.objects[anchor]
            self._draw(anchor, known, when, types[likely_type(known)])
            kind = types[likely_type(known)]
            text = label(anchor, known, kind, denotation) if known.exists >= UNSURE else ""
            self._label(anchor, when, known, kind, heights[anchor], text)
        for gone in sorted(self._known.difference(belief.anchors)):
            self._erase(gone, when)
        self._known = set(belief.anchors)

    def _draw(self, anchor: str, known: ObjectBelief, when: When, kind: ObjectType) -> None:
        entity, (x, y, z, theta) = f"belief/{anchor}", known.world_T_object
        if anchor not in self._known:
            for part in ("place", "label"):
                self._rows.static(f"{entity}/{part}", FRAME)
        hsv = known.colour.mean if known.colour_seen else GREY
        self._shapes.draw(entity, when, kind, (x, y, z), turned(theta), rgba(hsv), "majorwireframe")
        above = kind.size_m[2] + _ABOVE_M
        self._rows.add(f"{entity}/place", when, spread(known.world_T_object, known.covariance, above, rgba(hsv, 190)))

    def _label(self, anchor: str, when: When, known: ObjectBelief, kind: ObjectType, height: float, text: str) -> None:
        foot, top = (point_on(known.world_T_object, (0.0, 0.0, z)) for z in (kind.size_m[2], height))
        line: list[list[Xyz]] = [] if kind.shape == "table" or not text else [[foot, top]]
        self._rows.add(
            f"belief/{anchor}/label",
            when,
            rr.LineStrips3D(line, radii=[0.001] * len(line), colors=[[160, 160, 160]] * len(line)),
            rr.Points3D(
                [top] if text else [],
                radii=[0.002] if text else [],
                labels=[text] if text else [],
                colors=[[235, 235, 235]] if text else [],
                show_labels=True,
            ),
        )

    def _erase(self, anchor: str, when: When) -> None:
        self._shapes.erase(f"belief/{anchor}", when)
        self._rows.add(f"belief/{anchor}/place", when, rr.Ellipsoids3D(half_sizes=[]))
        self._rows.add(f"belief/{anchor}/label", when, rr.LineStrips3D([]), rr.Points3D([]))


def likely_type(known: ObjectBelief) -> str:
    """Return the most likely type, of equally likely ones the first by name."""
    return max(sorted(known.type), key=known.type.__getitem__)


def label(anchor: str, known: ObjectBelief, kind: ObjectType, denotation: Denotation | None) -> str:
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


def label_heights(belief: Belief, types: Mapping[str, ObjectType]) -> dict[str, float]:
    """Return how high above each object's base its label stands [m]: higher than those of its neighbours before it."""
    heights: dict[str, float] = {}
    levels: list[tuple[Pose4, float]] = []
    for anchor in belief.anchors:
        at, kind = belief.objects[anchor].world_T_object, types[likely_type(belief.objects[anchor])]
        if kind.shape == "table":
            heights[anchor] = kind.size_m[2] / 2.0
            continue
        taken = [top for other, top in levels if math.dist(at[:2], other[:2]) < _NEAR_M]
        top = max([at[2] + kind.size_m[2] + _LABEL_M, *(level + _STACK_M for level in taken)])
        levels.append((at, top))
        heights[anchor] = top - at[2]
    return heights


def spread(world_T_object: Pose4, covariance: Covariance, above: float, colour: Rgba) -> rr.Ellipsoids3D:
    """Return the flat ellipsoid of a position, as high above the pose as asked.

    Args:
        world_T_object: Mean.
        covariance: Upper triangle of 3x3 over (x, y, theta), in the frame of the mean.
        above: Height of the ellipsoid's centre above the pose [m].
        colour: Of the ellipsoid.
    """
    a, b, _, c, _, _ = covariance
    middle, radius = (a + c) / 2.0, math.hypot((a - c) / 2.0, b)
    axes = [SIGMAS * math.sqrt(max(0.0, part)) for part in (middle + radius, middle - radius)]
    angle = world_T_object[3] + math.atan2(2.0 * b, a - c) / 2.0
    return rr.Ellipsoids3D(
        centers=[point_on(world_T_object, (0.0, 0.0, above))],
        half_sizes=[[*(max(_LEAST_M, axis) for axis in axes), _FLAT_M]],
        quaternions=[rr.Quaternion(xyzw=turned(angle))],
        colors=[colour],
        fill_mode="solid",
    )
