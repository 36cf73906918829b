"""Regions of space in a rerun recording: their outlines, and cubes spread over the part that has not been seen."""

from collections.abc import Mapping

import rerun as rr

from skolem.traces.messages import Belief, ObjectType, RegionBelief
from skolem.traces.rerun_belief import likely_type
from skolem.traces.rerun_rows import Rows, When
from skolem.traces.rerun_shapes import FRAME, OUTLINE, point_on, turned

_UNSEEN = (255, 140, 0, 110)
_CUBE_M = 0.025  # half an edge


class Regions:
    """Draws the searchable regions, once per decision."""

    def __init__(self, rows: Rows) -> None:
        """Begin without regions."""
        self._rows = rows
        self._known: set[str] = set()

    def believed(self, belief: Belief, when: When, types: Mapping[str, ObjectType]) -> None:
        """Draw what has been seen of each region and what not."""
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
        x, y, top = types[likely_type(support)].size_m
        turn = rr.Quaternion(xyzw=turned(world_T_support[3]))
        outline = rr.Boxes3D(
            half_sizes=[[x / 2.0, y / 2.0, region.height_m / 2.0]],
            centers=[point_on(world_T_support, (0.0, 0.0, top + region.height_m / 2.0))],
            quaternions=[turn],
            colors=[OUTLINE],
            radii=[0.003],
            fill_mode="majorwireframe",
        )
        points = [point_on(world_T_support, (0.001 * x, 0.001 * y, top + 0.001 * z)) for x, y, z in region.unseen_mm]
        unseen = rr.Boxes3D(
            half_sizes=[[_CUBE_M] * 3] * len(points),
            centers=points,
            quaternions=[turn] * len(points),
            colors=[_UNSEEN] * len(points),
            fill_mode="solid",
        )
        self._rows.add(f"{entity}/outline", when, outline)
        self._rows.add(f"{entity}/unseen", when, unseen)
