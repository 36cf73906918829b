"""Rule files as texts, parsed into statements and faults."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from clingo import ast
from clingo.ast import AST, ASTType

from skolem.traces.errors import Fault

MAX_BYTES: Final = 200_000
GREATEST: Final = 2**31 - 1  # clingo counts in 32 bits and overflows without a message
_SKIPPED_OR_TOKEN: Final = re.compile(
    r"""%\*.*?\*%|%[^\n]*|"(?:\\.|[^"\\])*"|(?P<include>\#include\b)|(?<![\w'])(?P<number>[1-9]\d*)\b"""
    r"""|(?P<foreign>[^\x00-\x7f]+)""",  # clingo would print half a character, which cannot be decoded
    re.DOTALL,
)
_MESSAGE: Final = re.compile(r"(?P<file>.+?):(?P<line>\d+):(?P<column>\d+)(?:-[\d:]+)?: (?P<kind>\w+): (?P<text>.*)")
_UNSAFE: Final = re.compile(r":(?P<line>\d+):(?P<column>\d+)(?:-[\d:]+)?: note: '(?P<name>.+?)' is unsafe")


@dataclass(frozen=True, slots=True)
class RuleFile:
    """One rule file.

    Attributes:
        name: Its name without `.lp`.
        title: Its name in faults.
        path: The path it was read from, which clingo's messages carry.
        content: Its bytes.
        own: Whether it is a user's own file.
    """

    name: str
    title: str
    path: str
    content: bytes
    own: bool

    def fault(self, line: int, column: int, message: str) -> Fault:
        """Return a fault at a position in this file, with the text of that line."""
        lines = self.content.decode(errors="replace").splitlines()
        return Fault(self.title, line, column, message, excerpt=lines[line - 1] if 0 < line <= len(lines) else "")


def parse(file: RuleFile) -> tuple[list[AST], list[Fault]]:
    """Return the statements of a rule file that can be parsed, and a fault for each of the others."""
    if len(file.content) > MAX_BYTES:
        return [], [Fault(file.title, 0, 0, f"a rule file of {len(file.content)} bytes; at most {MAX_BYTES} are read")]
    try:
        text = file.content.decode()
    except UnicodeDecodeError as error:
        return [], [Fault(file.title, 0, 0, f"not UTF-8: byte {error.start}")]
    refused = [
        file.fault(*_place(text, match.start()), message)
        for match in _SKIPPED_OR_TOKEN.finditer(text)
        if (message := _token_refusal(match))
    ]
    if refused:
        return [], refused
    statements: list[AST] = []
    messages: list[str] = []
    try:
        ast.parse_files([file.path], statements.append, logger=lambda _code, message: messages.append(message))
    except RuntimeError:
        pass  # the messages say why
    return [s for s in statements if s.ast_type is not ASTType.Comment], explain(messages, [file])


def _token_refusal(match: re.Match[str]) -> str:
    """Return why a token is not allowed that the syntax tree does not keep."""
    if match["include"]:
        return "#include is not allowed: name each file"
    if match["foreign"]:
        return f"{match['foreign']!r} is not ASCII: outside of comments and texts, rules are"
    if match["number"] and int(match["number"]) > GREATEST:
        return f"{match['number']} does not fit 32 bits: at most {GREATEST}"
    return ""


def explain(messages: Iterable[str], files: Sequence[RuleFile]) -> list[Fault]:
    """Return clingo's messages about `files` as faults."""
    by_path = {file.path: file for file in files}
    faults = []
    for message in messages:
        match = _MESSAGE.match(message)
        if match is None or match["file"] not in by_path:
            faults.append(Fault("rules", 0, 0, " ".join(message.split())))
            continue
        unsafe = list(_UNSAFE.finditer(message))
        line, column = (unsafe[0] if unsafe else match).group("line", "column")
        text = " ".join(message[match.start("text") :].split())
        if unsafe:
            names = ", ".join(dict.fromkeys(note["name"] for note in unsafe))
            text = f"unsafe variable {names}: each must occur in a positive literal of the body"
        faults.append(by_path[match["file"]].fault(int(line), int(column), text))
    return faults


def _place(text: str, offset: int) -> tuple[int, int]:
    return text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset)
