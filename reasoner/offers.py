"""What the rules offer in one belief: one clingo call per fluent asked for, kept as long as the belief lasts."""

from collections.abc import Iterable, Mapping
from typing import Final

from skolem.reasoner.instances import Instance, read_instances
from skolem.reasoner.patterns import Mutexes
from skolem.reasoner.queries import Queries
from skolem.reasoner.rulebook import Rulebook
from skolem.reasoner.situation import Situation
from skolem.reasoner.terms import Term, compound

_OF_NO_USE: Final = ("denote.lp", "mutex.lp")  # compiled once, before: left out of every question


class RuleOffers:
    """Rule instances of one situation; satisfies `regression.Offers`.

    Attributes:
        calls: clingo calls so far.
        ground_atoms: Sizes of their ground programs, added up.
    """

    def __init__(self, rulebook: Rulebook, situation: Situation, queries: Queries, mutexes: Mutexes) -> None:
        self._rulebook = rulebook
        self._situation = situation
        self._queries = queries
        self.mutexes = mutexes
        self._memo: dict[Term, tuple[Instance, ...]] = {}
        self._files = [name.removesuffix(".lp") for name in rulebook.files if name not in _OF_NO_USE]
        self.calls = 0
        self.ground_atoms = 0

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        """Return every instance that achieves the fluent."""
        if fluent not in self._memo:
            self._memo[fluent] = read_instances(self.ask([compound("goal", fluent)]))
        return self._memo[fluent]

    def holds(self, fluent: Term) -> bool:
        """Return whether the fluent is true now."""
        return self._situation.holds(fluent)

    def ask(self, facts: Iterable[Term]) -> Mapping[str, list[tuple[Term, ...]]]:
        """Return the shown atoms of the rules over `facts`."""
        answer = self._rulebook.solve(facts, self._queries, self._files)
        self.calls += 1
        self.ground_atoms += answer.ground_atoms
        return answer.atoms
