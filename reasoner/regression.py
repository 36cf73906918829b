"""Best-first regression: from a goal backwards to what is believed now.

A node is a conjunction of fluents. An expansion takes a fluent that is false now and a rule instance that achieves it,
removes what the instance's results entail and adds the preconditions it demands at its level. Nothing that holds now is
dropped on the way, since an earlier step could destroy it. A plan's cost is the sum of -ln p over its steps
(section "Basic mechanisms"), so the first node whose fluents all hold gives the most likely open-loop plan.

Equal costs are decided by risk (the plan whose risky steps come early wins), then by length, then by the order in which
roots and names are given.
"""

import heapq
import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from skolem.reasoner.instances import Instance, title
from skolem.reasoner.patterns import Mutexes, entails
from skolem.reasoner.terms import Term, matches
from skolem.traces.messages import Candidate

_HOPELESS = 18_420_681  # micro-nats: p = 1e-8

Subgoal = frozenset[Term]


class Offers(Protocol):
    """Where rule instances and the truth of fluents come from."""

    @property
    def mutexes(self) -> Mutexes:
        """The exclusions of the rules."""
        ...

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        """Every instance that achieves the fluent, rejected ones too."""
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
        cost: Of the plan, micro-nats.
        expansions: Nodes expanded.
        candidates: What was offered or rejected when the roots were expanded.
        exhausted: False if the search stopped at its limit of expansions.
    """

    steps: tuple[Step, ...] | None
    cost: int
    expansions: int
    candidates: tuple[Candidate, ...]
    exhausted: bool = True


_Entry = tuple[int, int, int, int, Subgoal, tuple[Step, ...]]  # cost, risk, length, order; subgoal, steps after it


def regress(
    roots: Sequence[Subgoal],
    offers: Offers,
    level_of: Callable[[Instance], int],
    refused: Callable[[Instance, int], bool],
    max_expansions: int,
    max_cost: int,
    final: Term | None = None,
) -> Found:
    """Return the cheapest plan that makes all fluents of one of `roots` true.

    Steps achieve fluents that are false now; only if there is no such plan, steps that achieve again what an earlier
    one destroyed are tried too.

    Args:
        roots: Conjunctions of ground fluents, best first where costs are equal.
        offers: Rule instances and the truth of fluents now.
        level_of: The abstraction level at which an instance is to be used.
        refused: Whether an instance at a level has failed to be refined or executed in this belief.
        max_expansions: Nodes to expand before giving up.
        max_cost: Plans dearer than this are not worth trying, micro-nats.
        final: The operation the plan must end with; None for any.
    """
    found = search(roots, offers, level_of, refused, max_expansions, max_cost, final, again=False)
    if found.steps is None and found.exhausted:
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
) -> Found:
    """Return the cheapest plan as `regress` does; `again` says whether fluents that hold now may be achieved again."""
    serial = itertools.count()
    queue: list[_Entry] = [(0, 0, 0, next(serial), root, ()) for root in roots]
    considered: dict[str, Candidate] = {}
    seen: set[Subgoal] = set()
    while queue:
        cost, risk, length, _, goal, steps = heapq.heappop(queue)
        if goal in seen:
            continue
        open_fluents = [f for f in sorted(goal, key=str) if not offers.holds(f)]
        if not open_fluents:
            return Found(steps, cost, len(seen), _sorted(considered))
        if len(seen) >= max_expansions:
            return Found(None, 0, len(seen), _sorted(considered), exhausted=False)
        seen.add(goal)
        for instance in _achievers(open_fluents, goal, offers, again):
            if length == 0 and final is not None and instance.called != final:
                continue
            level = min(level_of(instance), instance.concrete)
            before, reason = _regressed(instance, level, goal, offers.mutexes)
            if reason is None and refused(instance, level):
                reason = "refused_in_this_belief"
            total = cost + instance.price
            if reason is None and total > max_cost:
                reason = "too_unlikely"
            if length == 0:
                name = title(instance.called)
                considered.setdefault(name, Candidate(op=name, cost=min(instance.price, 50_000_000), rejected=reason))
            if reason is None:
                step = Step(instance, level, goal, before)
                heapq.heappush(queue, (total, risk + cost, length + 1, next(serial), before, (step, *steps)))
    return Found(None, 0, len(seen), _sorted(considered))


def _sorted(considered: dict[str, Candidate]) -> tuple[Candidate, ...]:
    return tuple(sorted(considered.values(), key=lambda c: (c.cost, c.op)))


def _achievers(open_fluents: Sequence[Term], goal: Subgoal, offers: Offers, again: bool) -> list[Instance]:
    """Return the instances to expand, cheapest first; only those of one fluent if they are immediate."""
    for fluent in open_fluents:
        immediate = [i for i in offers.offers(fluent) if i.immediate]
        if immediate:
            return immediate
    merged: dict[Term, Instance] = {}
    for fluent in sorted(goal, key=str) if again else open_fluents:
        for instance in offers.offers(fluent):
            merged[instance.step] = merged[instance.step].merged(instance) if instance.step in merged else instance
    for fluent in [] if again else sorted(goal.difference(open_fluents), key=str):
        for instance in offers.offers(fluent):
            if instance.step in merged:
                merged[instance.step] = merged[instance.step].merged(instance)
    return sorted(merged.values(), key=lambda i: (i.price, str(i.step)))


def _regressed(instance: Instance, level: int, goal: Subgoal, mutexes: Mutexes) -> tuple[Subgoal, str | None]:
    """Return what must hold before the instance so that `goal` holds after it, or why there is no such thing."""
    if instance.rejected:
        return goal, instance.rejected[0]
    if level > 0 and instance.on_placeholder:
        return goal, "acts_on_placeholder"
    if instance.price > _HOPELESS:
        return goal, "hopeless"
    rest = [f for f in sorted(goal, key=str) if not any(entails(r, f) for r in instance.results)]
    if len(rest) == len(goal):
        return goal, "achieves_nothing"
    for fluent in rest:
        if any(mutexes.exclude(r, fluent) for r in instance.results) or any(
            matches(pattern, fluent) for pattern in instance.destroys
        ):
            return goal, f"clobbers_by_result {fluent}"
        if any(mutexes.exclude(p, fluent) for p in instance.postponed(level)):
            return goal, f"clobbers_by_postponed {fluent}"
    demanded = instance.demanded(level)
    for needed in demanded:
        for fluent in [*rest, *demanded]:
            if mutexes.exclude(needed, fluent):
                return goal, f"inconsistent {needed} {fluent}"
    return _joined(rest, demanded), None


def _joined(rest: Iterable[Term], demanded: Iterable[Term]) -> Subgoal:
    """Return the conjunction without fluents that another one entails."""
    joined: list[Term] = []
    for fluent in [*rest, *demanded]:
        if not any(entails(f, fluent) for f in joined):
            joined = [f for f in joined if not entails(fluent, f)] + [fluent]
    return frozenset(joined)
