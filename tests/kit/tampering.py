"""Edited traces in a sound container, so that only the content of the trace can reveal the edit."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from mcap.records import Chunk, DataEnd, Message

from skolem.traces.file.container import Copy, contents, pieces
from skolem.traces.file.writer import CHUNK_BYTES

Edit = Callable[[list[object]], list[object]]


def rewrite(source: Path, target: Path, edit: Edit) -> Path:
    """Write a copy of `source` with edited records: header, metadata, attachments, schemas, channels and messages."""
    with Copy(target, CHUNK_BYTES) as copy:
        for record in edit(records_of(source)):
            copy.add(record)
    return target


def records_of(path: Path) -> list[object]:
    """Return the records of a trace in file order, with those inside of chunks."""
    found: list[object] = []
    with path.open("rb") as file:
        for piece in pieces(file):
            if isinstance(piece.record, DataEnd):
                return found
            found += contents(piece) if isinstance(piece.record, Chunk) else [piece.record]
    raise AssertionError("no data end")


def messages(edit: Callable[[list[Message]], list[Message]]) -> Edit:
    """Return an edit of the messages alone."""

    def whole(records: list[object]) -> list[object]:
        found = [record for record in records if isinstance(record, Message)]
        return [record for record in records if not isinstance(record, Message)] + list(edit(found))

    return whole


def renumbered(found: list[Message]) -> list[Message]:
    """Return messages of one counter, numbered again without gaps, so that the change is hidden."""
    return [replace(message, sequence=number) for number, message in enumerate(found)]


def each(kind: type[object], change: Callable[..., object]) -> Edit:
    """Return an edit that changes every record of one kind."""
    return lambda records: [change(record) if isinstance(record, kind) else record for record in records]
