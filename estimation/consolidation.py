"""Elimination of variables that no question asks for any more. A few linear factors keep their information on the rest.

The elimination is exact at the point of linearisation while few variables are coupled. But each eliminated block of
poses couples all objects that were seen from it, and, through the base, all objects that were ever seen. If a factor
would couple more variables than allowed, the constraint between the block and the earlier path of the base is dropped.
A dropped constraint can only widen the belief. Every factor then couples a bounded number of variables, so time and
memory stay bounded.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import gtsam

RELOCATING = 2  # least number of known objects that a block sees, if the constraint to the earlier path is dropped
Keys = frozenset[int]


@dataclass(frozen=True, slots=True)
class Exchange:
    """A replacement of factors in a smoother.

    Attributes:
        removed: Indices of the replaced factors.
        added: Factors over the kept variables, with the same information or less.
    """

    removed: tuple[int, ...]
    added: tuple[gtsam.LinearContainerFactor, ...]


def exchange(isam: gtsam.ISAM2, gone: Keys, entry: int, coupled: int) -> Exchange:
    """Return the replacement of factors that eliminates some variables of a smoother.

    Args:
        isam: The smoother.
        gone: Keys to eliminate.
        entry: The key in `gone` of the first base pose of the block; earlier blocks constrain this pose.
        coupled: Greatest number of variables that one factor may couple.
    """
    factors = isam.getFactorsUnsafe()
    keys_of = {i: frozenset(factors.at(i).keys()) for i in range(factors.size()) if factors.exists(i)}
    touched = [i for i, keys in keys_of.items() if keys & gone]
    memory = [i for i in touched if keys_of[i] & gone == {entry} and _is_memory(factors.at(i))]
    block = sorted(set(touched) - set(memory))
    known, seen = (frozenset().union(*(keys_of[i] for i in part)) - gone for part in (memory, block))
    elsewhere = frozenset().union(*(keys for i, keys in keys_of.items() if i not in block))
    point = isam.calculateEstimate()
    if len(known | seen) <= coupled or len(seen & elsewhere) < RELOCATING:
        return Exchange(tuple(touched), (_summary(_marginal(factors, touched, gone, point), point),))
    others = {i: keys for i, keys in keys_of.items() if i not in touched and _is_summary(factors.at(i))}
    absorbed = _absorbed(known, others, coupled)
    past = _marginal(factors, memory, gone, point)
    for i in absorbed:
        past.push_back(factors.at(i).linearize(point))
    present = _marginal(factors, block, gone, point)
    return Exchange((*touched, *absorbed), (_summary(past, point), _summary(present, point)))


def _is_summary(factor: gtsam.NonlinearFactor) -> bool:
    return isinstance(factor, gtsam.LinearContainerFactor)


def _is_memory(factor: gtsam.NonlinearFactor) -> bool:
    return _is_summary(factor) or isinstance(factor, gtsam.PriorFactorPose2)


def _absorbed(keys: Keys, others: dict[int, Keys], coupled: int) -> tuple[int, ...]:
    """Return the summaries to merge with one over `keys`: most common keys first, as far as the bound allows."""
    chosen: list[int] = []
    for i in sorted(others, key=lambda i: (-len(others[i] & keys), i)):
        if others[i] & keys and len(others[i] | keys) <= coupled:
            chosen.append(i)
            keys = keys | others[i]
    return tuple(chosen)


def _marginal(
    factors: gtsam.NonlinearFactorGraph, part: Iterable[int], gone: Keys, point: gtsam.Values
) -> gtsam.GaussianFactorGraph:
    """Return the marginal of some factors over the kept variables."""
    chosen = gtsam.NonlinearFactorGraph()
    for i in part:
        chosen.push_back(factors.at(i))
    linear = chosen.linearize(point)
    kept = sorted(set(linear.keyVector()) - gone)
    return linear.marginal(kept)


def _summary(linear: gtsam.GaussianFactorGraph, point: gtsam.Values) -> gtsam.LinearContainerFactor:
    """Return one factor that stands for a whole linear graph."""
    factor = gtsam.HessianFactor(linear)
    at = gtsam.Values()
    for key in factor.keys():
        at.insert(key, point.atPose2(key))
    return gtsam.LinearContainerFactor(factor, at)
