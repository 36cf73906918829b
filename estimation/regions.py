"""What is known of the regions that may be searched: the air above the tops of supports.

A voxel is known once a depth reading lies beyond it, or once it belongs to an object that is known. Directions without
a reading prove nothing, and what lies behind an object stays unknown until it is looked at from elsewhere. A reading
that ends in a region on nothing that is believed to be there says that the region holds something not yet met.
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
from skolem.traces.messages import ObjectType, Pose2, Pose4, PriorRegion, RegionBelief, RobotState
from skolem.traces.messages.poses import raised

EXACTLY = np.zeros((3, 3))  # the covariance of a place that is given


@dataclass(frozen=True, slots=True)
class Region:
    """A region as it was told, the area it stands on in square metres, what is known of it, and what puzzles in it."""

    told: PriorRegion
    area_m2: float
    coverage: Coverage
    unexplained: Unexplained


@dataclass(frozen=True, slots=True)
class Standing:
    """Something believed to stand near a support: where, in the frame of the support's top, and of which type."""

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
        """Take in one event, after `graph` and `tracks` have."""
        if isinstance(event, Began):
            noise, config = event.prior.noise, self._config
            self._found = noise.found
            lever = math.hypot(config.typical_range_m, config.typical_drop_m)
            off_sd = math.hypot(noise.extrinsics_sd_m, noise.extrinsics_sd_rad * lever)
            self._hit_margin_m = config.hit_margin_m + config.hit_sds * off_sd
            self._regions = {told.anchor: self._unseen(told, tracks) for told in event.prior.regions}
        elif isinstance(event, Lost | Gone):  # it may have been put where nothing was when one looked
            self._regions = {name: self._unseen(region.told, tracks) for name, region in self._regions.items()}
        elif isinstance(event, Looked) and event.view is not None:
            image = DepthImage.of(event.view)
            sighted = frozenset(sighting.anchor for sighting in event.sightings)
            self._regions = {
                name: self._looked(region, image, sighted, graph, tracks) for name, region in self._regions.items()
            }

    def _unseen(self, told: PriorRegion, tracks: Tracks) -> Region:
        x, y, _ = tracks.kind(told.support).size_m
        grid = Grid((x, y, told.height_m), self._config.voxel_m)
        sizes = (kind.size_m for kind in tracks.prior.types.values() if kind.graspable)
        window = grid.window(min(sizes, key=lambda size: (math.prod(size), size)))
        nowhere = np.zeros(len(grid.centres), dtype=bool)
        return Region(told, x * y, Coverage(grid, window, nowhere), Unexplained.nothing(grid))

    def _looked(self, region: Region, image: DepthImage, sighted: Set[str], graph: PoseGraph, tracks: Tracks) -> Region:
        """Return a region after a look; its support counts as being where it is on average."""
        support, grid, config = region.told.support, region.coverage.grid, self._config
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

        is_thing = region.told.expected_objects / (region.told.expected_objects + config.other_solids)
        return Region(
            region.told,
            region.area_m2,
            region.coverage.with_known((beyond >= -config.voxel_margin_m) | filled),
            region.unexplained.after(hits, explained | (beyond >= config.voxel_m), grid, p_reported, is_thing),
        )

    def _standing(self, support: str, graph: PoseGraph, tracks: Tracks) -> list[Standing]:
        """Return what may stand on a support, or beside it and reach over it."""
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
        """Return how many readings ended in each voxel, shape (n,), on things above the support but the own arms."""
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
        """Return P(an object nobody has met is there and has a property that an arbitrary one has with p = `match`).

        Unmet objects are a Poisson process: as many as were told are expected over all places of the region, each with
        the property independently, and those at places that have been seen are ruled out. What was seen there and is
        not explained may be one.
        """
        at = self[region]
        none_hidden = math.exp(-at.told.expected_objects * at.coverage.hidden * match)
        return 1.0 - none_hidden * (1.0 - match * self._overlooked(at))

    def prob_contents(self, region: str) -> float:
        """Return the part of a region that is known, times P(no unmet object is among what was seen).

        Little unseen space can be the very place where an object still fits: where it does not is what is known.
        """
        at = self[region]
        return min(at.coverage.contents, 1.0 - at.coverage.hidden) * (1.0 - self._overlooked(at))

    def _overlooked(self, at: Region) -> float:
        return at.unexplained.prob_overlooked(at.coverage.grid, self._config)

    def unmet_per_m2(self, support: str, support_T_object: Pose2) -> float:
        """Return how many objects nobody has met are expected per square metre around a place on a support."""
        x, y, _ = support_T_object
        return sum(
            at.told.expected_objects / at.area_m2 * at.coverage.unknown_around(x, y)
            for at in self._regions.values()
            if at.told.support == support
        )

    def messages(self) -> dict[str, RegionBelief]:
        """Return what is known of each region, for a snapshot."""
        return {name: self._message(name) for name in self._regions}

    def _message(self, name: str) -> RegionBelief:
        at = self[name]
        points = at.coverage.unknown_points(self._config.unseen_points, also=at.unexplained.hits > 0)
        points_mm = np.rint(1000.0 * points).astype(int).tolist()
        return RegionBelief(
            support=at.told.support,
            height_m=at.told.height_m,
            seen=self.prob_contents(name),
            hidden=at.coverage.hidden,
            unseen_mm=tuple((x, y, z) for x, y, z in points_mm),
        )


def _half_diagonal(kind: ObjectType) -> float:
    return math.hypot(*kind.size_m[:2]) / 2.0


def _inside(grid: Grid, things: Iterable[Standing], margin_m: float) -> Mask:
    """Return which voxels are in one of the things or within a margin of its sides and top, shape (n,)."""
    inside = np.zeros(len(grid.centres), dtype=bool)
    for thing in things:
        inside |= grid.inside(thing.kind, thing.top_T_object, thing.z, margin_m)
    return inside


def _room_beyond(image: DepthImage, points_base: Array, sight_m: float) -> Array:
    """Return how much farther than points, shape (n, 3), the camera saw in their directions, metres, shape (n,).

    Minus infinity where it saw nothing: outside of the image, without a return, or too far away for the detector.
    """
    forward, depth = image.read(points_base)
    near = ((points_base - image.origin) ** 2).sum(axis=1) <= sight_m**2
    return np.where((depth > 0.0) & near, depth - forward, -np.inf)


def _placed(points: Array, base_T_top: Pose4) -> Array:
    """Return points given in the frame of a support's top, shape (n, 3), in the base frame."""
    return np.asarray(points @ _turn(base_T_top[3]).T + base_T_top[:3])


def _seen_from(base_T_top: Pose4, points_base: Array) -> Array:
    """Return points of the base frame, shape (n, 3), in that of a support's top."""
    return np.asarray((points_base - base_T_top[:3]) @ _turn(base_T_top[3]))


def _turn(theta: float) -> Array:
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
