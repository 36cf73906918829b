"""The event of a look: the anchor of each detection, the new objects, and the missed detections."""

import math
from dataclasses import dataclass

import numpy as np

from skolem.estimation.association import (
    MAX_LOG_ODDS,
    Match,
    Measured,
    Pair,
    Scene,
    assign,
    assign_jointly,
    is_ambiguous,
    match,
    with_heading_near,
)
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.coverage import Array, Mask
from skolem.estimation.events import Looked, Missed, Place, Sighting, canonical_order
from skolem.estimation.extrinsics import camera_covariance, own_covariance, sighting_z_sd
from skolem.estimation.fluents import prob_in_polygon, rectangle
from skolem.estimation.identity import overlap
from skolem.estimation.places import believed_places, is_sought, missed_at_places
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.regions import Regions
from skolem.estimation.se2 import Matrix, between, symmetric, turned, upper
from skolem.estimation.tracks import Tracks
from skolem.estimation.unexplained import near_arms
from skolem.estimation.visibility import DepthImage, is_solid, outline_radius, prob_visible_and_solid, shows_behind
from skolem.traces.messages import Detection, NoiseModel, ObjectType, Observation, Pose2
from skolem.traces.messages.poses import flat

LIKELY = 0.5  # least probability that a table is below a new object, if the object is to stand on it


@dataclass(frozen=True, slots=True)
class Expected:
    """The believed base_T_object of an anchor, and its covariance, (3, 3), object frame."""

    anchor: str
    base_T_object: Pose2
    covariance: Matrix


class Look:
    """The interpretation of one look, given the belief before it."""

    def __init__(
        self, observation: Observation, graph: PoseGraph, tracks: Tracks, regions: Regions, config: EstimatorConfig
    ) -> None:
        self._graph, self._tracks, self._regions, self._config = graph, tracks, regions, config
        self._noise: NoiseModel = tracks.prior.noise
        self._graspable = [kind for kind in tracks.prior.types.values() if kind.graspable]
        self._view = observation.view
        self._detections = canonical_order(observation.detections)
        self._expected = tuple(Expected(a, *graph.relative(BASE, a)) for a in tracks.detectable())
        self._can_be_new = [self._is_beside_all(detection) for detection in self._detections]
        self._gates = [config.gate if new else config.sure_gate for new in self._can_be_new]
        self._sought: dict[str, tuple[Place, ...]] = {}
        self._image = None if self._view is None else DepthImage.of(self._view)
        self._camera = np.array([0.0, 0.0, config.typical_drop_m]) if self._image is None else self._image.origin
        heights = [self._height(detection) for detection in self._detections]
        drop = float(self._camera[2]) - sum(heights) / len(heights) if heights else config.typical_drop_m
        self._camera_covariance = camera_covariance(self._noise, self._camera[:2], drop)

    def event(self) -> Looked:
        """Return the event of the look: sightings, and missed detections."""
        matches = [[self._match(d, e) for e in self._expected] for d in self._detections]
        scores = np.array(
            [
                [self._score(d, e, m, gate) for e, m in zip(self._expected, row, strict=True)]
                for d, row, gate in zip(self._detections, matches, self._gates, strict=True)
            ]
        )
        unmatched = np.array([self._unmatched(d) for d in self._detections])
        columns = self._assigned(scores.reshape(len(self._detections), len(self._expected)), matches, unmatched)
        met = [column is not None or new for column, new in zip(columns, self._can_be_new, strict=True)]
        names = iter(self._tracks.new_names(columns.count(None)))
        sightings = tuple(
            self._new(detection, next(names))
            if column is None
            else self._known(detection, self._expected[column], row[column])
            for detection, column, row, keep in zip(self._detections, columns, matches, met, strict=True)
            if keep
        )
        missed = tuple(self._missed(e, sightings) for i, e in enumerate(self._expected) if i not in columns)
        return Looked(
            camera_covariance=upper(self._camera_covariance),
            sightings=sightings,
            missed=tuple(miss for miss in missed if miss.p_reported > 0.0),
            view=self._view,
        )

    def _table(self, detection: Detection) -> ObjectType | None:
        """Return the type of a detected table, or None for another object."""
        kind = self._tracks.seen_as(detection)
        return kind if kind.shape == "table" else None

    def _height(self, detection: Detection) -> float:
        """Return the height, in metres, of a detected object's base, or of a detected table's top."""
        table = self._table(detection)
        return detection.base_T_object[2] + (table.size_m[2] if table else 0.0)

    # ------------------------------------------------------------ scores

    def _measured(self, detection: Detection, expected: Expected) -> Measured:
        measured = Measured(flat(detection.base_T_object), symmetric(detection.covariance))
        kind, seen_as = self._tracks.kind(expected.anchor), self._tracks.seen_as(detection)
        unknown = self._config.unknown_heading_sd_rad
        return with_heading_near(measured, expected.base_T_object[2], kind, seen_as, unknown)

    def _match(self, detection: Detection, expected: Expected) -> Match:
        return match(expected.base_T_object, expected.covariance, self._measured(detection, expected))

    def _score(self, detection: Detection, expected: Expected, m: Match, gate: float) -> float:
        """Return the log-likelihood ratio of "the detection is of this anchor" to "the anchor was not detected"."""
        is_table = self._tracks.kind(expected.anchor).shape == "table"
        if m.distance2 > gate or is_table != (self._table(detection) is not None):
            return -math.inf
        if not is_table and not self._at_height(detection, expected.anchor):
            return -math.inf
        reported = self._tracks[expected.anchor].exists * self._noise.found
        if reported <= 0.0:  # the detector finds nothing
            return -math.inf
        return self._log_likelihood(detection, expected, m) + math.log(reported / (1.0 - reported))

    def _at_height(self, detection: Detection, anchor: str) -> bool:
        """Return whether the height of a detected object agrees with the believed height of an anchor."""
        track = self._tracks[anchor]
        sd = math.sqrt(self._z_sd(detection) ** 2 + track.z_variance)
        return abs(detection.base_T_object[2] - track.z) <= self._config.height_tolerance_m + 2.0 * sd

    def _log_likelihood(self, detection: Detection, expected: Expected, m: Match) -> float:
        evidence = self._tracks[expected.anchor].types.evidence(detection.type_log_likelihood)
        return m.log_density + math.log(max(evidence, 1e-300))

    def _unmatched(self, detection: Detection) -> float:
        """Return the log density of detections without an anchor, over place, heading and detected type."""
        types = self._tracks.prior.types.values()
        if self._table(detection):
            rate, kinds = self._config.new_tables_per_look, sum(kind.shape == "table" for kind in types)
        else:
            rate = self._false_per_look(detection) + self._config.new_per_look
            kinds = sum(kind.graspable for kind in types)
        return math.log(rate / (self._config.view_area_m2 * math.tau * kinds))

    def _false_per_look(self, detection: Detection) -> float:
        """Return the expected number of false detections per look, given the depth image at the place of this one.

        It is greater if the image shows the space behind the place, whatever the type of an object there would be. It
        is less if the image shows something solid in the place, because few false detections coincide with an object.
        """
        if self._image is None:
            return self._noise.false_per_look
        image, place, config = self._image, detection.base_T_object, self._config
        if all(shows_behind(image, place, kind, config) for kind in self._graspable):
            return self._noise.false_per_look * config.refuted
        at, kind = np.array(place[:3]), self._tracks.seen_as(detection)
        shown = is_solid(image, at, kind, config, lambda ends: near_arms(ends, self._graph.robot, config.arm_m))
        return self._noise.false_per_look * (config.coincidence if shown else 1.0)

    def _assigned(self, scores: Array, matches: list[list[Match]], unmatched: Array) -> tuple[int | None, ...]:
        """Return each detection's column in the best assignment; a joint one if a detection could be of several."""
        if not self._config.hypotheses or not is_ambiguous(scores):
            return assign(scores, unmatched)
        columns = np.flatnonzero(np.isfinite(scores).any(axis=0)).tolist()
        pairs = [
            [
                Pair(j, self._own(detection, self._expected[c]), float(row[c]) - found[c].log_density)
                for j, c in enumerate(columns)
                if np.isfinite(row[c])
            ]
            for detection, row, found in zip(self._detections, scores, matches, strict=True)
        ]
        chosen = assign_jointly(self._scene(columns), pairs, unmatched, self._gates, self._config.hypotheses)
        return tuple(None if j is None else columns[j] for j in chosen)

    def _own(self, detection: Detection, expected: Expected) -> Measured:
        """Return a detected pose with the part of its covariance that it shares with no other detection."""
        measured = self._measured(detection, expected)
        return Measured(measured.base_T_object, own_covariance(measured, self._camera_covariance, self._config))

    def _scene(self, columns: list[int]) -> Scene:
        """Return the joint belief on some expected anchors and on the base, to which the camera's error is added."""
        joint = self._graph.joint((BASE, *(self._expected[c].anchor for c in columns)))
        covariance = joint.covariance.copy()
        covariance[:3, :3] += self._camera_covariance
        return Scene(joint.world_T_body, covariance)

    # ------------------------------------------------------------ outcomes

    def _known(self, detection: Detection, expected: Expected, m: Match) -> Sighting:
        log_odds = self._log_likelihood(detection, expected, m) - self._unmatched(detection)
        log_odds += math.log(self._noise.found)
        track = self._tracks[expected.anchor]
        lost = (track.support is None or bool(track.places)) and not self._table(detection)
        support = self._support_under(detection) if lost else None
        measured = self._measured(detection, expected)
        return self._sighting(detection, measured, expected.anchor, False, support, math.exp(log_odds))

    def _is_beside_all(self, detection: Detection) -> bool:
        """Return whether a detection without an anchor can be of an object that nobody has met.

        A detected table can if it is clearly beside every known table. Tables do not overlap, so the distance of two
        middles is at least the sum of half the widths of both.
        """
        kind = self._table(detection)
        if kind is None:
            return True
        own = float(np.linalg.eigvalsh(symmetric(detection.covariance)[:2, :2])[-1])
        for expected in self._expected:
            other = self._tracks.kind(expected.anchor)
            if other.shape == "table":
                spread = own + float(np.linalg.eigvalsh(expected.covariance[:2, :2])[-1])
                apart = math.dist(detection.base_T_object[:2], expected.base_T_object[:2])
                least = (min(kind.size_m[:2]) + min(other.size_m[:2])) / 2.0
                if apart - math.sqrt(self._config.gate * spread) < least:
                    return False
        return True

    def _new(self, detection: Detection, name: str) -> Sighting:
        measured = Measured(flat(detection.base_T_object), symmetric(detection.covariance))
        if self._table(detection):
            return self._sighting(detection, measured, name, True, None, math.exp(MAX_LOG_ODDS))
        support = self._support_under(detection)
        return self._sighting(detection, measured, name, True, support, self._odds_of_real(detection, support))

    def _odds_of_real(self, detection: Detection, support: str | None) -> float:
        """Return the odds that a detection without an anchor is of a new object and not false."""
        new, false = self._config.new_per_look, self._false_per_look(detection)
        if support is not None:
            support_T_object = between(self._graph.mean(BASE, support), flat(detection.base_T_object))
            new += self._regions.unmet_per_m2(support, support_T_object) * self._config.view_area_m2
        return min(new / max(false, 1e-300), math.exp(MAX_LOG_ODDS))

    def _sighting(
        self, detection: Detection, measured: Measured, anchor: str, new: bool, support: str | None, odds: float
    ) -> Sighting:
        return Sighting(
            anchor=anchor,
            new=new,
            support=support,
            camera_T_object=measured.base_T_object,
            covariance=upper(own_covariance(measured, self._camera_covariance, self._config)),
            z=0.0 if self._table(detection) else detection.base_T_object[2],
            z_sd_m=self._config.height_sd_m if self._table(detection) else self._z_sd(detection),
            odds=odds,
            detection=detection,
        )

    def _z_sd(self, detection: Detection) -> float:
        x, y, _, _ = detection.base_T_object
        return sighting_z_sd(self._noise, math.hypot(x - self._camera[0], y - self._camera[1]), self._config)

    def _support_under(self, detection: Detection) -> str | None:
        """Return the table that most likely supports a detected object, or None if none is likely."""
        pose, spread = flat(detection.base_T_object), symmetric(detection.covariance)
        z, z_variance = detection.base_T_object[2], self._z_sd(detection) ** 2
        best, best_probability = None, LIKELY
        for name in self._tracks.likely():
            kind = self._tracks.kind(name)
            if kind.shape != "table" or not self._tracks.rests_at(z, z_variance, name):
                continue
            base_T_table, covariance = self._graph.relative(BASE, name)
            table_T_object = between(base_T_table, pose)
            total = turned(spread, table_T_object[2])[:2, :2] + covariance[:2, :2]
            probability = prob_in_polygon(np.array(table_T_object[:2]), total, rectangle(kind.size_m[:2]))
            if probability > best_probability:
                best, best_probability = name, probability
        return best

    def _missed(self, expected: Expected, sightings: tuple[Sighting, ...]) -> Missed:
        track, kind = self._tracks[expected.anchor], self._tracks.kind(expected.anchor)
        if self._image is None or kind.shape == "table":
            return Missed(anchor=expected.anchor, p_reported=0.0)
        if any(self._stands_in(s, expected) for s in sightings):
            return Missed(anchor=expected.anchor, p_reported=self._noise.found)
        if is_sought(self._graph, self._tracks, expected.anchor, self._config):
            places = believed_places(self._graph, self._tracks, expected.anchor, self._config)
            if places:
                return self._silent(expected.anchor, places, sightings, self._image)
        there = (expected.base_T_object, expected.covariance, track.z, kind, self._config)
        visible, solid = prob_visible_and_solid(
            self._image, *there, lambda ends: self._explained(ends, expected.anchor, sightings)
        )
        p_reported = min(1.0, visible * self._noise.found)
        return Missed(anchor=expected.anchor, p_reported=p_reported, solid=min(1.0, solid))

    def _silent(
        self, anchor: str, places: tuple[Place, ...], sightings: tuple[Sighting, ...], image: DepthImage
    ) -> Missed:
        """Return the missed detection of an object with weighted places, and keep its places after the look."""
        said = missed_at_places(
            places,
            image,
            self._graph,
            self._tracks,
            anchor,
            self._config,
            lambda ends: self._explained(ends, anchor, sightings),
        )
        if said.p_reported > 0.0:
            self._sought[anchor] = said.places
        rests = self._tracks[anchor].rests
        return Missed(anchor=anchor, p_reported=rests * said.p_reported, solid=rests * said.solid)

    def sought(self) -> dict[str, tuple[Place, ...]]:
        """Return the weighted places, after the look, of each missed object with an uncertain place.

        They are known once `event` was called.
        """
        return dict(self._sought)

    def _stands_in(self, seen: Sighting, missed: Expected) -> bool:
        """Return whether a known object was detected in the place of a missed one, which then is not just hidden."""
        kind, other = self._tracks.seen_as(seen.detection), self._tracks.kind(missed.anchor)
        apart = math.dist(seen.detection.base_T_object[:2], missed.base_T_object[:2])
        if seen.new or not kind.graspable or apart > outline_radius(kind) + outline_radius(other):
            return False
        return overlap(self._graph, self._tracks, self._config, seen.anchor, missed.anchor)

    def _explained(self, ends: Array, missed: str, sightings: tuple[Sighting, ...]) -> Mask:
        """Return the mask, shape (n,), of readings that have hit an arm, a detected object or another known object.

        A reading is given by its end, shape (n, 3), base frame.
        """
        explained = near_arms(ends, self._graph.robot, self._config.arm_m)
        seen = {sighting.anchor: sighting for sighting in sightings}
        known = [name for name in self._tracks.likely() if name not in seen and name != missed]
        others = [(flat(s.detection.base_T_object), self._tracks.seen_as(s.detection)) for s in sightings]
        others += [(self._graph.mean(BASE, a), self._tracks.kind(a)) for a in known if not self._tracks[a].hand]
        for place, kind in others:
            if kind.shape != "table":
                beside = np.hypot(*(ends[:, :2] - place[:2]).T)
                explained |= beside <= outline_radius(kind) + self._config.depth_margin_m
        return explained
