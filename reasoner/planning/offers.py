"""The instances that the rules offer in one belief; each fluent is asked once, several in one clingo call."""

from collections.abc import Iterable, Mapping

from skolem.reasoner.planning.instances import Instance, read_instances
from skolem.reasoner.planning.patterns import Mutexes
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.rulebook.asking import Asked
from skolem.reasoner.rulebook.book import COMPILED, Answers, Rulebook
from skolem.reasoner.terms import Term, compound


class RuleOffers:
    """Rule instances of one situation; satisfies `regression.Offers`.

    Attributes:
        calls: clingo calls so far.
        ground_atoms: Sizes of their ground programs, added up.
    """

    def __init__(self, rulebook: Rulebook, situation: Situation, queries: Queries, mutexes: Mutexes) -> None:
        self._rulebook = rulebook
        self._situation = situation
        self._asked = Asked(queries)
        self.mutexes = mutexes
        self._memo: dict[Term, tuple[Instance, ...]] = {}
        self._files = [name for file in rulebook.files if (name := file.removesuffix(".lp")) not in COMPILED]
        self.calls = 0
        self.ground_atoms = 0

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        """Return every instance that achieves the fluent."""
        self.prepare([fluent])
        return self._memo[fluent]

    def prepare(self, fluents: Iterable[Term]) -> None:
        """Ask for the instances of several fluents together, except those that are known already."""
        new = [fluent for fluent in dict.fromkeys(fluents) if fluent not in self._memo]
        if new:
            answers = self._solve([(compound("goal", fluent),) for fluent in new])
            for fluent, atoms in zip(new, answers.atoms, strict=True):
                self._memo[fluent] = read_instances(atoms)

    def holds(self, fluent: Term) -> bool:
        """Return whether the fluent is true now."""
        return self._situation.holds(fluent)

    def ask(self, facts: Iterable[Term]) -> Mapping[str, list[tuple[Term, ...]]]:
        """Return the shown atoms of the rules over `facts`."""
        return self._solve([tuple(facts)]).atoms[0]

    def _solve(self, questions: list[tuple[Term, ...]]) -> Answers:
        answers = self._rulebook.solve_each(questions, self._asked, self._files)
        self.calls += answers.asked
        self.ground_atoms += answers.ground_atoms
        return answers
