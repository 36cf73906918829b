"""Readings of a goal: one object chosen for each of its variables; n objects have n ** m readings for m variables.

Neither function enumerates them: one binds a variable at a time and leaves a wrong choice at once, the other keeps the
likeliest beginnings alone.
"""

import heapq
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Final

from skolem.reasoner.terms import Term, substitute

Binding = Mapping[Term, Term]
MOST_READINGS: Final = 1_000  # that plans are searched for: as many as two variables have among 30 objects


def fitting(
    variables: Sequence[Term],
    choices: Sequence[Sequence[Term]],
    fluents: Collection[Term],
    holds: Callable[[Term], bool],
    is_dear: Callable[[Term], bool],
    distinct: bool = False,
) -> Iterator[Binding]:
    """Yield the bindings under which all fluents hold, in the order of the choices.

    Args:
        variables: The variables, or other terms to be replaced.
        choices: What may be bound to each of them.
        fluents: A conjunction.
        holds: Whether a ground fluent holds.
        is_dear: Whether a fluent is asked only if all others hold.
        distinct: Whether no two variables may be bound to the same.
    """
    dear = sorted(filter(is_dear, fluents), key=str)
    cheap = sorted((f for f in fluents if not is_dear(f)), key=str)
    ground_at = [[f for f in cheap if _bound_by(f, variables) == depth] for depth in range(len(variables) + 1)]

    def bind(bound: Binding) -> Iterator[Binding]:
        depth = len(bound)
        if not all(holds(substitute(f, bound)) for f in ground_at[depth]):
            return
        if depth < len(variables):
            for choice in choices[depth]:
                if not (distinct and choice in bound.values()):
                    yield from bind({**bound, variables[depth]: choice})
        elif all(holds(substitute(f, bound)) for f in dear):
            yield bound

    return bind({})


def likeliest(costs: Sequence[Sequence[int]], most: int = MOST_READINGS) -> list[tuple[int, ...]]:
    """Return the cheapest tuples of one index per variable, at most `most`, in lexicographic order.

    The cost of a tuple is the sum over its variables, so that each of the cheapest tuples begins with one of the
    cheapest beginnings; of equally cheap ones, the first in lexicographic order are kept.

    Args:
        costs: Cost of each choice, by variable.
        most: Number of tuples to keep.
    """
    kept: list[tuple[int, tuple[int, ...]]] = [(0, ())]
    for column in costs:
        longer = ((cost + extra, (*chosen, i)) for cost, chosen in kept for i, extra in enumerate(column))
        kept = heapq.nsmallest(most, longer)
    return sorted(chosen for _, chosen in kept)


def _bound_by(fluent: Term, variables: Sequence[Term]) -> int:
    """Return how many variables must be bound until the fluent is ground."""
    return max(
        (i + 1 for i, variable in enumerate(variables) if substitute(fluent, {variable: 0}) != fluent), default=0
    )
