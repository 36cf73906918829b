"""Sharing out a bound: how sure the robot must be of each of several facts, so that all hold with a probability."""

from collections.abc import Sequence

from skolem.reasoner.terms import nll, prob


def shares(costs: Sequence[int], bound: int) -> list[int]:
    """Return the part of a bound for each of several independent facts, micro-nats; the parts add up to no more.

    A fact that is believed well enough gets twice its present cost, so that a little more doubt does not matter. What
    that leaves goes in even parts to the others.

    Args:
        costs: -ln P of each fact now, micro-nats.
        bound: -ln of the probability with which all are to hold, micro-nats.
    """
    parts = dict.fromkeys(range(len(costs)), 0)
    left, open_facts = bound, sorted(parts, key=lambda i: (costs[i], i))
    while open_facts and 2 * costs[open_facts[0]] <= left // len(open_facts):
        first = open_facts.pop(0)
        parts[first] = 2 * costs[first]
        left -= parts[first]
    for fact in open_facts:
        parts[fact] = left // len(open_facts)
    spare = 0 if open_facts else left // max(1, len(costs))
    return [parts[i] + spare for i in range(len(costs))]


def evenly(bound: int, count: int) -> int:
    """Return the part of a bound for each of several facts that may depend on each other (Bonferroni), micro-nats."""
    return nll(1.0 - (1.0 - prob(bound)) / count)
