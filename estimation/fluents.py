"""Tests on Gaussian beliefs: probability mass in a polygon, comparison of covariances, and relations of many objects.

The geometry of several relations is that of `Belief.prob_on` and `Belief.prob_near`: places are linear in the tangents
of the poses. So one standard normal vector, through the Cholesky factor of the poses that matter, gives all places.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri, owens_t

from skolem.estimation.pose_graph import BASE, Joint, PoseGraph
from skolem.estimation.se2 import Matrix, adjoint, apart, between, relative_jacobian, turned
from skolem.estimation.tracks import Track, Tracks
from skolem.estimation.visibility import outline_radius
from skolem.estimation.weight import log_span
from skolem.traces.errors import InternalError
from skolem.traces.messages import Pose2, Relation

Array = NDArray[np.float64]
LEAST_SD = 1e-9  # metres; a narrower Gaussian is widened to this before it is whitened
TINY = 1e-300  # divisor instead of zero
SURE_SDS = 6.5  # a Gaussian vector of the plane is longer than that many of its sds with a chance of less than 1e-9
LEAST_SHARE = 1e-12  # of a variance; what is left of it below that is rounding


def prob_in_polygon(mean: Array, covariance: Array, vertices: Array) -> float:
    """Return P(x in the polygon) for a Gaussian x, to about 1e-12.

    The polygon is whitened and cut into signed triangles from the mean to each edge; the mass of such a triangle is a
    difference of Owen's T functions (Owen, "Tables for computing bivariate normal probabilities", 1956).

    Args:
        mean: Mean of x, shape (2,).
        covariance: Covariance of x, shape (2, 2), in the frame of `vertices`.
        vertices: Vertices of a simple polygon, counter-clockwise, shape (m, 2), in the unit of `mean`.
    """
    a = max(math.sqrt(covariance[0, 0]), LEAST_SD)
    b = covariance[1, 0] / a
    c = math.sqrt(max(covariance[1, 1] - b * b, LEAST_SD**2))
    offset = vertices - mean
    white = np.column_stack([offset[:, 0] / a, (offset[:, 1] - b * offset[:, 0] / a) / c])
    edge = np.roll(white, -1, axis=0) - white
    length = np.hypot(edge[:, 0], edge[:, 1])
    start, end = white[length > 0.0], np.roll(white, -1, axis=0)[length > 0.0]
    along = edge[length > 0.0] / length[length > 0.0, None]
    side = start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]  # signed distance of the edge's line from the mean
    distance = np.maximum(np.abs(side), TINY)
    mass = _triangle(distance, (end * along).sum(axis=1)) - _triangle(distance, (start * along).sum(axis=1))
    return float(min(1.0, max(0.0, (np.sign(side) * mass).sum())))


def _triangle(distance: Array, reach: Array) -> Array:
    """Return the signed standard normal mass of right triangles at the origin with legs `distance` and `reach`."""
    return np.asarray(np.arctan2(reach, distance) / math.tau - owens_t(distance, reach / distance))


def rectangle(size: tuple[float, float]) -> Array:
    """Return the corners of an axis-aligned rectangle around the origin, counter-clockwise, shape (4, 2)."""
    return np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * size


def disc(radius: float, corners: int = 32) -> Array:
    """Return a regular polygon with the area of a disc around the origin, counter-clockwise, shape (corners, 2)."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    reach = radius * math.sqrt(2.0 * math.pi / (corners * math.sin(2.0 * math.pi / corners)))
    return reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def covariance_within(covariance: Array, bound: Array) -> bool:
    """Return whether covariance <= bound in the Loewner order, up to rounding: its ellipsoid lies in the bound's.

    Both have shape (n, n) and the same frame.
    """
    return bool(np.linalg.eigvalsh(bound - covariance)[0] >= -1e-9 * np.trace(bound))


# ---------------------------------------------------------------- several relations at once


@dataclass(frozen=True, slots=True)
class JointRelations:
    """The truth of some relations as a function of independent uniform numbers.

    Attributes:
        asked: The relations.
        coordinates: The number n of standard normal numbers that give the poses that matter.
        places: For each relation about places, by number, the means, shape (k, 2), of its vectors and their derivatives
            by those numbers, shape (k, 2, n).
        never: The relations that cannot hold, since a hand holds one of the objects, by number.
        sizes: Half the free size of the support, shape (2,), for each relation of kind on, by number.
        rests: P(it rests on a support) of the objects for which that is less than 1, by name of the pose.
        resters: The name of the pose of what rests, for each relation of kind on, by number.
        weights: Quantiles of the weight, in ln(kg), of the objects that are weighed or compared, by anchor.
    """

    asked: tuple[Relation, ...]
    coordinates: int
    places: Mapping[int, tuple[Array, Array]]
    never: frozenset[int]
    sizes: Mapping[int, Array]
    rests: Mapping[str, float]
    resters: Mapping[int, str]
    weights: Mapping[str, "Quantiles"]

    @property
    def dimension(self) -> int:
        """The number of uniform numbers: one for each coordinate, each doubtful support, and each weight."""
        return self.coordinates + len(self.rests) + len(self.weights)

    def truth(self, uniforms: Array) -> NDArray[np.bool_]:
        """Return whether each relation holds, shape (m, relations), for numbers in (0, 1), shape (m, dimension)."""
        n = self.coordinates
        normals = np.ascontiguousarray(ndtri(uniforms[:, :n]).T)
        others = uniforms[:, n:].T
        rests = {anchor: others[i] < p for i, (anchor, p) in enumerate(self.rests.items())}
        log_kg = {anchor: found(others[len(rests) + i]) for i, (anchor, found) in enumerate(self.weights.items())}
        stacked = [derivatives.reshape(-1, n) for _, derivatives in self.places.values()]
        whole = np.concatenate([np.zeros((0, n)), *stacked])
        rows = iter(np.einsum("ij,jk->ik", whole, normals))  # the same for any number of threads
        found = np.empty((len(uniforms), len(self.asked)), dtype=np.bool_, order="F")
        for number, relation in enumerate(self.asked):
            if number in self.never:
                found[:, number] = False
            elif number in self.places:
                means, _ = self.places[number]
                vectors = [(x + next(rows), y + next(rows)) for x, y in means.tolist()]
                found[:, number] = self._placed(number, relation, vectors, rests)
            else:
                found[:, number] = _weighed(relation, log_kg)
        return found

    def settled(self) -> NDArray[np.int8]:
        """Return for each relation 1 if it holds, -1 if it does not, 0 if that is not known, shape (relations,).

        It is a quick look, wrong with a chance of at most 1e-9, and about pairs of near objects only.
        """
        found = np.zeros(len(self.asked), dtype=np.int8)
        for number, relation in enumerate(self.asked):
            if number in self.never:
                found[number] = -1
            elif relation.kind == "near":
                (mean,), (derivative,) = self.places[number]
                away, sd = math.hypot(*mean), SURE_SDS * math.sqrt((derivative**2).sum())
                found[number] = -1 if away - sd > relation.distance_m else int(away + sd < relation.distance_m)
        return found

    def _placed(
        self,
        number: int,
        relation: Relation,
        vectors: Sequence[tuple[Array, Array]],
        rests: Mapping[str, NDArray[np.bool_]],
    ) -> NDArray[np.bool_]:
        if relation.kind == "on":
            ((x, y),), (width, depth) = vectors, self.sizes[number]
            inside = np.asarray((np.abs(x) <= width) & (np.abs(y) <= depth))
            return inside & rests[self.resters[number]] if self.resters[number] in rests else inside
        squares = [x * x + y * y for x, y in vectors]
        return np.asarray(squares[0] <= relation.distance_m**2 if relation.kind == "near" else squares[0] < squares[1])


@dataclass(frozen=True, slots=True)
class Quantiles:
    """A piecewise linear distribution.

    Attributes:
        values: Ends of the pieces, ascending, shape (n,).
        below: Probability below each end, shape (n,).
    """

    values: Array
    below: Array

    def __call__(self, p: Array) -> Array:
        """Return the quantiles at probabilities of any shape."""
        return np.asarray(np.interp(p, self.below, self.values))


def joint_relations(asked: Sequence[Relation], graph: PoseGraph, tracks: Tracks) -> JointRelations:
    """Return the joint distribution of relations between known objects that exist.

    Raises:
        InternalError: If a relation has the wrong number of objects.
    """
    placed = [(i, one) for i, one in enumerate(asked) if one.kind not in ("heavier", "weighs")]
    named = dict.fromkeys(name for _, one in placed for name in _bodies(one, graph))
    joint = graph.joint((BASE, *named))
    places = {i: _vectors(one, _bodies(one, graph), joint) for i, one in placed}
    resting = {_rester(one, graph): _track(one, 0, tracks).rests for _, one in placed if one.kind == "on"}
    used = np.zeros(3 * len(joint.names), dtype=bool)
    for _, derivatives in places.values():
        used |= (derivatives != 0.0).any(axis=(0, 1))
    kept = np.flatnonzero(used)
    factor = semidefinite_factor(joint.covariance[np.ix_(kept, kept)])
    weighed = dict.fromkeys(anchor for one in asked if one.kind in ("heavier", "weighs") for anchor in one.anchors)
    return JointRelations(
        asked=tuple(asked),
        coordinates=len(kept),
        places={i: (means, derivatives[:, :, kept] @ factor) for i, (means, derivatives) in places.items()},
        never=frozenset(
            i for i, one in placed if one.kind == "near" and any(_track(one, k, tracks).hand for k in range(2))
        ),
        sizes={i: _half_free(one, tracks) for i, one in placed if one.kind == "on"},
        rests={body: p for body, p in resting.items() if p < 1.0},
        resters={i: _rester(one, graph) for i, one in placed if one.kind == "on"},
        weights={anchor: Quantiles(*tracks[anchor].weight.cumulated()) for anchor in weighed},
    )


def _bodies(relation: Relation, graph: PoseGraph) -> tuple[str, ...]:
    """Return the names of the poses that a relation is about."""
    return tuple(graph.first(anchor) if relation.earlier else anchor for anchor in relation.anchors)


def _rester(relation: Relation, graph: PoseGraph) -> str:
    """Return the name of the pose of what rests on something, in a relation of kind on."""
    return _bodies(relation, graph)[0]


def _track(relation: Relation, index: int, tracks: Tracks) -> Track:
    """Return the track of one of the objects of a relation, as it was then."""
    anchor = relation.anchors[index]
    return tracks.first(anchor) if relation.earlier else tracks[anchor]


def _vectors(relation: Relation, bodies: Sequence[str], joint: Joint) -> tuple[Array, Array]:
    """Return means, (k, 2), and derivatives, (k, 2, 3 names), of the vectors that decide a relation."""
    if relation.kind == "on":
        below, above = (joint.names.index(body) for body in reversed(bodies))
        below_T_above = between(joint.world_T_body[below], joint.world_T_body[above])
        turned = adjoint((0.0, 0.0, below_T_above[2]))[:2] @ relative_jacobian(below_T_above)
        return np.array([below_T_above[:2]]), _spread(turned, (below, above), joint)[None]
    one, other, *to = bodies
    found = [_offset(other, one, joint)] if not to else [_offset(to[0], one, joint), _offset(to[0], other, joint)]
    return np.array([mean for mean, _ in found]), np.array([derivative for _, derivative in found])


def _offset(a: str, b: str, joint: Joint) -> tuple[Array, Array]:
    """Return mean, (2,), and derivative, (2, 3 names), of the vector from the place of a to that of b."""
    at = (0, joint.names.index(a), joint.names.index(b))
    mean, derivative = apart(*(joint.world_T_body[i] for i in at))
    return mean, _spread(derivative, at, joint)


def _spread(derivative: Matrix, at: Sequence[int], joint: Joint) -> Array:
    """Return a derivative by the tangents of some poses, (2, 3 k), as one by those of all, (2, 3 names)."""
    whole = np.zeros((2, 3 * len(joint.names)))
    for column, index in enumerate(at):
        whole[:, 3 * index : 3 * index + 3] += derivative[:, 3 * column : 3 * column + 3]
    return whole


def _half_free(relation: Relation, tracks: Tracks) -> Array:
    """Return half the size of the part of a top, shape (2,), on which the middle of an object may be."""
    above, below = relation.anchors
    return np.array(tracks.kind(below).size_m[:2]) / 2.0 - outline_radius(tracks.kind(above))


def _weighed(relation: Relation, log_kg: Mapping[str, Array]) -> NDArray[np.bool_]:
    if relation.kind == "heavier":
        one, other = relation.anchors
        return np.asarray(log_kg[one] > log_kg[other])
    if relation.meaning is None:
        raise InternalError(f"{relation} names no weight")
    low, high = log_span(relation.meaning)
    (anchor,) = relation.anchors
    return np.asarray((log_kg[anchor] >= low) & (log_kg[anchor] < high))


def semidefinite_factor(covariance: Matrix) -> Matrix:
    """Return the lower triangular L with L L' = C for a covariance C that may be singular, shape (n, n)."""
    factor = np.zeros_like(covariance)
    for j in range(len(covariance)):
        left = covariance[j, j] - factor[j, :j] @ factor[j, :j]
        if left > LEAST_SHARE * covariance[j, j]:
            factor[j, j] = np.sqrt(left)
            factor[j + 1 :, j] = (covariance[j + 1 :, j] - factor[j + 1 :, :j] @ factor[j, :j]) / factor[j, j]
    return factor


# ---------------------------------------------------------------- one relation, exactly

Relative = Callable[[str, str], tuple[Pose2, Matrix]]  # mean and covariance of a_T_b


def prob_on(anchor: str, support: str, tracks: Tracks, graph: PoseGraph, relative: Relative, earlier: bool) -> float:
    """Return P(an object rests wholly on the top of `support`), given that both exist; 0 while a hand holds it.

    Args:
        anchor: The object.
        support: What it rests on.
        tracks: The belief without poses.
        graph: The belief on poses.
        relative: Gives the relative pose of two bodies of the graph.
        earlier: Whether it is about the time before the objects were first picked.
    """
    track, below = _then(anchor, tracks, earlier), _then(support, tracks, earlier)
    if track is None or below is None or track.hand or below.hand or track.support != support:
        return 0.0
    if not tracks.rests_at(track.z, track.z_variance, support):
        return 0.0
    size = tracks.kind(support).size_m
    margin = 2.0 * outline_radius(tracks.kind(anchor))
    if min(size[0], size[1]) <= margin:
        return 0.0
    bodies = (graph.first(support), graph.first(anchor)) if earlier else (support, anchor)
    support_T_object, covariance = relative(*bodies)
    inside = turned(covariance, support_T_object[2])[:2, :2]
    free = rectangle((size[0] - margin, size[1] - margin))
    return track.rests * prob_in_polygon(np.array(support_T_object[:2]), inside, free)


def prob_near(anchor: str, other: str, distance_m: float, tracks: Tracks, graph: PoseGraph, earlier: bool) -> float:
    """Return P(the middles of two objects are at most `distance_m` apart in the plane), given that both exist.

    It is 0 while a hand holds one of them. The other arguments are those of `prob_on`.
    """
    if anchor == other:
        return 1.0
    pair = (_then(anchor, tracks, earlier), _then(other, tracks, earlier))
    if any(track is None or track.hand for track in pair):
        return 0.0
    bodies = (graph.first(other), graph.first(anchor)) if earlier else (other, anchor)
    return prob_in_polygon(*graph.apart(*bodies), disc(distance_m))


def _then(anchor: str, tracks: Tracks, earlier: bool) -> Track | None:
    """Return the track of an anchor, now or before it was first picked; None for an unknown one."""
    track = tracks.get(anchor)
    return track if track is None or not earlier else tracks.first(anchor)
