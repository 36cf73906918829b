"""What a conjunction costs at the least if no step destroyed anything: the bound of long searches.

Every step that a search could come upon is found once, from the fluents of its roots backwards. A fluent costs as much
as the cheapest step that achieves it and the dearest precondition of that step: the heuristic h_max (Bonet and Geffner
2001). Where no chain of steps leads to a fluent, a search would only try all orders of everything else.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.patterns import entails
from skolem.reasoner.terms import Compound, Term

MOST = 1000  # fluents; if there are more, the bound says nothing


@dataclass(frozen=True, slots=True)
class Questions:
    """The questions that finding the steps asks.

    Attributes:
        prepare: Asks for the offers of several fluents together.
        offers: Returns the instances that are offered for a fluent.
        holds: Whether a fluent is true now.
        usable: Whether an instance may be used at all.
        demanded: Returns the preconditions of an instance at its level.
    """

    prepare: Callable[[Iterable[Term]], None]
    offers: Callable[[Term], tuple[Instance, ...]]
    holds: Callable[[Term], bool]
    usable: Callable[[Instance], bool]
    demanded: Callable[[Instance], Sequence[Term]]


class Reach:
    """The least cost of every fluent that a search can come upon."""

    def __init__(self, fluents: Iterable[Term], ask: Questions, again: bool) -> None:
        """Find all steps and price all fluents.

        Args:
            fluents: The fluents of the roots.
            ask: The questions.
            again: Whether steps may also achieve what holds now.
        """
        self._least: dict[Term, float] = {}
        steps: list[tuple[Instance, Sequence[Term]]] = []
        layer = sorted(set(fluents), key=str)
        while layer and len(self._least) <= MOST:
            self._least |= {fluent: 0 if ask.holds(fluent) else math.inf for fluent in layer}
            sought = [fluent for fluent in layer if again or self._least[fluent]]
            ask.prepare(sought)
            found = [(i, ask.demanded(i)) for fluent in sought for i in ask.offers(fluent) if ask.usable(i)]
            steps += found
            layer = sorted({f for _, needs in found for f in needs if f not in self._least}, key=str)
        if layer:
            self._least.clear()
        else:
            self._price(steps)

    def least(self, fluents: Collection[Term]) -> float:
        """Return a lower bound on the cost of a conjunction, micro-nats; infinite if nothing achieves it."""
        return max((self._least.get(fluent, 0) for fluent in fluents), default=0)

    def _price(self, steps: Iterable[tuple[Instance, Sequence[Term]]]) -> None:
        """Lower the costs of fluents until no step gives any for less."""
        named: defaultdict[str, list[Term]] = defaultdict(list)
        for fluent in self._least:
            named[_name(fluent)].append(fluent)
        gives = [
            (step.price, needs, [f for r in step.results for f in named[_name(r)] if entails(r, f)])
            for step, needs in steps
        ]
        changed = True
        while changed:
            changed = False
            for price, needs, achieved in gives:
                cost = price + self.least(needs)
                for fluent in achieved:
                    if cost < self._least[fluent]:
                        self._least[fluent], changed = cost, True


def _name(fluent: Term) -> str:
    return fluent.name if isinstance(fluent, Compound) else str(fluent)
