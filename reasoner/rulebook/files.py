"""Rule files as texts, parsed into statements and faults.

Rule files from others are data: reading one opens no other file. clingo opens what `#include` names while it parses, so
a file from others is first parsed where the system refuses to open anything, and what clingo complains of is a fault.
"""

import re
import resource
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

from clingo import ast
from clingo.ast import AST, ASTType

from skolem.traces.errors import Fault

MAX_BYTES: Final = 200_000
GREATEST: Final = 2**31 - 1  # clingo counts in 32 bits and overflows without a message
DEEPEST: Final = 100  # brackets and operators around a term: whoever walks over terms calls himself for each
_LONGEST: Final = 34  # a number in digits: one of 32 bits is not longer
_TOKEN: Final = re.compile(  # as clingo's lexer reads them: a text ends on its line
    r"""(?P<block>%\*)|%[^\n]*|"(?:\\["\\n]|[^"\\\n])*"|(?P<include>\#include)|(?<![\w'])(?P<number>0[xob][\da-fA-F]+|[1-9]\d*)\b"""
    r"""|(?P<open>[(\[{])|(?P<close>[)\]}])|(?P<next>[,;:.])|(?P<operator>[-+*/\\&?^~|@])"""
    r"""|(?P<foreign>[^\t\r\n\x20-\x7e]+)""",  # clingo would print half a character, which cannot be decoded
)
_BLOCK_MARK: Final = re.compile(r"%\*|\*%")
_NOT_OPENED: Final = "file could not be opened"
_NO_INCLUDE: Final = "#include is not allowed: name each file"
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
        ships: Whether its content is that of a file that ships.
        parsed: Whether it was parsed before, by a process that can be spared.
    """

    name: str
    title: str
    path: str
    content: bytes
    own: bool
    ships: bool = False
    parsed: bool = False

    def fault(self, line: int, column: int, message: str) -> Fault:
        """Return a fault at a position in this file, with the text of that line."""
        lines = self.content.decode(errors="replace").splitlines()
        return Fault(self.title, line, column, message, excerpt=lines[line - 1] if 0 < line <= len(lines) else "")


def parse(file: RuleFile) -> tuple[list[AST], list[Fault]]:
    """Return the statements of a rule file that can be parsed, and a fault for each of the others."""
    if len(file.content) > MAX_BYTES:
        return [], [Fault(file.title, 0, 0, f"a larger rule file: at most {MAX_BYTES} bytes are read")]
    try:
        text = file.content.decode()
    except UnicodeDecodeError as error:
        return [], [Fault(file.title, 0, 0, f"not UTF-8: byte {error.start}")]
    if not (file.ships or file.parsed):
        refused = [file.fault(*_place(text, at), message) for at, message in _refused_tokens(text)]
        refused = refused or _refused_statements(file)
        if refused:
            return [], refused
    statements: list[AST] = []
    messages: list[str] = []
    try:
        ast.parse_files([file.path], statements.append, logger=lambda _code, message: messages.append(message))
    except RuntimeError:
        pass  # the messages say why
    return [s for s in statements if s.ast_type is not ASTType.Comment], explain(messages, [file])


def _refused_tokens(text: str) -> Iterator[tuple[int, str]]:
    """Yield the position of each token that is not allowed, with the reason; the syntax tree does not keep them."""
    around: list[int] = []  # for each open bracket, how many operators stand around it
    operators, end = 0, 0
    while (match := _TOKEN.search(text, end)) is not None:
        end = match.end()
        match match.lastgroup:
            case "block":
                end = _end_of_comment(text, end)
            case "include":
                yield match.start(), _NO_INCLUDE
            case "foreign":
                yield match.start(), f"{match[0]!r} is not ASCII: outside of comments and texts, rules are"
            case "number" if len(match[0]) > _LONGEST or int(match[0], 0) > GREATEST:
                said = match[0] if len(match[0]) <= _LONGEST else f"a number of {len(match[0])} digits"
                yield match.start(), f"{said} does not fit 32 bits: at most {GREATEST}"
            case "open":
                around.append(operators)
            case "close" if around:
                operators = around.pop()
            case "next":
                operators = around[-1] if around else 0
            case "operator":
                operators += 1
        if match.lastgroup in ("open", "operator") and len(around) + operators == DEEPEST + 1:
            yield match.start(), f"more than {DEEPEST} brackets and operators around one term; state it in parts"


def _end_of_comment(text: str, begin: int) -> int:
    """Return where a comment `%* .. *%` ends; others may stand inside of it."""
    depth = 1
    while depth and (mark := _BLOCK_MARK.search(text, begin)) is not None:
        depth += 1 if mark[0] == "%*" else -1
        begin = mark.end()
    return begin if not depth else len(text)


def _refused_statements(file: RuleFile) -> list[Fault]:
    """Return a fault for each statement that would have clingo open a file, or read a second one as if it were here."""
    programs: list[AST] = []
    messages: list[str] = []

    def keep(statement: AST) -> None:
        if statement.ast_type is ASTType.Program:
            programs.append(statement)

    with _nothing_opened():
        try:
            ast.parse_string(file.content.decode(), keep, logger=lambda _code, text: messages.append(text))
        except RuntimeError:
            pass  # the messages say why
    places = [found for text in messages if _NOT_OPENED in text and (found := _MESSAGE.match(text))]
    faults = [file.fault(int(found["line"]), int(found["column"]), _NO_INCLUDE) for found in places]
    for program in programs[1:]:  # clingo begins with one, and comes back to it after each file that it includes
        begin = program.location.begin
        faults.append(file.fault(begin.line, begin.column, "#program is not allowed in a rule file; leave it out"))
    return faults


@contextmanager
def _nothing_opened() -> Iterator[None]:
    """Have the system refuse to open files for a while."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


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
