"""A parser for recorded terms, `b(den(e1,sodaE),105361)` or `Place(sodaC, table1)`, without a solver."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

_TOKEN: Final = re.compile(r"\s*([^\s(),]+|[(),])")
_START: Final = re.compile(r"[A-Za-z_]\w*\(")
_MOST_COMPOUNDS: Final = 100  # most compounds in one term: keeps recursion shallow for any trace


@dataclass(frozen=True, slots=True)
class Recorded:
    """A recorded term.

    Attributes:
        name: Its functor, constant or number; empty for a tuple.
        args: Its arguments; empty for a constant or a number.
    """

    name: str
    args: tuple["Recorded", ...] = ()

    def __str__(self) -> str:
        return f"{self.name}({', '.join(map(str, self.args))})" if self.args else self.name or "()"

    @property
    def number(self) -> int | None:
        """Its value; None if it is no whole number."""
        return int(self.name) if not self.args and re.fullmatch(r"-?\d+", self.name) else None


def read(text: str) -> Recorded | None:
    """Return the term of a text; None if the text is no term."""
    tokens = _TOKEN.findall(text)
    if not tokens or text.count("(") > _MOST_COMPOUNDS or "".join(tokens) != re.sub(r"\s", "", text):
        return None
    try:
        found, end = _read(tokens, 0)
    except IndexError:
        return None
    return found if end == len(tokens) else None


def _read(tokens: list[str], at: int) -> tuple[Recorded, int]:
    """Return the term that begins at a token, and the index of the next token.

    Raises:
        IndexError: If the text is no term.
    """
    name = ""
    if tokens[at] not in "(),":
        name, at = tokens[at], at + 1
        if at == len(tokens) or tokens[at] != "(":
            return Recorded(name), at
    if tokens[at] != "(":
        raise IndexError
    args, at = [], at + 1
    while tokens[at] != ")":
        arg, at = _read(tokens, at)
        args.append(arg)
        if tokens[at] not in ",)":
            raise IndexError
        at += tokens[at] == ","
    return Recorded(name, tuple(args)), at + 1


def within(text: str) -> Iterator[tuple[int, int]]:
    """Yield the start and end in a text of each outermost term with arguments."""
    end = 0
    while (start := _START.search(text, end)) is not None:
        end, depth = start.end(), 1
        while depth and end < len(text):
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        if not depth:
            yield start.start(), end
