"""Best-first regression from a goal backwards to the present belief.

A node is a conjunction of fluents. An expansion takes a fluent that is false now and a rule instance that achieves it,
removes the fluents that the instance's results entail and adds the preconditions it demands at its level. A fluent
that holds now is kept, since an earlier step could destroy it. A plan's cost is the sum of -ln p over its steps
(section "Basic mechanisms"), so the first node whose fluents all hold gives the most likely open-loop plan.

Equal costs are decided by risk (the plan whose risky steps come early wins), then by length, then by the order in which
roots and names are given.
"""

import heapq
import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from skolem.reasoner.planning.instances import Instance, title
from skolem.reasoner.planning.outlook import Outlook
from skolem.reasoner.planning.patterns import Mutexes, about, entails
from skolem.reasoner.planning.reach import Questions, Reach
from skolem.reasoner.terms import CAP_MICRONATS, Term, matches
from skolem.traces.messages import Candidate

_LONG = 100  # expansions after the roots, from which on all that can be reached is found out first
_PER_ROOT = 10  # least expansions per root, so that no root is left out if there are many

Subgoal = frozenset[Term]


class Offers(Protocol):
    """The source of rule instances and of the truth of fluents."""

    @property
    def mutexes(self) -> Mutexes:
        """The mutexes of the rules."""
        ...

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        """Every instance that achieves the fluent, rejected ones included."""
        ...

    def prepare(self, fluents: Iterable[Term]) -> None:
        """Find the offers for these fluents together, which is faster than one by one."""
        ...

    def holds(self, fluent: Term) -> bool:
        """Whether the fluent is true in the present belief."""
        ...


@dataclass(frozen=True, slots=True)
class Step:
    """A step of a plan: an instance at a level, between two conjunctions."""

    instance: Instance
    level: int
    subgoal: Subgoal
    preimage: Subgoal

    @property
    def is_concrete(self) -> bool:
        """Whether every precondition is demanded, so that it can be carried out."""
        return self.level >= self.instance.concrete


@dataclass(frozen=True, slots=True)
class Found:
    """Outcome of one search.

    Attributes:
        steps: In execution order; None if there is no plan.
        cost: Cost of the plan, micro-nats.
        bound: A lower bound on the cost of every plan, micro-nats; equal to `cost` if no plan is likelier.
        expansions: Nodes expanded.
        candidates: The instances offered or rejected when the roots were expanded.
        exhausted: False if the search stopped at its limit of expansions.
        priced_out: Whether any instance was left out for its cost, so that a higher limit might give a plan.
        skipped: Whether any step was left out that achieves only fluents that hold now.
    """

    steps: tuple[Step, ...] | None
    cost: int
    expansions: int
    candidates: tuple[Candidate, ...]
    exhausted: bool = True
    bound: int = 0
    priced_out: bool = False
    skipped: bool = False

    @property
    def within(self) -> float | None:
        """Upper bound on this plan's cost divided by the cheapest plan's; 1 if optimal, None if unknown."""
        if self.steps is None or self.bound == 0 < self.cost:
            return None
        return 1.0 if self.cost == self.bound else self.cost / self.bound


# least cost of a plan by way of it, risk, length, order; cost, subgoal, and the steps after it
_Entry = tuple[int, int, int, int, int, Subgoal, tuple[Step, ...]]


def regress(
    roots: Sequence[Subgoal],
    offers: Offers,
    level_of: Callable[[Instance], int],
    refused: Callable[[Instance, int], bool],
    max_expansions: int,
    max_cost: int,
    final: Term | None = None,
    optimal: bool = False,
) -> Found:
    """Return the cheapest plan that makes all fluents of one of `roots` true.

    Steps achieve fluents that are false now. Only if there is no such plan, or with `optimal`, steps are tried too that
    restore a fluent which an earlier step destroyed. Without them a plan may miss the optimum; `Found.within` bounds by
    how much.

    Args:
        roots: Conjunctions of ground fluents, best first where costs are equal.
        offers: Rule instances and the truth of fluents now.
        level_of: The abstraction level at which an instance is to be used.
        refused: Whether an instance at a level has failed to be refined or executed in this belief.
        max_expansions: Nodes to expand before giving up; with very many roots, ten for each.
        max_cost: Greatest cost of a plan that is worth trying, micro-nats.
        final: The operation the plan must end with; None for any.
        optimal: Whether the plan must be the cheapest of all, at the price of more expansions.
    """
    found = search(roots, offers, level_of, refused, max_expansions, max_cost, final, again=optimal, priced=not optimal)
    if found.steps is None and found.exhausted and found.skipped and not optimal:
        second = search(roots, offers, level_of, refused, max_expansions, max_cost, final, again=True)
        found = replace(second, expansions=found.expansions + second.expansions)
    return found


def search(
    roots: Sequence[Subgoal],
    offers: Offers,
    level_of: Callable[[Instance], int],
    refused: Callable[[Instance, int], bool],
    max_expansions: int,
    max_cost: int,
    final: Term | None,
    again: bool,
    priced: bool = True,
) -> Found:
    """Return the cheapest plan as `regress` does; with `again`, steps may achieve fluents that hold now.

    Optimality. Nodes leave the queue in the order of their cost plus a heuristic (`Outlook`), roots before all others,
    so that their candidates are known. It never overestimates the remaining cost as long as the fluents of roots are
    achieved by no steps but those that are offered for them; where one is met that does so, nothing is claimed of the
    bound. Unless `priced`, the heuristic is 0, which holds for all rules. So the first node whose fluents all hold is
    the cheapest of the plans that were searched. In a long search, nodes that no plan within the limit leads to are
    left out (`Reach`), which holds for all rules too.

    The bound. A plan that was not searched has, seen from the goal, a first step that achieves only fluents that hold.
    If the node of that step was expanded, the step was skipped there, and the plan costs at least as much as this step
    and all after it. If that node was still in the queue, the steps after it cost at least as much as the plan found.
    """

    def level(instance: Instance) -> int:
        return min(level_of(instance), instance.concrete)

    serial = itertools.count()
    priced_out = surprised = skipped = False
    left_out = max_cost + 1  # the least cost of a skipped step that achieves only fluents that hold
    queue: list[_Entry] = [(0, 0, 0, next(serial), 0, root, ()) for root in roots]
    considered: dict[str, Candidate] = {}
    seen: dict[Subgoal, int] = {}  # expanded subgoals, and at which cost
    expansions = 0
    missing = sorted({f for root in roots for f in root if not offers.holds(f)}, key=str)
    offers.prepare(missing)

    def usable(instance: Instance) -> bool:
        return not instance.rejected and not refused(instance, level(instance))

    outlook = Outlook(missing if priced else (), offers.offers, usable)
    ask = Questions(offers.prepare, offers.offers, offers.holds, usable, lambda i: i.demanded(level(i)))
    reach: Reach | None = None
    while queue:
        least, risk, length, _, cost, goal, steps = heapq.heappop(queue)
        if seen.get(goal, cost + 1) <= cost:
            continue
        if reach is None and expansions >= len(roots) + _LONG:
            reach = Reach((fluent for root in roots for fluent in root), ask, again)
        if reach is not None and cost + (ahead := reach.least(goal)) > max_cost:
            priced_out = priced_out or ahead < math.inf
            continue
        open_fluents = [f for f in sorted(goal, key=str) if not offers.holds(f)]
        if not open_fluents:
            bound = 0 if surprised else min(cost, left_out)
            return Found(steps, cost, expansions, _sorted(considered), bound=bound)
        if expansions >= max(max_expansions, _PER_ROOT * len(roots)):
            return Found(None, 0, expansions, _sorted(considered), exhausted=False)
        seen[goal] = cost
        expansions += 1
        for instance, repeats in _achievers(open_fluents, goal, offers):
            if length == 0 and final is not None and instance.operation != final:
                continue
            total = cost + instance.price
            if repeats and not again and total >= left_out:
                skipped = True
                continue
            before, reason = _regressed(instance, level(instance), goal, offers.mutexes)
            if reason is None and refused(instance, level(instance)):
                reason = "refused_in_this_belief"
            if repeats and not again:
                left_out, skipped = (total, True) if reason is None else (left_out, skipped)
                continue
            if reason is None and total > max_cost:
                reason, priced_out = "too_unlikely", True
            if length == 0:
                name = title(instance.operation)
                considered.setdefault(
                    name, Candidate(op=name, cost=min(instance.price, CAP_MICRONATS), rejected=reason)
                )
            if reason is None and outlook.hopeless.isdisjoint(before):
                surprised = surprised or not outlook.foresaw(instance.step, goal.difference(before))
                expected = max(least, total + outlook.least(before))
                if expected > max_cost:
                    priced_out = True
                    continue
                step = Step(instance, level(instance), goal, before)
                heapq.heappush(queue, (expected, risk + cost, length + 1, next(serial), total, before, (step, *steps)))
    return Found(None, 0, expansions, _sorted(considered), priced_out=priced_out, skipped=skipped)


def _sorted(considered: dict[str, Candidate]) -> tuple[Candidate, ...]:
    return tuple(sorted(considered.values(), key=lambda c: (c.cost, c.op)))


def _achievers(open_fluents: Sequence[Term], goal: Subgoal, offers: Offers) -> list[tuple[Instance, bool]]:
    """Return the instances to expand, cheapest first, and whether each achieves only fluents that hold already.

    If those of one open fluent are immediate, only they are returned: the preconditions and results of an inference do
    not change with its position in the plan, so that it may as well be the last step.
    """
    offers.prepare(open_fluents)
    for fluent in open_fluents:
        immediate = [i for i in offers.offers(fluent) if i.immediate]
        if immediate:
            return [(i, False) for i in immediate]
    offers.prepare(sorted(goal, key=str))
    merged: dict[Term, tuple[Instance, bool]] = {}
    for fluents, repeats in ((open_fluents, False), (sorted(goal.difference(open_fluents), key=str), True)):
        for fluent in fluents:
            for instance in offers.offers(fluent):
                known = merged.get(instance.step)
                merged[instance.step] = (instance, repeats) if known is None else (known[0].merged(instance), known[1])
    return sorted(merged.values(), key=lambda found: (found[0].price, str(found[0].step)))


def _regressed(instance: Instance, level: int, goal: Subgoal, mutexes: Mutexes) -> tuple[Subgoal, str | None]:
    """Return the pre-image of `goal` under an instance and None, or `goal` and the reason why there is none."""
    if instance.rejected:
        return goal, instance.rejected[0]
    if level > 0 and instance.on_placeholder:
        return goal, "acts_on_placeholder"
    gained: dict[str, list[Term]] = {}
    for result in instance.results:
        gained.setdefault(about(result), []).append(result)
    rest = [f for f in sorted(goal, key=str) if not any(entails(r, f) for r in gained.get(about(f), ()))]
    if len(rest) == len(goal):
        return goal, "achieves_nothing"
    results, postponed = (mutexes.concerned(fluents) for fluents in (instance.results, instance.postponed(level)))
    for fluent in rest if results or postponed or instance.destroys else ():
        if any(mutexes.exclude(r, fluent) for r in results) or any(
            matches(pattern, fluent) for pattern in instance.destroys
        ):
            return goal, f"clobbers_by_result {fluent}"
        if any(mutexes.exclude(p, fluent) for p in postponed):
            return goal, f"clobbers_by_postponed {fluent}"
    demanded = instance.demanded(level)
    for needed in mutexes.concerned(demanded):
        for fluent in mutexes.concerned([*rest, *demanded]):
            if mutexes.exclude(needed, fluent):
                return goal, f"inconsistent {needed} {fluent}"
    return _joined(rest, demanded), None


def _joined(rest: Iterable[Term], demanded: Iterable[Term]) -> Subgoal:
    """Return the conjunction of both without fluents that another one entails."""
    joined: dict[str, list[Term]] = {}
    for fluent in [*rest, *demanded]:
        alike = joined.setdefault(about(fluent), [])
        if not any(entails(f, fluent) for f in alike):
            alike[:] = [*(f for f in alike if not entails(fluent, f)), fluent]
    return frozenset(itertools.chain.from_iterable(joined.values()))
