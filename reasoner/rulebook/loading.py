"""Statements as clingo loads them: each is one line of text and knows its origin in a rule file."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from clingo import ast
from clingo.ast import AST

from skolem.reasoner.rulebook.validate import descend

_PLACE: Final = re.compile(r"<string>:(?P<line>\d+):\d+(?:-[\d:]*\d)?(?=: )")


@dataclass(frozen=True, slots=True)
class Line:
    """A statement as text.

    Attributes:
        text: The statement in one line.
        origin: The statement of a rule file that it was made from, or the first of several; None if there is none.
    """

    text: str
    origin: AST | None = None


class Loaded:
    """Statements that are loaded together.

    Attributes:
        statements: Their syntax trees.
    """

    def __init__(self, lines: Sequence[Line]) -> None:
        """Parse statements."""
        found: list[AST] = []
        ast.parse_string("\n".join(line.text for line in lines), found.append)
        self.statements = found[1:]  # the first is `#program base.`, which clingo adds by itself
        self._origins = [line.origin for line in lines]

    def placed(self, message: str) -> str:
        """Return a message of clingo about these statements, with the position in a rule file put in."""
        match = _PLACE.match(message)
        origin = None if match is None else self._origins[int(match["line"]) - 1]
        if match is None or origin is None:
            return message
        quoted = message.strip().rpartition("\n")[2].strip()
        about = next((node for node, _ in descend(origin) if str(node) == quoted), origin)
        begin = about.location.begin
        return f"{begin.filename}:{begin.line}:{begin.column}{message[match.end() :]}"
