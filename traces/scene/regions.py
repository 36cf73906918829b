"""Regions of space in a rerun recording: their outlines, and cubes spread over the unseen part.

The cubes together are as large as the part of the region that could still hide an object. They are tiny where no
hidden object fits any more.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
import rerun as rr

from skolem.traces.messages import Belief, ObjectType, RegionBelief
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import quaternion_xyzw
from skolem.traces.scene.rows import Rows, When
from skolem.traces.scene.shapes import FRAME, OUTLINE, Xyz, point_on

_ORANGE: Final = (255, 140, 0)
_OPACITY_M, _MOST = 7.0, 200  # opacity of cubes times their edge, for large cubes stand before objects; largest opacity
_CRUMB_M: Final = 0.012  # edge of the smallest cubes, which are just visible


class Regions:
    """Draws the searchable regions, once for each decision."""

    def __init__(self, rows: Rows) -> None:
        """Start without regions."""
        self._rows = rows
        self._known: set[str] = set()

    def believed(self, belief: Belief, when: When, types: Mapping[str, ObjectType]) -> None:
        """Draw the outline and the unseen part of each region."""
        for name, region in belief.regions.items():
            entity = f"regions/{name}"
            if name not in self._known:
                self._known.add(name)
                for part in ("outline", "unseen"):
                    self._rows.static(f"{entity}/{part}", FRAME)
                self._rows.static(f"plots/seen/{name}", rr.SeriesLines(names=name, widths=2))
            self._draw(entity, when, belief, region, types)
            self._rows.add(f"plots/seen/{name}", when, rr.Scalars(region.seen))

    def _draw(
        self, entity: str, when: When, belief: Belief, region: RegionBelief, types: Mapping[str, ObjectType]
    ) -> None:
        support = belief.objects[region.support]
        world_T_support = support.world_T_object
        x, y, top = types[likeliest(support.type)].size_m
        turn = rr.Quaternion(xyzw=quaternion_xyzw(world_T_support[3]))
        outline = rr.Boxes3D(
            half_sizes=[[x / 2.0, y / 2.0, region.height_m / 2.0]],
            centers=[point_on(world_T_support, (0.0, 0.0, top + region.height_m / 2.0))],
            quaternions=[turn],
            colors=[OUTLINE],
            radii=[0.003],
            fill_mode="majorwireframe",
        )
        edge, centres = cubes(region, (x, y))
        unseen = rr.Boxes3D(
            half_sizes=[[edge / 2.0] * 3] * len(centres),
            centers=[point_on(world_T_support, (u, v, top + w)) for u, v, w in centres],
            quaternions=[turn] * len(centres),
            colors=[(*_ORANGE, round(min(_MOST, _OPACITY_M / edge)))] * len(centres),
            fill_mode="solid",
        )
        self._rows.add(f"{entity}/outline", when, outline)
        self._rows.add(f"{entity}/unseen", when, unseen)


def cubes(region: RegionBelief, face_m: tuple[float, float]) -> tuple[float, list[Xyz]]:
    """Return the edge and the centres of the cubes for the unseen part of a region.

    Args:
        region: The belief about the region.
        face_m: Length and width of its bottom face [m].

    Returns:
        The edge [m], and centres relative to the middle of that face [m]. Cubes are inside the region.
    """
    room = (*face_m, region.height_m)
    volume = region.hidden * math.prod(room)
    edge = min(max(_CRUMB_M, math.cbrt(volume / max(1, len(region.unseen_mm)))), *room)
    inside = [(-(side - edge) / 2.0, (side - edge) / 2.0) for side in face_m]
    low, high = zip(*inside, (edge / 2.0, region.height_m - edge / 2.0), strict=True)
    centres = np.clip(0.001 * np.array(region.unseen_mm, np.float64).reshape(-1, 3), low, high)
    return edge, [(x, y, z) for x, y, z in centres.tolist()]
