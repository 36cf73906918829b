"""Weighted model counting: the probability of a formula over independent variables.

Formulas that share no variable are independent: their probabilities are multiplied, or the distributions of their
numbers are convolved. A variable that several of them share is conditioned on, the most frequent one first. Where
relations are given, every value has one number for each arrangement of the poses.
"""

from collections.abc import Iterable, Sequence
from functools import reduce
from operator import or_
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.worlds.cells import bits
from skolem.reasoner.worlds.diagrams import FALSE, TRUE, Diagram, Lit, Many, Number, Rel

Array = NDArray[np.float64]
Value = float | Array  # one number, or one for each arrangement, shape (n,)
MOST_CASES: Final = 100_000  # formulas that are conditioned, each once for each case, before all are too large


class TooManyCasesError(Exception):
    """The formula would need more cases than the limit."""


class Counting:
    """The probabilities of the formulas of a diagram, each computed once."""

    def __init__(self, diagram: Diagram, relations: NDArray[np.bool_] | None = None, most: int = MOST_CASES) -> None:
        """Begin.

        Args:
            diagram: The formulas.
            relations: Whether each relation holds in each arrangement, shape (n, relations).
            most: The limit of cases.
        """
        self._diagram, self._relations, self._left = diagram, relations, most
        self._values: dict[int, Value] = {FALSE: 0.0, TRUE: 1.0}
        self._numbers: dict[tuple[tuple[int, ...], int], list[Value]] = {}

    @property
    def arrangements(self) -> int:
        """The number of arrangements; 1 without relations."""
        return 1 if self._relations is None else len(self._relations)

    def probability(self, formula: int) -> Value:
        """Return P(formula), for each arrangement if it depends on relations.

        Raises:
            TooManyCasesError: If the limit is reached.
        """
        if formula not in self._values:
            self._values[formula] = self._probability(formula)
        return self._values[formula]

    def _probability(self, formula: int) -> Value:
        diagram = self._diagram
        match diagram.formulas[formula]:
            case Lit(variable, mask):
                return self._weight(variable, mask)
            case Rel(index, holds):
                assert self._relations is not None, "a relation without arrangements"
                return np.equal(self._relations[:, index], holds).astype(np.float64)
            case Many("all", items):
                return self._product("all", items)
            case Many("some", items):
                return 1.0 - self._product("some", items)
            case Number(items, least, most, holds):
                share: Value = sum(self._distribution(items, most + 1)[least : most + 1])
                return share if holds else 1.0 - share
        raise AssertionError(formula)

    def _weight(self, variable: int, mask: int) -> float:
        weights = self._diagram.weights[variable]
        return float(bits(mask, len(weights)) @ weights)

    def _product(self, kind: str, items: Sequence[int]) -> Value:
        """Return P(all items hold), or P(none does)."""
        found: Value = 1.0
        for group in self._components(items):
            if len(group) == 1:
                value = self.probability(group[0])
            else:
                whole = self._diagram.all_of(group) if kind == "all" else self._diagram.some_of(group)
                value = self._by_cases(whole, group)
            found = found * (value if kind == "all" else 1.0 - value)
        return found

    def _by_cases(self, whole: int, group: Sequence[int]) -> Value:
        if whole not in self._values:
            found: Value = 0.0
            for weight, variable, block in self._cases(whole, group):
                found = found + weight * self.probability(self._diagram.given(whole, variable, block, {}))
            self._values[whole] = found
        return self._values[whole]

    def _cases(self, whole: int, group: Sequence[int]) -> list[tuple[float, int, int]]:
        """Return weight, variable and values of each case of the variable that most formulas of a group share."""
        variable = self._most_frequent(group)
        blocks = self._blocks(variable, self._diagram.masks(whole, variable), len(group))
        return [(self._weight(variable, block), variable, block) for block in blocks]

    def _most_frequent(self, items: Iterable[int]) -> int:
        count: dict[int, int] = {}
        for item in items:
            variables = self._diagram.variables[item]
            while variables:
                lowest = variables & -variables
                count[lowest] = count.get(lowest, 0) + 1
                variables ^= lowest
        return min(count, key=lambda bit: (-count[bit], bit)).bit_length() - 1

    # ------------------------------------------------------------ numbers

    def _distribution(self, items: tuple[int, ...], cap: int) -> list[Value]:
        """Return P(exactly k items hold) for k < cap, and P(at least cap)."""
        if (items, cap) not in self._numbers:
            found: list[Value] = [1.0]
            for group in self._components(items):
                if len(group) == 1:
                    p = self.probability(group[0])
                    part: list[Value] = [1.0 - p, p]
                else:
                    part = self._shared_distribution(tuple(group), cap)
                found = _convolved(found, part, cap)
            self._numbers[items, cap] = found + [0.0] * (cap + 1 - len(found))
        return self._numbers[items, cap]

    def _shared_distribution(self, group: tuple[int, ...], cap: int) -> list[Value]:
        """Return the distribution of the number of items that share variables."""
        if (group, cap) not in self._numbers:
            found: list[Value] = [0.0] * (cap + 1)
            variable = self._most_frequent(group)
            masks = {mask for item in group for mask in self._diagram.masks(item, variable)}
            for block in self._blocks(variable, masks, len(group)):
                done: dict[int, int] = {}
                rest = [self._diagram.given(item, variable, block, done) for item in group]
                weight = self._weight(variable, block)
                part = self._distribution(tuple(sorted(item for item in rest if item != FALSE)), cap)
                found = [old + weight * new for old, new in zip(found, part, strict=True)]
            self._numbers[group, cap] = found
        return self._numbers[group, cap]

    def _blocks(self, variable: int, masks: Iterable[int], size: int) -> list[int]:
        """Return the cases of a variable that some literals of it distinguish, for as many formulas as `size` says."""
        found = [self._diagram.possible(variable)]
        for mask in sorted(masks):
            found = [part for block in found for part in (block & mask, block & ~mask) if part]
        self._left -= len(found) * size
        if self._left < 0:
            raise TooManyCasesError
        return found

    # ------------------------------------------------------------ independence

    def _components(self, items: Sequence[int]) -> list[list[int]]:
        """Return the items in groups that share no variable, in order; an item without variables is alone."""
        groups: list[tuple[int, list[int]]] = []
        alone: list[list[int]] = []
        together = 0
        for item in items:
            variables = self._diagram.variables[item]
            if not variables:
                alone.append([item])
                continue
            if variables & together:
                joined = [group for group in groups if group[0] & variables]
                groups = [group for group in groups if not group[0] & variables]
                variables = reduce(or_, (other for other, _ in joined), variables)
                merged = [member for _, members in joined for member in members] + [item]
                groups.append((variables, merged))
            else:
                groups.append((variables, [item]))
            together |= variables
        return alone + [members for _, members in groups]


def _convolved(some: list[Value], others: list[Value], cap: int) -> list[Value]:
    """Return the distribution of a sum; what reaches `cap` is put together."""
    found: list[Value] = [0.0] * min(cap + 1, len(some) + len(others) - 1)
    for i, p in enumerate(some):
        for j, q in enumerate(others):
            k = min(i + j, cap)
            found[k] = found[k] + p * q
    return found
