"""A lower bound on what a conjunction still costs: the heuristic of the regression.

Each fluent of a root that is false now must be achieved by one of the steps that are offered for it. The price of a
step that is offered for several of them is split evenly among these, so that a step never lowers the bound by more than
its price (an additive cost partition; Katz and Domshlak 2010).
"""

from collections import Counter
from collections.abc import Callable, Collection, Iterable

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import Term

Usable = Callable[[Instance], bool]


class Outlook:
    """The least cost of achieving each of some fluents.

    Attributes:
        hopeless: The fluents that no step achieves.
    """

    def __init__(self, fluents: Iterable[Term], offers: Callable[[Term], tuple[Instance, ...]], usable: Usable) -> None:
        """Price some fluents.

        Args:
            fluents: Fluents that are false now, each once.
            offers: Returns the instances that are offered for a fluent.
            usable: Whether an instance may be used at all.
        """
        self._achieved_by = {f: {i.step: i.price for i in offers(f) if usable(i)} for f in fluents}
        shared = Counter(step for steps in self._achieved_by.values() for step in steps)
        self._least = {
            fluent: min(price // shared[step] for step, price in steps.items())
            for fluent, steps in self._achieved_by.items()
            if steps
        }
        self.hopeless = frozenset(fluent for fluent, steps in self._achieved_by.items() if not steps)

    def least(self, fluents: Collection[Term]) -> int:
        """Return a lower bound on the cost of every plan for a conjunction, micro-nats."""
        return sum(self._least.get(fluent, 0) for fluent in fluents)

    def foresaw(self, step: Term, achieved: Iterable[Term]) -> bool:
        """Return whether a step is offered for those of the fluents it achieves that are priced."""
        return all(step in self._achieved_by.get(fluent, (step,)) for fluent in achieved)
