"""Goals that cannot be evaluated in the way that is asked for: the paper's product, or the rules of an older trace."""

from collections.abc import Iterator
from typing import Final

from skolem.reasoner.language.descriptions import And, Atom, Exists, Expression, Lambda, Or
from skolem.reasoner.language.expressions import Believed, Goal, Sentence, Together
from skolem.reasoner.rulebook.book import Rulebook

# What the rules must state for what the paper does not have; rules recorded before lack it.
_WHOLE: Final = ("whole", 2)


def unvalued(goal: Goal, rulebook: Rulebook) -> list[str]:
    """Return a text for each part of a goal to which its evaluation, or the rules, give no value.

    Args:
        goal: A well-formed goal.
        rulebook: The rules by which it is to be evaluated.
    """
    beyond = list(dict.fromkeys(_beyond(goal)))
    if goal.evaluation == "independent":
        why = "belief.evaluation: independent has no value for it, as it is beyond the paper; use worlds"
    elif not rulebook.stating(_WHOLE):
        why = "these rules are from before it was part of the language; use the rules that ship"
    else:
        return []
    return [f"{text}: {why}" for text in beyond]


def _beyond(goal: Goal) -> Iterator[str]:
    """Yield the text of each part that the paper's language does not have."""
    for conjunct in goal.conjuncts:
        if isinstance(conjunct, Believed) and isinstance(conjunct.phi, Sentence | Together):
            yield str(conjunct.phi)
    for description in goal.expressions.values():
        if not of_the_paper(description):
            yield str(description)


def of_the_paper(description: Lambda) -> bool:
    """Return whether the paper's language has a description, so that its product values it."""
    return description.kind == "lambda" and _of_the_paper(description.body)


def _of_the_paper(expression: Expression) -> bool:
    match expression:
        case Atom():
            return True
        case And(left, right) | Or(left, right):
            return _of_the_paper(left) and _of_the_paper(right)
        case Exists(_, body):
            return _of_the_paper(body)
    return False
