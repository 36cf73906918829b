"""Formulas over independent finite variables, each formula once.

A literal is a variable and a set of its values, as bits of a number. Literals of one variable are joined when a formula
is made: green and green is green, and soda or bottle is one set. Negation is pushed down to the literals, so that only
counts keep one.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FALSE: Final = 0
TRUE: Final = 1


@dataclass(frozen=True, slots=True)
class Lit:
    """The variable has one of the values in the mask."""

    variable: int
    mask: int


@dataclass(frozen=True, slots=True)
class Rel:
    """A relation that is known once the poses are: it holds, or it does not."""

    index: int
    holds: bool


@dataclass(frozen=True, slots=True)
class Many:
    """All of the items hold, or at least one does."""

    kind: Literal["all", "some"]
    items: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Number:
    """At least `least` and at most `most` of the items hold, or not so."""

    items: tuple[int, ...]
    least: int
    most: int
    holds: bool


Formula = Lit | Rel | Many | Number | None


class Diagram:
    """Variables and formulas over them; a formula is a number, and equal formulas have equal numbers."""

    def __init__(self) -> None:
        self.formulas: list[Formula] = [None, None]  # false and true
        self.weights: list[tuple[float, ...]] = []  # the probability of each value, by variable
        self.variables: list[int] = [0, 0]  # the variables that a formula depends on, as bits of a number
        self.relational: list[bool] = [False, False]  # whether it depends on relations
        self._possible: list[int] = []  # the values with a probability, as bits, by variable
        self._known: dict[Formula, int] = {}
        self._negated: dict[int, int] = {FALSE: TRUE, TRUE: FALSE}

    # ------------------------------------------------------------ making

    def variable(self, probabilities: Sequence[float] | Array) -> int:
        """Return a new variable with the probabilities of its values."""
        values = tuple(map(float, probabilities))
        self.weights.append(values)
        self._possible.append(sum(1 << i for i, p in enumerate(values) if p > 0.0))
        return len(self.weights) - 1

    def possible(self, variable: int) -> int:
        """Return the values of a variable that have a probability, as bits."""
        return self._possible[variable]

    def literal(self, variable: int, mask: int) -> int:
        """Return: the variable has a value in the mask."""
        mask &= self._possible[variable]
        if not mask:
            return FALSE
        return TRUE if mask == self._possible[variable] else self._keep(Lit(variable, mask), 1 << variable, False)

    def relation(self, index: int) -> int:
        """Return: the relation with that number holds."""
        return self._keep(Rel(index, True), 0, True)

    def all_of(self, items: Iterable[int]) -> int:
        """Return: all items hold."""
        return self._many("all", items)

    def some_of(self, items: Iterable[int]) -> int:
        """Return: at least one item holds."""
        return self._many("some", items)

    def negation(self, formula: int) -> int:
        """Return: the formula does not hold."""
        if formula not in self._negated:
            found = self._negation(formula)
            self._negated[formula], self._negated[found] = found, formula
        return self._negated[formula]

    def number(self, items: Iterable[int], least: int, most: int | None) -> int:
        """Return: at least `least` and, unless None, at most `most` of the items hold; an item may occur repeatedly."""
        kept = sorted(item for item in items if item != FALSE)
        sure = sum(item == TRUE for item in kept)
        kept = [item for item in kept if item != TRUE]
        low = max(0, least - sure)
        high = len(kept) if most is None else min(len(kept), most - sure)
        if low > high:
            return FALSE
        if low == 0 and high == len(kept):
            return TRUE
        if low == 1 and high == len(kept):
            return self.some_of(kept)
        if low == high == len(kept):
            return self.all_of(kept)
        if low == high == 0:
            return self.negation(self.some_of(kept))
        return self._keep(Number(tuple(kept), low, high, True), *self._joint(kept))

    def _many(self, kind: Literal["all", "some"], items: Iterable[int]) -> int:
        neutral, ruling = (TRUE, FALSE) if kind == "all" else (FALSE, TRUE)
        masks: dict[int, int] = {}
        others: set[int] = set()
        waiting = list(items)
        for item in waiting:  # grows while it is gone through
            found = self.formulas[item]
            if item == ruling:
                return ruling
            if isinstance(found, Lit):
                before = masks.get(found.variable)
                masks[found.variable] = (
                    found.mask if before is None else before & found.mask if kind == "all" else before | found.mask
                )
            elif isinstance(found, Many) and found.kind == kind:
                waiting += found.items
            elif item != neutral:
                others.add(item)
        literals = {self.literal(variable, mask) for variable, mask in masks.items()} - {neutral}
        if ruling in literals or any(self._negated.get(item) in others for item in others):
            return ruling
        kept = tuple(sorted(literals | others))
        if len(kept) < 2:
            return kept[0] if kept else neutral
        return self._keep(Many(kind, kept), *self._joint(kept))

    def _negation(self, formula: int) -> int:
        match self.formulas[formula]:
            case Lit(variable, mask):
                return self.literal(variable, self._possible[variable] & ~mask)
            case Rel(index, holds):
                return self._keep(Rel(index, not holds), 0, True)
            case Many(kind, items):
                return self._many("some" if kind == "all" else "all", map(self.negation, items))
            case Number(items, least, most, holds):
                return self._keep(Number(items, least, most, not holds), *self._joint(items))
        raise AssertionError(formula)

    def _joint(self, items: Iterable[int]) -> tuple[int, bool]:
        variables, relational = 0, False
        for item in items:
            variables |= self.variables[item]
            relational |= self.relational[item]
        return variables, relational

    def _keep(self, formula: Formula, variables: int, relational: bool) -> int:
        if formula not in self._known:
            self._known[formula] = len(self.formulas)
            self.formulas.append(formula)
            self.variables.append(variables)
            self.relational.append(relational)
        return self._known[formula]

    # ------------------------------------------------------------ conditioning

    def masks(self, formula: int, variable: int) -> set[int]:
        """Return the masks of the literals of a variable in a formula."""
        found: set[int] = set()
        seen: set[int] = set()
        waiting = [formula]
        while waiting:
            item = waiting.pop()
            if item in seen or not self.variables[item] >> variable & 1:
                continue
            seen.add(item)
            match self.formulas[item]:
                case Lit(_, mask):
                    found.add(mask)
                case Many(_, items) | Number(items, _, _, _):
                    waiting += items
        return found

    def given(self, formula: int, variable: int, block: int, done: dict[int, int]) -> int:
        """Return the formula given that a variable has a value in one of its blocks.

        Args:
            formula: The formula.
            variable: The variable.
            block: Values that each literal of the variable in the formula contains or excludes together.
            done: The results so far, for this variable and block.
        """
        if not self.variables[formula] >> variable & 1:
            return formula
        if formula not in done:
            done[formula] = self._given(formula, variable, block, done)
        return done[formula]

    def _given(self, formula: int, variable: int, block: int, done: dict[int, int]) -> int:
        match self.formulas[formula]:
            case Lit(_, mask):
                return TRUE if mask & block else FALSE
            case Many(kind, items):
                return self._many(kind, [self.given(item, variable, block, done) for item in items])
            case Number(items, least, most, holds):
                found = self.number([self.given(item, variable, block, done) for item in items], least, most)
                return found if holds else self.negation(found)
        raise AssertionError(formula)
