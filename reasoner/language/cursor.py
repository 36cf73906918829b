"""A cursor over the tokens of a text: the base of recursive-descent parsers."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NoReturn

from skolem.reasoner.language.remedies import hint_at_keyword, remedy_of_sign, remedy_of_word
from skolem.traces.errors import Fault

MAX_CHARACTERS: Final = 10_000
MAX_PARTS: Final = 100  # atoms, operators and parentheses; keeps recursion shallow
ALIASES: Final = {
    "∃": "exists",
    "∀": "every",
    "λ": "lambda",
    "ι": "the",  # noqa: RUF001 - the sign is meant
    "¬": "not",
    "∧": "&",
    "∨": "|",  # noqa: RUF001 - the sign is meant
    "→": "->",
    "≠": "!=",
    "iota": "the",
    "forall": "every",
}
_TOKEN: Final = re.compile(
    r"(?P<number>-?(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*|[∃∀λι¬])"
    r"|(?P<mark>[(),.&|∧∨→≠]|->|!=|=(?!>))",  # noqa: RUF001 - the signs are meant
    re.ASCII,
)


class ParseFault(Exception):  # noqa: N818 - it is a fault, reported as one
    """A text whose structure cannot be parsed, with the offset of the first wrong token."""

    def __init__(self, offset: int, message: str) -> None:
        super().__init__(message)
        self.offset, self.message = offset, message


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of text with its kind (number, name, mark or end) and its offset.

    Attributes:
        text: As the language spells it: `exists` for ∃.
        written: As it is written.
    """

    kind: str
    text: str
    offset: int
    written: str

    def __str__(self) -> str:
        return "the end" if self.kind == "end" else repr(self.written)


def fault_at(text: str, offset: int, message: str) -> Fault:
    """Return a fault of a goal with its line and column in the text."""
    start = text.rfind("\n", 0, offset) + 1
    line = text[start:].split("\n", 1)[0]
    return Fault("goal", text.count("\n", 0, offset) + 1, offset - start + 1, message, excerpt=line)


def tokens_of(text: str) -> list[Token]:
    """Return the tokens of a text; the last one marks the end.

    Raises:
        ParseFault: If a character starts no token, or the text is too long.
    """
    if len(text) > MAX_CHARACTERS:
        raise ParseFault(0, f"a goal of {len(text)} characters; at most {MAX_CHARACTERS} are read")
    found, offset = [], 0
    while offset < len(text):
        if text[offset].isspace():
            offset += 1
            continue
        match = _TOKEN.match(text, offset)
        if match is None or match.lastgroup is None:
            raise ParseFault(offset, remedy_of_sign(text[offset:]) or f"unexpected {text[offset]!r}")
        found.append(Token(match.lastgroup, ALIASES.get(match.group(), match.group()), offset, match.group()))
        offset = match.end()
    return [*found, Token("end", "", len(text), "")]


class Cursor:
    """The state of parsing one text.

    Attributes:
        words: Every known relation word with its number of arguments.
        tokens: All tokens; the last one marks the end.
        faults: (offset, message) of every fault that did not stop the parser.
    """

    def __init__(self, text: str, words: Mapping[str, int]) -> None:
        self.words = words
        self.tokens = tokens_of(text)
        self.faults: list[tuple[int, str]] = []
        self._position = self._parts = 0

    @property
    def token(self) -> Token:
        """The next token."""
        return self.tokens[self._position]

    @property
    def ahead(self) -> Sequence[Token]:
        """The next token and all after it."""
        return self.tokens[self._position :]

    def take(self) -> Token:
        """Return the next token and move on; the cursor stays at the end."""
        token = self.token
        self._position = min(self._position + 1, len(self.tokens) - 1)
        return token

    def accept(self, *texts: str) -> bool:
        """Move past the next token if it is one of `texts`; return whether it was."""
        found = self.token.kind != "end" and self.token.text in texts
        if found:
            self.take()
        return found

    def expect(self, text: str, where: str = "") -> None:
        """Move past the next token, which must be `text`; `where` ends the message of the fault."""
        if not self.accept(text):
            self.stop(f"expected {text!r}{where}")

    def expect_end(self) -> None:
        """Raise a `ParseFault` unless the cursor is at the end."""
        if self.token.kind != "end":
            self.stop("expected '&' or the end")

    def stop(self, expected: str) -> NoReturn:
        """Raise a `ParseFault` at the next token."""
        token = self.token
        if token.kind != "name":
            known = remedy_of_sign(token.text) if token.kind == "mark" else ""
            self.stop_at(token, known or f"{expected}, found {token}")
        remedy = remedy_of_word(token.text, self.words)
        self.stop_at(token, remedy or f"{expected}, found {token}{hint_at_keyword(token.text, self.words)}")

    def stop_at(self, token: Token, message: str) -> NoReturn:
        """Raise a `ParseFault` at a token."""
        raise ParseFault(token.offset, message)

    def complain(self, token: Token, message: str) -> None:
        """Record a fault at a token and go on."""
        self.faults.append((token.offset, message))

    def count_part(self) -> None:
        """Count one more part of the text; raise a `ParseFault` if there are too many."""
        self._parts += 1
        if self._parts > MAX_PARTS:
            self.stop_at(self.token, f"more than {MAX_PARTS} parts; state a simpler goal")
