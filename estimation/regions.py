"""The belief on regions, which are boxes of air above the tops of supports.

A voxel is known once a depth reading lies beyond it, or once a known object fills it. A direction without a reading
proves nothing, and the space behind an object stays unknown until a look from another side. If a reading ends in a
region, but not on a believed object, the region holds something that nobody has met.
"""

import math
from collections.abc import Iterable, Set
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.coverage import Array, Coverage, Grid, Mask
from skolem.estimation.events import Began, Event, Gone, Looked, Lost
from skolem.estimation.pose_graph import BASE, PoseGraph
from skolem.estimation.tracks import Tracks
from skolem.estimation.unexplained import Unexplained, near_arms
from skolem.estimation.visibility import DepthImage, prob_visible
from skolem.traces.errors import InternalError
from skolem.traces.messages import ObjectType, Pose2, Pose4, PriorRegion, RegionBelief, RobotState, Strangers
from skolem.traces.messages.poses import raised

EXACTLY = np.zeros((3, 3))  # covariance of an exact pose


@dataclass(frozen=True, slots=True)
class Region:
    """A region of the prior with its base area (square metres), its known part, and the unexplained hits in it."""

    prior: PriorRegion
    area_m2: float
    coverage: Coverage
    unexplained: Unexplained


@dataclass(frozen=True, slots=True)
class Standing:
    """An object on or near a support: its type, its pose in the frame of the support's top, and its height (metres)."""

    anchor: str
    kind: ObjectType
    top_T_object: Pose2
    z: float


class Regions:
    """All regions, in order of introduction."""

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self._found, self._hit_margin_m = 1.0, config.hit_margin_m
        self._regions: dict[str, Region] = {}

    def apply(self, event: Event, graph: PoseGraph, tracks: Tracks) -> None:
        """Take in one event, after `graph` and `tracks` have taken it in."""
        if isinstance(event, Began):
            noise, config = event.prior.noise, self._config
            self._found = noise.found
            lever = math.hypot(config.typical_range_m, config.typical_drop_m)
            off_sd = math.hypot(noise.extrinsics_sd_m, noise.extrinsics_sd_rad * lever)
            self._hit_margin_m = config.hit_margin_m + config.hit_sds * off_sd
            self._regions = {prior.anchor: self._unseen(prior, tracks) for prior in event.prior.regions}
        elif isinstance(event, Lost | Gone):  # the object may now stand in a part that was seen to be empty
            self._regions = {name: self._unseen(region.prior, tracks) for name, region in self._regions.items()}
        elif isinstance(event, Looked) and event.view is not None:
            image = DepthImage.of(event.view)
            sighted = frozenset(sighting.anchor for sighting in event.sightings)
            self._regions = {
                name: self._looked(region, image, sighted, graph, tracks) for name, region in self._regions.items()
            }

    def _unseen(self, prior: PriorRegion, tracks: Tracks) -> Region:
        x, y, _ = tracks.kind(prior.support).size_m
        grid = Grid((x, y, prior.height_m), self._config.voxel_m)
        sizes = (kind.size_m for kind in tracks.prior.types.values() if kind.graspable)
        window = grid.window(min(sizes, key=lambda size: (math.prod(size), size)))
        nowhere = np.zeros(len(grid.centres), dtype=bool)
        return Region(prior, x * y, Coverage(grid, window, nowhere), Unexplained.nothing(grid))

    def _looked(self, region: Region, image: DepthImage, sighted: Set[str], graph: PoseGraph, tracks: Tracks) -> Region:
        """Return a region after a look; its support is taken to stand at its mean pose."""
        support, grid, config = region.prior.support, region.coverage.grid, self._config
        base_T_top = raised(graph.mean(BASE, support), tracks.top(support))
        believed = [s for s in self._standing(support, graph, tracks) if tracks[s.anchor].exists >= config.likely]
        known = [s for s in believed if s.anchor in sighted or not s.kind.graspable]
        asked = np.flatnonzero(~region.coverage.known | (region.unexplained.hits > 0))
        beyond = np.full(len(grid.centres), -np.inf)
        beyond[asked] = _room_beyond(image, _placed(grid.centres[asked], base_T_top), config.sight_m)
        filled = _inside(grid, known, config.voxel_m / 2.0)
        explained = _inside(grid, believed, self._hit_margin_m)
        hits = self._hits(grid, image, base_T_top, graph.robot) * ~explained
        kind = tracks.prior.types[tracks.stranger().types.most_likely()]

        def p_reported(top_middle: Array) -> float:
            x, y, _ = _placed(top_middle[None], base_T_top)[0]
            return self._found * prob_visible(image, (x, y, 0.0), EXACTLY, base_T_top[2], kind, config)

        is_thing = region.prior.expected_objects / (region.prior.expected_objects + config.other_solids)
        return Region(
            region.prior,
            region.area_m2,
            region.coverage.with_known((beyond >= -config.voxel_margin_m) | filled),
            region.unexplained.after(hits, explained | (beyond >= config.voxel_m), grid, p_reported, is_thing),
        )

    def _standing(self, support: str, graph: PoseGraph, tracks: Tracks) -> list[Standing]:
        """Return the objects that may stand on a support, or beside it and reach over it."""
        found, below = [], tracks.kind(support)
        for anchor in tracks.possible():
            track, kind = tracks[anchor], tracks.kind(anchor)
            if anchor == support or track.hand:
                continue
            top_T_object = graph.mean(support, anchor)
            if math.hypot(*top_T_object[:2]) <= _half_diagonal(below) + _half_diagonal(kind) + self._hit_margin_m:
                found.append(Standing(anchor, kind, top_T_object, track.z - tracks.top(support)))
        return found

    def _hits(self, grid: Grid, image: DepthImage, base_T_top: Pose4, robot: RobotState) -> NDArray[np.int64]:
        """Return the number of readings in each voxel, shape (n,), that ended above the support and not on an arm."""
        hits = _seen_from(base_T_top, image.hits)
        kept = np.flatnonzero(grid.contains(hits) & (hits[:, 2] >= self._hit_margin_m))
        kept = kept[((image.hits[kept] - image.origin) ** 2).sum(axis=1) <= self._config.sight_m**2]
        kept = kept[~near_arms(image.hits[kept], robot, self._config.arm_m)]
        return grid.count(hits[kept])

    # ------------------------------------------------------------ questions

    def names(self) -> tuple[str, ...]:
        """Return the anchors of all regions."""
        return tuple(self._regions)

    def __getitem__(self, region: str) -> Region:
        if region not in self._regions:
            raise InternalError(f"no region '{region}'; there are: {', '.join(self._regions)}")
        return self._regions[region]

    def prob_exists_in(self, region: str, match: float) -> float:
        """Return P(an unmet object with a property is in the region); an unmet object has it with probability `match`.

        Unmet objects are a Poisson process over the places of the region. The prior states their expected number. Each
        has the property independently. Places that have been seen hold none. Unexplained hits may be one.
        """
        found = self._strangers(self[region])
        return 1.0 - math.exp(-found.expected * match) * (1.0 - match * found.overlooked)

    def strangers(self) -> tuple[Strangers, ...]:
        """Return the unmet objects of each region, in order of introduction."""
        return tuple(map(self._strangers, self._regions.values()))

    def _strangers(self, at: Region) -> Strangers:
        expected = at.prior.expected_objects * at.coverage.hidden
        return Strangers(support=at.prior.support, expected=expected, overlooked=self._overlooked(at))

    def prob_contents(self, region: str) -> float:
        """Return the known share of a region, times P(no unmet object is among the unexplained hits).

        The share is that of known voxels or that of places where no object fits, whichever is less: a small unseen part
        can be just the place where an object fits.
        """
        at = self[region]
        return min(at.coverage.contents, 1.0 - at.coverage.hidden) * (1.0 - self._overlooked(at))

    def _overlooked(self, at: Region) -> float:
        return at.unexplained.prob_overlooked(at.coverage.grid, self._config)

    def unmet_per_m2(self, support: str, support_T_object: Pose2) -> float:
        """Return the expected number of unmet objects per square metre around a place on a support."""
        x, y, _ = support_T_object
        return sum(
            at.prior.expected_objects / at.area_m2 * at.coverage.unknown_around(x, y)
            for at in self._regions.values()
            if at.prior.support == support
        )

    def messages(self) -> dict[str, RegionBelief]:
        """Return the belief on each region as a message, for a snapshot."""
        return {name: self._message(name) for name in self._regions}

    def _message(self, name: str) -> RegionBelief:
        at = self[name]
        points = at.coverage.unknown_points(self._config.unseen_points, also=at.unexplained.hits > 0)
        points_mm = np.rint(1000.0 * points).astype(int).tolist()
        return RegionBelief(
            support=at.prior.support,
            height_m=at.prior.height_m,
            seen=self.prob_contents(name),
            hidden=at.coverage.hidden,
            unseen_mm=tuple((x, y, z) for x, y, z in points_mm),
        )


def _half_diagonal(kind: ObjectType) -> float:
    return math.hypot(*kind.size_m[:2]) / 2.0


def _inside(grid: Grid, things: Iterable[Standing], margin_m: float) -> Mask:
    """Return the mask, shape (n,), of voxels in one of the objects or within a margin of its sides and top."""
    inside = np.zeros(len(grid.centres), dtype=bool)
    for thing in things:
        inside |= grid.inside(thing.kind, thing.top_T_object, thing.z, margin_m)
    return inside


def _room_beyond(image: DepthImage, points_base: Array, sight_m: float) -> Array:
    """Return the distance, shape (n,), metres, from points, (n, 3), on to the depth reading in their direction.

    It is minus infinity for a point outside of the image, without a reading, or too far away for the detector.
    """
    forward, depth = image.read(points_base)
    near = ((points_base - image.origin) ** 2).sum(axis=1) <= sight_m**2
    return np.where((depth > 0.0) & near, depth - forward, -np.inf)


def _placed(points: Array, base_T_top: Pose4) -> Array:
    """Return points of the frame of a support's top, shape (n, 3), in the base frame."""
    return np.asarray(points @ _turn(base_T_top[3]).T + base_T_top[:3])


def _seen_from(base_T_top: Pose4, points_base: Array) -> Array:
    """Return points of the base frame, shape (n, 3), in the frame of a support's top."""
    return np.asarray((points_base - base_T_top[:3]) @ _turn(base_T_top[3]))


def _turn(theta: float) -> Array:
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
