"""Both evaluations of a description: by possible worlds, and by the paper's product."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

from skolem.reasoner import BeliefQueries, Goal
from skolem.reasoner.meaning.evaluations import of_the_paper
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import Compound

LEAST: Final = 0.01  # a smaller gap is not told of


@dataclass(frozen=True, slots=True)
class Gap:
    """The object for which the evaluations of a description differ most.

    Attributes:
        expression: The constant of the description.
        object: The anchor.
        worlds: The share of the possible worlds in which the description means it.
        independent: The paper's product.
    """

    expression: str
    object: str
    worlds: float
    independent: float

    @property
    def size(self) -> float:
        """The distance between both."""
        return abs(self.worlds - self.independent)


def gaps(goal: Goal, rulebook: Rulebook, belief: BeliefQueries) -> tuple[Gap, ...]:
    """Return the greatest gap of each description to which both evaluations give a value, if it is great enough."""
    return tuple(found for found in _greatest(goal, rulebook, belief) if found.size > LEAST)


def _greatest(goal: Goal, rulebook: Rulebook, belief: BeliefQueries) -> Iterator[Gap]:
    told = [name for name, description in goal.expressions.items() if of_the_paper(description)]
    if not told or not belief.anchors():
        return
    worlds = Denotations(replace(goal, evaluation="worlds"), rulebook)
    product = Denotations(replace(goal, evaluation="independent"), rulebook)
    for name in told:
        each = [
            Gap(
                name,
                anchor,
                worlds.interval(Compound("den", (name, anchor)), belief).middle,
                product.probability(name, anchor, belief),
            )
            for anchor in belief.anchors()
        ]
        yield max(each, key=lambda gap: gap.size)
