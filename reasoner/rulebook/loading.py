"""Statements as they are loaded: made of those in rule files, parsed once, each on a line that tells its origin."""

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
        text: In one line.
        origin: The statement in a rule file of which it was made, or the first of several; None if there is none.
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
        self.statements = found[1:]  # the first is `#program base.`, which clingo says of its own accord
        self._origins = [line.origin for line in lines]

    def placed(self, message: str) -> str:
        """Return a message of clingo about these statements with the place in a rule file that it is about."""
        match = _PLACE.match(message)
        origin = None if match is None else self._origins[int(match["line"]) - 1]
        if match is None or origin is None:
            return message
        quoted = message.strip().rpartition("\n")[2].strip()
        about = next((node for node, _ in descend(origin) if str(node) == quoted), origin)
        begin = about.location.begin
        return f"{begin.filename}:{begin.line}:{begin.column}{message[match.end() :]}"
