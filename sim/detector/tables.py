"""Poses of tables, from the edges of their tops in a picture.

A table's size is known, so only its position and heading are fitted. The directions of the seen edges give the heading;
two opposite edges, or one and the extent of the seen top, give the sides. Mostly only part of a table is in the
picture; a direction that no seen edge constrains gets a large variance. If two poses fit, or none, no table is
reported.
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is used
from numpy.typing import NDArray

from skolem.sim.detector.cloud import Cloud
from skolem.sim.detector.edges import Top, passed, tops
from skolem.sim.detector.supports import Support
from skolem.traces.messages import ObjectType
from skolem.traces.messages.likeliest import likeliest

HEIGHT_M = 0.06  # greatest error of a top's height: three sd of a camera 1 degree off, at 1.2 m
HEIGHT_SD_M = 0.02
MIN_POINTS = 400  # of a top
BIN_M = 0.015  # edge points in one bin belong to one edge
HEADINGS = 90  # tried over a quarter turn
MIN_EDGE_POINTS, MIN_EDGE_M = 12, 0.10
SLACK_M = 0.03  # error of first edge positions and of seen extents
EXTENT_QUANTILE = 0.01  # of the points on a top: fewer may belong to other objects of its height beside it
EDGE_SD_M = 0.002  # of the position of an edge with dense points; all its points share the error
GAP_PARTS = 6.0  # an edge's sd is the gap between rays divided by this: rows of pixels mostly cross it aslant
UNKNOWN_SD = (0.5, 0.5, 1.0)  # m, m, rad: in a direction that no edge constrains
MAX_EMPTY = 0.02  # greatest share of rays through the table, relative to seen points
MIN_LOG_LIKELIHOOD = -8.0

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class TableFit:
    """A detected table.

    Attributes:
        kind: Its best type.
        log_likelihood: Log-likelihood of each type that was tried.
        xy_theta: Shape (3,), metres and radians, base frame; theta within half a turn, a square one's within a quarter.
        covariance: Of the fit alone, shape (3, 3), over (x, y, theta) along the base frame's axes.
        top_m: Height of the top at that place, metres, base frame.
        seen: The points of its top.
    """

    kind: str
    log_likelihood: dict[str, float]
    xy_theta: Array
    covariance: Array
    top_m: float
    seen: Cloud


@dataclass(frozen=True, slots=True)
class Side:
    """A seen edge of a table in a frame turned to the heading.

    Attributes:
        axis: 0 if it bounds x, 1 if it bounds y.
        sign: +1 if the table ends towards larger values, -1 towards smaller ones.
        at_m: Its position on that axis.
        points: Its points, shape (k, 2), base frame.
        sd_m: Standard deviation of `at_m`.
    """

    axis: int
    sign: int
    at_m: float
    points: Array
    sd_m: float


def find_tables(cloud: Cloud, supports: tuple[Support, ...], types: dict[str, ObjectType]) -> list[TableFit]:
    """Return the tables with enough edges in a picture.

    Args:
        cloud: All seen points, without the robot's own body.
        supports: The horizontal planes in it.
        types: The types of tables by name.
    """
    found: list[TableFit] = []
    for support in supports:
        sought = {name: kind for name, kind in sorted(types.items()) if _is_as_high(support, kind)}
        if sought:
            empty = passed(cloud, support, SLACK_M)
            fits = [_fit(top, support, empty, sought) for top in tops(cloud, support) if len(top.inside) >= MIN_POINTS]
            found += [fit for fit in fits if fit is not None]
    return _each_once(found, types)


def _is_as_high(support: Support, kind: ObjectType) -> bool:
    x, y = support.points[:, :2].mean(axis=0).tolist()
    return abs(support.z_at(x, y) - kind.size_m[2]) < HEIGHT_M


def _fit(top: Top, support: Support, empty: Array, sought: dict[str, ObjectType]) -> TableFit | None:
    """Return the fit of a table to a top; None unless exactly one pose fits."""
    theta = _heading(top.edge)
    sides = _sides(top, theta) if theta is not None else []
    if theta is None or not sides:
        return None
    laid = {name: _laid(kind, theta, sides, top.inside, empty) for name, kind in sought.items()}
    score = {name: _score(kind, support, top) for name, kind in sought.items() if laid[name]}
    if not score:
        return None
    best = likeliest(score)
    if len(laid[best]) > 1 or score[best] < MIN_LOG_LIKELIHOOD:
        return None
    xy_theta, covariance = _refined(laid[best][0], theta, sought[best], sides)
    x, y, _ = xy_theta.tolist()
    return TableFit(best, score, xy_theta, covariance, support.z_at(x, y), top.cloud)


def _score(kind: ObjectType, support: Support, top: Top) -> float:
    """Return the log-likelihood of a type whose outline fits: that of its height."""
    x, y = top.inside.mean(axis=0).tolist()
    return -0.5 * ((support.z_at(x, y) - kind.size_m[2]) / HEIGHT_SD_M) ** 2


# ---------------------------------------------------------------- edges


def _along(points: Array, theta: float) -> Array:
    """Return points, shape (n, 2), in axes turned by `theta`, shape (n, 2)."""
    c, s = math.cos(theta), math.sin(theta)
    return np.asarray(points @ np.array([[c, -s], [s, c]]))


def _heading(edge: Array) -> float | None:
    """Return the heading, modulo a quarter turn, along which edge points line up best, radians."""
    if len(edge) < MIN_EDGE_POINTS:
        return None
    candidates = np.arange(HEADINGS) * (math.pi / 2.0 / HEADINGS)
    return float(candidates[int(np.argmax([_concentration(_along(edge, float(theta))) for theta in candidates]))])


def _concentration(points: Array) -> float:
    """Return a measure of how much points concentrate at few values of either coordinate."""
    total = 0
    for values in points.T:
        count = np.bincount(((values - values.min()) / BIN_M).astype(np.int64))
        total += int(np.square(count[1:] + count[:-1]).sum())
    return float(total)


def _sides(top: Top, theta: float) -> list[Side]:
    """Return the seen edges of a table of that heading: one where most edge points of an outward direction lie."""
    points, outward, inside = (_along(rows, theta) for rows in (top.edge, top.outward, top.inside))
    found = []
    for axis, sign in ((0, -1), (0, 1), (1, -1), (1, 1)):
        facing = sign * outward[:, axis] > 0.0
        if np.count_nonzero(facing) < MIN_EDGE_POINTS:
            continue
        at = _mode(points[facing, axis])
        on = facing & (np.abs(points[:, axis] - at) < SLACK_M)
        length = float(np.ptp(points[on, 1 - axis]))
        beyond = float(np.mean(sign * (inside[:, axis] - at) > SLACK_M))
        if np.count_nonzero(on) >= MIN_EDGE_POINTS and length >= MIN_EDGE_M and beyond < EXTENT_QUANTILE:
            sd = math.hypot(EDGE_SD_M, float(np.median(top.gap_m[on])) / GAP_PARTS)
            found.append(Side(axis, sign, at, top.edge[on], sd))
    return found


def _mode(values: Array) -> float:
    """Return the value around which most of `values` lie."""
    lowest = float(values.min())
    count = np.bincount(((values - lowest) / BIN_M).astype(np.int64), minlength=2)
    peak = int(np.argmax(count[1:] + count[:-1]))
    near = np.abs(values - (lowest + (peak + 1) * BIN_M)) <= BIN_M
    return float(np.median(values[near]))


# ---------------------------------------------------------------- laying the table


def _laid(kind: ObjectType, theta: float, sides: list[Side], inside: Array, empty: Array) -> list[Array]:
    """Return the poses (x, y, theta) at which a table agrees with seen edges, seen top and empty space."""
    first, second, _ = kind.size_m
    square = first == second
    seen, free = _along(inside, theta), _along(empty, theta)
    found = []
    for size, turn in (
        [((first, second), 0.0)] if square else [((first, second), 0.0), ((second, first), math.pi / 2.0)]
    ):
        centre = [_centre(axis, size[axis], sides, seen[:, axis]) for axis in (0, 1)]
        if centre[0] is None or centre[1] is None:
            continue
        place = np.array([centre[0], centre[1]])
        within = (np.abs(free - place) < np.array(size) / 2.0 - SLACK_M).all(axis=1)
        if np.count_nonzero(within) <= MAX_EMPTY * len(inside):
            x, y = _along(place[None], -theta)[0].tolist()
            found.append(np.array([x, y, theta + turn]))
    return found


def _centre(axis: int, size_m: float, sides: list[Side], seen: Array) -> float | None:
    """Return the middle of a table of that width on one axis; None if the sides contradict the width."""
    low, high = np.quantile(seen, (EXTENT_QUANTILE, 1.0 - EXTENT_QUANTILE)).tolist()
    ends = {side.sign: side.at_m for side in sides if side.axis == axis}
    if len(ends) == 2:
        return (ends[-1] + ends[1]) / 2.0 if abs(ends[1] - ends[-1] - size_m) < 2.0 * SLACK_M else None
    middle = next((at - sign * size_m / 2.0 for sign, at in ends.items()), (low + high) / 2.0)
    return middle if max(high - middle, middle - low) < size_m / 2.0 + SLACK_M else None


def _refined(start: Array, theta: float, kind: ObjectType, sides: list[Side]) -> tuple[Array, Array]:
    """Return the least-squares pose of a table from its edges, and its covariance, shape (3, 3), base axes.

    Args:
        start: A pose (x, y, theta) near the result.
        theta: The heading of the frame in which the sides are given.
        kind: The type, for its size.
        sides: The seen edges.
    """
    half = np.array(kind.size_m[:2]) / 2.0
    turned = round((start[2] - theta) / (math.pi / 2.0))  # quarter turns from the frame of the sides to the table's
    lines = [(side.sign * _unit(side.axis, theta), half[(side.axis + turned) % 2], side) for side in sides]

    def residual(pose: Array) -> Array:
        c, s = math.cos(pose[2] - start[2]), math.sin(pose[2] - start[2])
        turn = np.array([[c, -s], [s, c]])
        rows = [(pose - start) / UNKNOWN_SD]
        for normal, reach, side in lines:
            distance = (side.points - pose[:2]) @ (turn @ normal) - reach
            rows.append(distance / side.sd_m / math.sqrt(len(distance)))
        return np.concatenate(rows)

    fit = scipy.optimize.least_squares(residual, start)
    jacobian = np.asarray(fit.jac)
    return _canonical(np.asarray(fit.x), kind), np.asarray(np.linalg.inv(jacobian.T @ jacobian))


def _unit(axis: int, theta: float) -> Array:
    """Return an axis of a frame turned by `theta`, shape (2,)."""
    angle = theta + axis * math.pi / 2.0
    return np.array([math.cos(angle), math.sin(angle)])


def _each_once(fits: list[TableFit], types: dict[str, ObjectType]) -> list[TableFit]:
    """Return one fit for each table: a fit that may be another part of an earlier table is left out."""
    kept: list[TableFit] = []
    for fit in fits:
        if not any(_may_be_of(fit.seen.points_base[:, :2], other, types[other.kind]) for other in kept):
            kept.append(fit)
    return kept


def _may_be_of(points: Array, fit: TableFit, kind: ObjectType) -> bool:
    """Return whether most points, shape (n, 2), may lie on a table, given the covariance of its pose."""
    local = _along(points - fit.xy_theta[:2], float(fit.xy_theta[2]))
    c, s = math.cos(fit.xy_theta[2]), math.sin(fit.xy_theta[2])
    spread = np.array([[c, s], [-s, c]]) @ fit.covariance[:2, :2] @ np.array([[c, -s], [s, c]])
    room = np.array(kind.size_m[:2]) / 2.0 + SLACK_M + 2.0 * np.sqrt(np.diag(spread))
    return bool((np.abs(local) < room).all(axis=1).mean() > 0.5)


def _canonical(pose: Array, kind: ObjectType) -> Array:
    """Return the pose with the one heading that stands for all equal ones."""
    period = math.pi / 2.0 if kind.size_m[0] == kind.size_m[1] else math.pi
    return np.array([pose[0], pose[1], (pose[2] + period / 2.0) % period - period / 2.0])
