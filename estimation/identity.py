"""When two anchors turn out to be of one object, and when one turns out to have been of two.

Two upright things cannot stand in the same place. So anchors that are believed to overlap, at places that agree, are of
one object: it was met twice, say because the wheels had slipped in between. And an anchor over whose place a look shows
two things, neither of them there, was two all along: what was seen of either moved it to a place between them.
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
    """Which anchors are which, on the present belief."""

    graph: PoseGraph
    tracks: Tracks
    config: EstimatorConfig

    def merges(self, look: Looked) -> Iterator[Merged]:
        """Return which anchors are of one object, after a look at some; the one introduced first keeps its name."""
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
        """Return which anchors were two, before a look with these detections is taken in."""
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
        """Return the anchors that may be confused: things to grasp that are not held."""
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
        """Return the event; a heading tells nothing if the types differ or look alike all around."""
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
        """Return the distance of middles below which a thing and one at the anchor's place would overlap."""
        return _core(self.tracks.kind(anchor)) + _core(self.tracks.seen_as(thing))

    def _off(self, believed: tuple[float, float, float], covariance: Matrix, seen: Detection) -> tuple[float, float]:
        """Return how far a detection is from a believed place: in metres, and as a squared Mahalanobis distance."""
        place = flat(seen.base_T_object)
        off: Vector = np.array(place[:2]) - np.array(believed[:2])
        spread = turned(covariance, believed[2]) + turned(symmetric(seen.covariance), place[2])
        return float(np.hypot(*off)), float(off @ np.linalg.solve(spread[:2, :2], off))


def overlap(graph: PoseGraph, tracks: Tracks, config: EstimatorConfig, a: str, b: str) -> bool:
    """Return whether two anchors are, for sure, believed to stand in each other's place: one of them is not there."""
    one, two = tracks[a], tracks[b]
    height_sd = math.sqrt(one.z_variance + two.z_variance)
    if abs(one.z - two.z) > config.height_tolerance_m + 2.0 * height_sd:
        return False
    apart, spread = graph.apart(a, b)
    touching = _core(tracks.kind(a)) + _core(tracks.kind(b))
    return 1.0 - prob_in_polygon(apart, spread, disc(touching)) < config.merge_doubt


def _core(kind: ObjectType) -> float:
    """Return the radius of the largest upright cylinder inside an object, metres."""
    return min(kind.size_m[:2]) / 2.0
