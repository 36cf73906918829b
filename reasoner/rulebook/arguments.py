"""The arguments of word facts: their positions in a rule file, and the numbers that they may be."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from skolem.reasoner.terms import Compound, Term
from skolem.traces.errors import Fault


@dataclass(frozen=True, slots=True)
class Position:
    """The position of a fact in a rule file.

    Attributes:
        line: Line, from 1.
        column: Column, from 1.
        report: Makes a fault in its file from line, column and message.
        own: Whether the file is a user's own, whose facts replace those that ship.
        arguments: Line and column of each argument; empty if they are not written at that position.
    """

    line: int
    column: int
    report: Callable[[int, int, str], Fault]
    own: bool
    arguments: tuple[tuple[int, int], ...] = ()

    def fault(self, message: str, argument: int | None = None) -> Fault:
        """Return a fault at this position, or at one of the arguments, counted from 0."""
        if argument is None or not self.arguments:
            return self.report(self.line, self.column, message)
        return self.report(*self.arguments[argument], message)

    def __str__(self) -> str:
        """Return `file:line`."""
        return f"{self.fault('').file}:{self.line}"


@dataclass(frozen=True, slots=True)
class Range:
    """The numbers an argument may be: name, least, greatest (None: no end), unit, and other values allowed."""

    of: str
    low: int
    high: int | None
    unit: str
    instead: str = ""
    turns: bool = False  # whether the range is a circle, its end equal to its beginning

    def expected(self) -> str:
        """Return the allowed numbers in words."""
        upto = "" if self.high is None else f" to {self.high}"
        return f"{self.of} from {self.low}{upto} {self.unit}{self.instead}"

    def holds(self, value: Term) -> bool:
        """Return whether an argument is a number of the range."""
        return isinstance(value, int) and self.low <= value and (self.high is None or value <= self.high)

    def nearest(self, value: Term) -> str:
        """Return a hint at the nearest allowed value for a number out of the range."""
        if not isinstance(value, int):
            return "write a whole number"
        if self.turns and self.high is not None:
            return f"{value} {self.unit} are {value % self.high}"
        return f"write at least {self.low}" if value < self.low else f"write at most {self.high}"


def integers(fact: Compound, position: Position, faults: list[Fault], ranges: Sequence[Range]) -> list[int] | None:
    """Return the arguments after the word if each is an integer in its range."""
    good: list[int] = []
    for i, (value, allowed) in enumerate(zip(fact.args[1:], ranges, strict=False), 1):
        if isinstance(value, int) and allowed.holds(value):
            good.append(value)
        else:
            wrong = f"{fact.name} {fact.args[0]}: expected {allowed.expected()}, found {value}"
            faults.append(position.fault(f"{wrong}; {allowed.nearest(value)}", i))
    return good if len(good) == len(fact.args) - 1 else None
