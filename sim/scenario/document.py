"""A scenario file read as YAML: its plain values, and the position of each in the text.

The round-trip loader gives positions and makes no Python objects. Before it runs, the file is walked event by event and
refused if it is too large, too deep or tagged, or if its aliases would unfold into too many values.
"""

import difflib
import json
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from io import StringIO
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    CollectionEndEvent,
    CollectionStartEvent,
    Event,
    ScalarEvent,
)

from skolem.traces.errors import Fault, InputError
from skolem.traces.given import read_regular

MAX_BYTES = 1024 * 1024
MAX_VALUES = 20_000
MAX_DEPTH = 32
_KEPT = 8  # texts whose trees are kept
_SHOWN = 160  # characters of a flag that are shown in messages
MAX_SCALAR = 3_500  # a number of so many hexadecimal digits has less than the 4,300 digits that Python prints

Address = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Document:
    """A scenario file that is YAML, not yet known to be a scenario.

    Attributes:
        file: The given name of the file.
        text: Its text.
        values: Its values in plain dictionaries, lists, strings, numbers and None, with the overrides applied.
        rules: Paths of the extra rule files that it names.
        overrides: The flags that changed `values`, with the address each of them set.
    """

    file: str
    text: str
    values: dict[str, Any]
    rules: tuple[Path, ...]
    overrides: tuple[tuple[str, Address], ...]
    tree: Any

    def effective_text(self) -> str:
        """Return the text of the scenario that runs: the original text, or a new one if flags changed values."""
        if not self.overrides:
            return self.text
        stream = StringIO()
        yaml = YAML(typ="safe", pure=True)
        yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
        yaml.dump(self.values, stream)
        return "".join(f"# {flag}\n" for flag, _ in self.overrides) + stream.getvalue()

    def fault(self, address: Address, message: str, offset: int | None = None, at_key: bool = False) -> Fault:
        """Return a fault at a value of the file, or at the flag that set it.

        Args:
            address: Keys and indices from the root; a missing part has the position of its deepest existing parent.
            message: Text of the fault.
            offset: Count of characters into the string value at `address`.
            at_key: Whether the position is that of the key instead of its value.
        """
        at = ".".join(map(str, address))
        flag = next((flag for flag, there in self.overrides if address[: len(there)] == there), None)
        if flag is not None:
            return Fault(flag, 0, 0, message, at)
        line, column = self._position(address, at_key)
        if offset is not None:
            line, column = self._inside(line, column, str(self._value(address)), offset)
        return Fault(self.file, line + 1, column + 1, message, at, _line(self.text, line))

    def _value(self, address: Address) -> Any:
        value: Any = self.values
        for key in address:
            value = value[key]
        return value

    def _position(self, address: Address, at_key: bool = False) -> tuple[int, int]:
        """Return line and column, from 0, of the deepest part of `address` that exists."""
        node, position = self.tree, (0, 0)
        for i, key in enumerate(address):
            try:
                if isinstance(node, CommentedMap):
                    found = node.lc.key(key) if at_key and i == len(address) - 1 else node.lc.value(key)
                else:
                    found = node.lc.item(key)
                position = found or position  # an empty value may have no position of its own
                node = node[key]
            except (KeyError, IndexError, AttributeError, TypeError):
                break
        return position

    def _inside(self, line: int, column: int, value: str, offset: int) -> tuple[int, int]:
        """Return the position of the character at `offset` of a string, also in folded lines and block scalars.

        The value and its source differ in blanks alone, so the visible characters before `offset` are counted.
        """
        lines = self.text.split("\n")
        if lines[line][column : column + 1] in ("|", ">"):
            line, column = line + 1, 0
        elif lines[line][column : column + 1] in ("'", '"'):
            column += 1
        before = sum(not c.isspace() for c in value[:offset])
        end = (line, column)
        for row in range(line, len(lines)):
            for col in range(column if row == line else 0, len(lines[row])):
                if lines[row][col].isspace():
                    continue
                if before == 0 and offset < len(value):
                    return row, col
                before -= 1
                if before < 0:
                    return end
                end = (row, col + 1)
        return end


def load_document(path: Path, overrides: Sequence[str] = ()) -> Document:
    """Return the file as a document, with `a.b=value` overrides applied.

    Raises:
        InputError: If the file cannot be read, is not safe YAML or not a mapping, or an override's address does not
        exist.
    """
    document = read_document(str(path), _text(path), overrides)
    names = document.values.get("rules")
    rules = [name for name in names if isinstance(name, str)] if isinstance(names, list) else []
    return replace(document, rules=tuple(path.parent / name for name in rules))


def read_document(file: str, text: str, overrides: Sequence[str] = ()) -> Document:
    """Return a text as a document without rule files, with `a.b=value` overrides applied.

    Raises:
        InputError: If the text is not safe YAML or not a mapping, or an override's address does not exist.
    """
    tree = _parse(file, text)
    if not isinstance(tree, dict):
        raise InputError(
            [Fault(file, 1, 1, "expected a mapping with the keys of a scenario (skolem: 1, name, goal, ...)")]
        )
    values = _plain(tree)
    applied = tuple(_override(values, flag) for flag in overrides)
    return Document(file, text, values, (), applied, tree)


def nearest(word: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'x'?`, or the list of known words."""
    names: Collection[str] = sorted(set(known))
    close = difflib.get_close_matches(word, names, 1)
    return f"; did you mean '{close[0]}'?" if close else f"; there are: {', '.join(names) or 'none'}"


def _text(path: Path) -> str:
    """Return the file's text with line feeds alone as line ends."""
    try:
        data = read_regular(path, MAX_BYTES)
    except OSError as error:
        raise InputError([Fault(str(path), 0, 0, f"cannot be read: {error.strerror}")]) from error
    if len(data) > MAX_BYTES:
        raise InputError([Fault(str(path), 0, 0, f"larger than {MAX_BYTES} bytes, the limit of a scenario file")])
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise InputError(
            [Fault(str(path), 0, 0, f"not UTF-8: byte {error.start} is {data[error.start]:#04x}")]
        ) from error


class _UnsafeError(Exception):
    """A text would unfold into more, deeper or other values than a scenario can need."""

    def __init__(self, event: Event, message: str) -> None:
        super().__init__(message)
        self.mark = event.start_mark


def _parse(file: str, text: str) -> Any:
    """Return ruamel's tree; raise the first fault, since the rest of a broken text is not reliable."""
    try:
        return _tree(text)
    except _UnsafeError as error:
        line, column = error.mark.line, error.mark.column
        raise InputError([Fault(file, line + 1, column + 1, str(error), "", _line(text, line))]) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line, mark.column) if mark else (0, 0)
        said = str(error.problem or error.context).splitlines()[0]
        raise InputError([Fault(file, line + 1, column + 1, f"not YAML: {said}", "", _line(text, line))]) from error
    except (YAMLError, ValueError) as error:
        raise InputError([Fault(file, 0, 0, f"not YAML: {str(error).splitlines()[0]}")]) from error


@lru_cache(_KEPT)
def _tree(text: str) -> Any:
    """Return ruamel's tree of a safe text, to be read only; runs of the same text share it, as parsing takes long."""
    _refuse_unsafe(text)
    return YAML(typ="rt", pure=True).load(text)


def _refuse_unsafe(text: str) -> None:
    """Raise if the text would unfold into more, deeper or other values than a scenario can need."""
    sizes: dict[str, int] = {}  # of each anchored value, aliases unfolded
    open_anchors: list[str | None] = []
    started: list[int] = []
    total = 0
    for event in YAML(typ="rt", pure=True).parse(text):
        if isinstance(event, AliasEvent):
            if event.anchor not in sizes:
                raise _UnsafeError(event, f"no finished value is anchored as '&{event.anchor}'")
            total += sizes[event.anchor]
        elif isinstance(event, ScalarEvent | CollectionStartEvent):
            total += 1
            if event.tag is not None:
                raise _UnsafeError(event, f"tags such as {event.tag} are not used in scenario files")
            if isinstance(event, CollectionStartEvent):
                open_anchors.append(event.anchor)
                started.append(total)
            elif len(event.value) > MAX_SCALAR:
                raise _UnsafeError(event, f"a value of more than {MAX_SCALAR} characters")
            elif event.anchor:
                sizes[event.anchor] = 1
        elif isinstance(event, CollectionEndEvent):
            anchor, start = open_anchors.pop(), started.pop()
            if anchor:
                sizes[anchor] = total - start + 1
        if total > MAX_VALUES or len(started) > MAX_DEPTH:
            raise _UnsafeError(event, f"more than {MAX_VALUES} values, or nested deeper than {MAX_DEPTH}")


@lru_cache(2)
def _lines(text: str) -> tuple[str, ...]:
    """Return the lines of a text, split once: thousands of faults may lie on one long line, and share it."""
    return tuple(text.split("\n"))


def _line(text: str, line: int) -> str:
    lines = _lines(text)
    return lines[line] if line < len(lines) else ""


def _plain(node: Any) -> Any:
    """Return the value without ruamel's types; a value outside the YAML 1.2 core becomes its text."""
    if isinstance(node, dict):
        return {key if isinstance(key, str) else str(key): _plain(value) for key, value in node.items()}
    if isinstance(node, list | tuple):
        return [_plain(value) for value in node]
    if node is None or isinstance(node, bool):
        return node
    for kind in (int, float):
        if isinstance(node, kind):
            return kind(node)
    return str(node)


def _override(values: dict[str, Any], flag: str) -> tuple[str, Address]:
    """Set one value from `a.b=value` and return the flag with the address it set."""
    name = f"--set {flag}" if len(flag) <= _SHOWN else f"--set {flag[:_SHOWN]}..."
    path, equals, text = flag.partition("=")
    if not equals or not path:
        raise InputError([Fault(name, 0, 0, "expected a.b=value, for example noise.detection.found=1.0")])
    *parents, last = path.split(".")
    node: Any = values
    address: list[str | int] = []
    for part in parents:
        key = _key(node, part)
        if key is None:
            raise InputError([_no_place(name, node, part)])
        node = node[key]
        address.append(key)
        if not isinstance(node, dict | list):
            raise InputError([_no_parts(name, address, node)])
    key = _key(node, last) if isinstance(node, list) else last
    if key is None:
        raise InputError([_no_place(name, node, last)])
    node[key] = _plain(_parse(name, text))
    return name, (*address, key)


def _key(node: Any, part: str) -> str | int | None:
    """Return the key or index that `part` names in a mapping or list, or None."""
    if isinstance(node, list):
        return int(part) if part.isdecimal() and int(part) < len(node) else None
    return part if part in node else None


def _no_parts(flag: str, address: Iterable[str | int], value: Any) -> Fault:
    whole = ".".join(map(str, address))
    said = f"'{whole}' is {json.dumps(value)} and has no parts to set"
    return Fault(flag, 0, 0, f"{said}; if it may be a mapping, make it one first: --set '{whole}={{...}}'")


def _no_place(flag: str, node: Any, part: str) -> Fault:
    there = map(str, range(len(node))) if isinstance(node, list) else node
    return Fault(flag, 0, 0, f"nothing to set at '{part}'{nearest(part, there)}")
