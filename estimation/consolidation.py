"""Forgetting variables that nothing will be asked of: what they say about the others, in a few linear factors.

While few variables are coupled this is exact at the point of linearisation. Each block of poses that is eliminated
couples all that was seen from it, though, and through the base all that was ever seen; so where more than a bounded
number would be coupled, the base's memory of how it came to the block is dropped. Dropping a constraint only ever
widens the belief, and as every factor then speaks of a bounded number of variables, time and memory stay bounded.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import gtsam

RELOCATING = 2  # things met before that a block must see again before the memory of the way to it can be dropped
Keys = frozenset[int]


@dataclass(frozen=True, slots=True)
class Exchange:
    """What to replace in a smoother.

    Attributes:
        removed: Indices of factors.
        added: Factors that say the same, or less, of the variables that are kept.
    """

    removed: tuple[int, ...]
    added: tuple[gtsam.LinearContainerFactor, ...]


def exchange(isam: gtsam.ISAM2, gone: Keys, entry: int, coupled: int) -> Exchange:
    """Return how a smoother can do without some of its variables.

    Args:
        isam: The smoother.
        gone: Keys to eliminate.
        entry: Among them, the base where the block of poses begins: what is known of it stems from blocks before.
        coupled: How many variables one factor may couple.
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
    """Return which summaries to merge with one over `keys`: most in common first, as far as the bound allows."""
    chosen: list[int] = []
    for i in sorted(others, key=lambda i: (-len(others[i] & keys), i)):
        if others[i] & keys and len(others[i] | keys) <= coupled:
            chosen.append(i)
            keys = keys | others[i]
    return tuple(chosen)


def _marginal(
    factors: gtsam.NonlinearFactorGraph, part: Iterable[int], gone: Keys, point: gtsam.Values
) -> gtsam.GaussianFactorGraph:
    """Return what some factors say of the variables that are kept."""
    chosen = gtsam.NonlinearFactorGraph()
    for i in part:
        chosen.push_back(factors.at(i))
    linear = chosen.linearize(point)
    kept = sorted(set(linear.keyVector()) - gone)
    return linear.marginal(kept)


def _summary(linear: gtsam.GaussianFactorGraph, point: gtsam.Values) -> gtsam.LinearContainerFactor:
    """Return one factor for all of a linear graph."""
    factor = gtsam.HessianFactor(linear)
    at = gtsam.Values()
    for key in factor.keys():
        at.insert(key, point.atPose2(key))
    return gtsam.LinearContainerFactor(factor, at)
