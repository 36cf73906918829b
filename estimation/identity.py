"""Corrections of identity: two anchors of one object are merged, and one anchor of two objects is split.

Two upright objects cannot stand in the same place. So two anchors are of one object if they are believed to overlap and
their places agree. The object was met twice, for example because the wheels slipped in between. And an anchor has been
of two objects if a look shows two objects that overlap its place, but none at its place. Detections of both have
moved the anchor to a place between them.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Looked, Merged, Split
from skolem.estimation.fluents import disc, prob_in_polygon
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.se2 import Matrix, Vector, symmetric, turned
from skolem.estimation.tracks import Tracks
from skolem.traces.messages import Detection, ObjectType
from skolem.traces.messages.poses import flat


@dataclass(frozen=True, slots=True)
class Identity:
    """Finds corrections of identity in the present belief."""

    graph: PoseGraph
    tracks: Tracks
    config: EstimatorConfig

    def merges(self, look: Looked) -> Iterator[Merged]:
        """Yield the merges of anchors that a look has shown to be of one object; the older anchor keeps its name."""
        loose = self._loose()
        order = {anchor: i for i, anchor in enumerate(loose)}
        places = np.array([self.graph.mean(BASE, anchor)[:2] for anchor in loose]).reshape(-1, 2)
        taken: set[str] = set()
        for seen in (s.anchor for s in look.sightings if s.anchor in order):
            near = np.hypot(*(places - places[order[seen]]).T) < 2.0 * self._widest()
            for i in np.flatnonzero(near).tolist():
                other = loose[i]
                if other == seen or seen in taken or other in taken or not self._is_same(seen, other):
                    continue
                first, second = sorted((seen, other), key=order.__getitem__)
                taken |= {first, second}
                yield self._merged(first, second)

    def splits(self, detections: tuple[Detection, ...]) -> Iterator[Split]:
        """Yield the splits of anchors that have been of two objects, before the look of these detections is applied."""
        things = [d for d in detections if self.tracks.seen_as(d).graspable]
        anchors = self._loose() if len(things) > 1 else ()
        beliefs = {a: self.graph.relative(BASE, a) for a in anchors if self._is_near(a, things)}
        distances = {a: [self._off(*beliefs[a], d) for d in things] for a in beliefs}
        gate = self.config.place_gate
        free = [i for i in range(len(things)) if all(row[i][1] > gate for row in distances.values())]
        for anchor, row in distances.items():
            over = sorted(row[i][0] for i in free if row[i][0] < self._touching(anchor, things[i]))
            if len(over) > 1 and all(distance2 > gate for _, distance2 in row):
                yield Split(anchor=anchor, sd_m=over[1], sd_rad=self.config.unknown_heading_sd_rad)

    def _loose(self) -> tuple[str, ...]:
        """Return the anchors that may be confused: detectable graspable objects that no hand holds."""
        return tuple(anchor for anchor in self.tracks.detectable() if self.tracks.kind(anchor).graspable)

    def _widest(self) -> float:
        kinds = (kind for kind in self.tracks.prior.types.values() if kind.graspable)
        return max(_core(kind) for kind in kinds)

    # ------------------------------------------------------------ one object

    def _is_same(self, a: str, b: str) -> bool:
        """Return whether two anchors are believed to overlap, at places and heights that agree."""
        apart, spread = self.graph.apart(a, b)
        agree = float(apart @ np.linalg.solve(spread, apart)) <= self.config.place_gate
        return agree and overlap(self.graph, self.tracks, self.config, a, b)

    def _merged(self, anchor: str, other: str) -> Merged:
        """Return the merge; the other heading is unknown if the types differ, or if they look the same all around."""
        kind = self.tracks.kind(anchor)
        if kind.shape == "cylinder" or kind != self.tracks.kind(other):
            return Merged(anchor=anchor, other=other, turn=0.0, sd_rad=self.config.unknown_heading_sd_rad)
        period = math.pi / 2.0 if kind.size_m[0] == kind.size_m[1] else math.pi
        turn = period * round(self.graph.mean(anchor, other)[2] / period)
        return Merged(anchor=anchor, other=other, turn=turn, sd_rad=self.config.table_sd_rad)

    # ------------------------------------------------------------ two objects

    def _is_near(self, anchor: str, things: list[Detection]) -> bool:
        x, y, _ = self.graph.mean(BASE, anchor)
        return any(math.dist((x, y), d.base_T_object[:2]) < 4.0 * self._widest() for d in things)

    def _touching(self, anchor: str, thing: Detection) -> float:
        """Return the distance of middles, metres, below which a detected object and the anchor's would overlap."""
        return _core(self.tracks.kind(anchor)) + _core(self.tracks.seen_as(thing))

    def _off(self, believed: tuple[float, float, float], covariance: Matrix, seen: Detection) -> tuple[float, float]:
        """Return the distance of a detection from a believed place, in metres and as a squared Mahalanobis distance."""
        place = flat(seen.base_T_object)
        off: Vector = np.array(place[:2]) - np.array(believed[:2])
        spread = turned(covariance, believed[2]) + turned(symmetric(seen.covariance), place[2])
        return float(np.hypot(*off)), float(off @ np.linalg.solve(spread[:2, :2], off))


def overlap(graph: PoseGraph, tracks: Tracks, config: EstimatorConfig, a: str, b: str) -> bool:
    """Return whether two anchors surely overlap by the belief, so that one of them cannot be there."""
    one, two = tracks[a], tracks[b]
    height_sd = math.sqrt(one.z_variance + two.z_variance)
    if abs(one.z - two.z) > config.height_tolerance_m + 2.0 * height_sd:
        return False
    apart, spread = graph.apart(a, b)
    touching = _core(tracks.kind(a)) + _core(tracks.kind(b))
    return 1.0 - prob_in_polygon(apart, spread, disc(touching)) < config.merge_doubt


def _core(kind: ObjectType) -> float:
    """Return the radius, in metres, of the largest upright cylinder inside an object."""
    return min(kind.size_m[:2]) / 2.0
