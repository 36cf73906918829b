"""The errors that the product raises on purpose, as a short tree.

SkolemError
├── InputError        a file, goal, rule or flag given by a person is wrong: every fault at once, exit code 2
│   └── BrokenRulesError  rules of a user break their contract while they are asked
├── TraceError        a trace cannot be read or is not sound, exit code 3
│   └── UnwrittenError  a trace cannot be written to its end: the disk is full
└── InternalError     the product's own contract was broken (a rule file without exactly one answer set, ...)
    └── RuleError     by rules, while they were asked; of a user's own rules it becomes a BrokenRulesError

May import: nothing.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

MOST_FAULTS: Final = 100  # in the text of an error: nobody reads more, and a line may be long
_AROUND: Final = 60  # characters of a line that are shown before and after the position of a fault
_LONGEST: Final = 10_000  # characters of an error that are recorded
_FOLDERS: Final = re.compile(r"(?<![\w.])/(?:[^\s/:'\"]+/)+")  # of an absolute path, in a text


@dataclass(frozen=True, slots=True, order=True)
class Fault:
    """One mistake in one place of something a person wrote.

    Attributes:
        file: Name of the file, or of the option or argument ("--seed", "goal").
        line: Line, counted from 1; 0 when there is no place.
        column: Column, counted from 1; 0 when there is no place.
        message: What is wrong and what was expected, in one line.
        at: Address inside the file ("belief.objects.1.type"), empty if it has none.
        excerpt: The offending line, for a caret below it; empty if there is none.
    """

    file: str
    line: int
    column: int
    message: str
    at: str = ""
    excerpt: str = ""

    def __str__(self) -> str:
        """Return `file:line:column: at: message`, and the line with a caret if there is one."""
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        head = f"{place}: {self.at}: {self.message}" if self.at else f"{place}: {self.message}"
        if not self.excerpt:
            return head
        indent = len(self.excerpt) - len(self.excerpt.lstrip())
        begin = max(indent, min(self.column - _AROUND, len(self.excerpt) - 2 * _AROUND))
        text = self.excerpt[begin : begin + 2 * _AROUND]
        caret = " " * max(0, self.column - 1 - begin)
        return f"{head}\n    {text}\n    {caret}^"


def error_text(error: BaseException) -> str:
    """Return an exception as a trace records it: type and message, without the folders of this machine."""
    try:
        said = error.strerror or "" if isinstance(error, OSError) else _FOLDERS.sub("", str(error)[:_LONGEST])
    except ValueError:  # it holds a number of more digits than Python prints
        said = ""
    return f"{type(error).__name__}: {said}".rstrip(": ")


class SkolemError(Exception):
    """Base of every error the product raises on purpose."""


class InputError(SkolemError):
    """Input of a person is wrong; carries every fault found, sorted by place."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(sorted(faults))
        more = [f"and {len(self.faults) - MOST_FAULTS} more"] if len(self.faults) > MOST_FAULTS else []
        super().__init__("\n".join([*map(str, self.faults[:MOST_FAULTS]), *more]))

    def __reduce__(self) -> tuple[type["InputError"], tuple[tuple[Fault, ...]]]:
        return type(self), (self.faults,)


class BrokenRulesError(InputError):
    """A user's own rules broke their contract while they were asked: the run cannot go on, as in every repetition."""


class TraceError(SkolemError):
    """A trace cannot be read or is not sound."""


class NotRecordedError(SkolemError):
    """A geometric question has no answer in a trace, and there is no planner."""


class UnwrittenError(TraceError):
    """A trace cannot be written to its end; the message names the file that holds the written part."""


class InternalError(SkolemError):
    """The product broke its own contract; the message names the file or step."""


class RuleError(InternalError):
    """Rules broke their contract while they were asked: of rules from others, a mistake of whoever wrote them.

    Attributes:
        about: A word that stands in the rule: a predicate, the functor of a fluent, or a query such as `@present`.
    """

    about: str

    def __init__(self, message: "str | RuleError", about: str = "") -> None:
        if isinstance(message, RuleError):  # clingo wraps what a query raises in another of its kind
            about = message.about
        super().__init__(str(message), about)
        self.about = about

    def __str__(self) -> str:
        return str(self.args[0])
