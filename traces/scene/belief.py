"""The believed objects in a rerun recording: outlines in believed colours, with the uncertainty of their positions.

An outline has the most likely type's shape. The flat ellipsoid above it covers two standard deviations of the position;
the one of the base is orange.
"""

import math
from collections.abc import Mapping, Sequence

import rerun as rr

from skolem.traces.messages import Belief, ObjectBelief, ObjectType, Pose4, Upper3x3
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import quaternion_xyzw
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.shapes import FRAME, GREY, Rgba, Shapes, point_on, rgba

SIGMAS = 2.0
_LEAST_M, _FLAT_M, _ABOVE_M = 0.004, 0.005, 0.02
_PALE, _SHEER = 0.45, 170  # saturation of an ellipsoid as a share of its object's; opacity
_ORANGE: Rgba = (255, 150, 40, 130)


class Beliefs:
    """Draws the belief about objects and base, once for each decision."""

    def __init__(self, rows: Rows) -> None:
        """Start without objects."""
        self._rows = rows
        self._shapes = Shapes(rows)
        self._known: set[str] = set()
        rows.static("belief/base", FRAME)

    def believed(self, belief: Belief, when: When, types: Mapping[str, ObjectType]) -> None:
        """Draw a belief."""
        x, y, theta = belief.world_T_base
        self._rows.add("belief/base", when, spread((x, y, 0.0, theta), belief.base_covariance, _FLAT_M, _ORANGE))
        for anchor in belief.anchors:
            known = belief.objects[anchor]
            self._draw(anchor, known, when, types[likeliest(known.type)])
        for gone in sorted(self._known.difference(belief.anchors)):
            self._erase(gone, when)
        self._known = set(belief.anchors)

    def _draw(self, anchor: str, known: ObjectBelief, when: When, kind: ObjectType) -> None:
        entity, (x, y, z, theta) = f"belief/{anchor}", known.world_T_object
        if anchor not in self._known:
            self._rows.static(f"{entity}/place", FRAME)
        hsv = known.colour.mean if known.colour_seen else GREY
        self._shapes.draw(entity, when, kind, (x, y, z), quaternion_xyzw(theta), rgba(hsv), "majorwireframe")
        above = kind.size_m[2] + _ABOVE_M
        self._rows.add(f"{entity}/place", when, spread(known.world_T_object, known.covariance, above, _pale(hsv)))

    def _erase(self, anchor: str, when: When) -> None:
        self._shapes.erase(f"belief/{anchor}", when)
        self._rows.add(f"belief/{anchor}/place", when, rr.Ellipsoids3D(half_sizes=[]))


def _pale(hsv: Sequence[float]) -> Rgba:
    """Return a paler colour that distinguishes an ellipsoid from its object."""
    return rgba((hsv[0], hsv[1] * _PALE, 1.0), _SHEER)


def spread(world_T_object: Pose4, covariance: Upper3x3, above: float, colour: Rgba) -> rr.Ellipsoids3D:
    """Return the flat ellipsoid of a position.

    Args:
        world_T_object: Mean.
        covariance: Upper triangle of 3x3 over (x, y, theta), in the frame of the mean.
        above: Height of the ellipsoid's centre above the pose [m].
        colour: Colour of the ellipsoid.
    """
    a, b, _, c, _, _ = covariance
    middle, radius = (a + c) / 2.0, math.hypot((a - c) / 2.0, b)
    axes = [SIGMAS * math.sqrt(max(0.0, part)) for part in (middle + radius, middle - radius)]
    angle = world_T_object[3] + math.atan2(2.0 * b, a - c) / 2.0
    return rr.Ellipsoids3D(
        centers=[point_on(world_T_object, (0.0, 0.0, above))],
        half_sizes=[[*(max(_LEAST_M, axis) for axis in axes), _FLAT_M]],
        quaternions=[rr.Quaternion(xyzw=quaternion_xyzw(angle))],
        colors=[colour],
        fill_mode="solid",
    )
