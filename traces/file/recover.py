"""Recovery of a trace that was cut off or damaged: its whole messages become a readable trace."""

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from mcap.reader import make_reader
from mcap.records import Channel, Chunk, DataEnd, Message as McapMessage, Schema
from mcap.stream_reader import MAGIC_SIZE

from skolem.traces.errors import Fault, InputError, TraceError
from skolem.traces.file.chunks import DAMAGE
from skolem.traces.file.clock import tick_at
from skolem.traces.file.container import Copy, DamageError, Piece, contents, pieces
from skolem.traces.file.reader import opened
from skolem.traces.file.writer import CHUNK_BYTES
from skolem.traces.messages import TICKS_PER_SECOND


@dataclass(slots=True)
class Recovered:
    """What was saved of a trace.

    Attributes:
        path: The new trace.
        messages: Number of saved messages.
        steps: Number of executed actions among them.
        simulated_s: Simulated time of the last message, in seconds.
        ended: Whether the end of the run is among them.
        lost: The lost parts: offset in the damaged file, and reason.
    """

    path: Path
    messages: int = 0
    steps: int = 0
    simulated_s: float = 0.0
    ended: bool = False
    lost: list[DamageError] = field(default_factory=list)


def recover(bad: Path, good: Path) -> Recovered:
    """Copy every whole message of `bad`, with schemas, channels, attachments and metadata, unchanged to `good`.

    A damaged record is left out and the records after it are kept. If its length cannot be trusted, the index at the
    end of the file tells where the next record begins; a file that was cut off has no index, and is saved up to that
    record. The content hash is copied unchanged if it is whole: by it `check` tells what is missing, and where.

    Raises:
        InputError: If `good` cannot be written, or exists: the file there may be worth more than the recovered one.
        TraceError: If `bad` is no MCAP file, or no message in it is whole.
    """
    if os.path.realpath(good) == os.path.realpath(bad):
        raise InputError([Fault(str(good), 0, 0, "is the damaged file itself; give another name")])
    if os.path.lexists(good):
        raise InputError([Fault(str(good), 0, 0, "exists and is not replaced; give another name, or remove it first")])
    found = Recovered(good)
    with opened(bad) as file:
        index = _Index.read(file)
        with Copy(good, CHUNK_BYTES) as copy:
            for piece in _whole(file, index.starts, found.lost):
                if isinstance(piece.record, Chunk):
                    _copy_chunk(piece, index, copy, found)
                elif isinstance(piece.record, McapMessage):
                    _copy_message(piece, piece.record, index, copy, found)
                else:
                    copy.add(piece.record)
            if not found.messages:
                raise TraceError(f"{bad}: no message in it is whole: nothing can be saved")
    return found


@dataclass(frozen=True, slots=True)
class _Index:
    """The index at the end of a file; empty if it is missing or damaged."""

    starts: tuple[int, ...] = ()
    schemas: tuple[Schema, ...] = ()
    channels: tuple[Channel, ...] = ()

    @classmethod
    def read(cls, file: IO[bytes]) -> "_Index":
        try:
            summary = make_reader(file, validate_crcs=True).get_summary()
        except DAMAGE:
            summary = None
        if summary is None:
            return cls()
        starts = [index.chunk_start_offset for index in summary.chunk_indexes]
        starts += [index.offset for index in summary.attachment_indexes]
        starts += [index.offset for index in summary.metadata_indexes]
        return cls(tuple(sorted(starts)), tuple(summary.schemas.values()), tuple(summary.channels.values()))


def _whole(file: IO[bytes], starts: tuple[int, ...], lost: list[DamageError]) -> Iterator[Piece]:
    """Yield the readable records of the data section; after a damaged one go on at the next known start."""
    byte: int | None = MAGIC_SIZE
    while byte is not None:
        try:
            for piece in pieces(file, byte):
                if isinstance(piece.record, DataEnd):
                    lost += _behind(file, piece.byte)
                    return
                yield piece
        except DamageError as damage:
            lost.append(damage)
            byte = next((start for start in starts if start > damage.byte), damage.end)
        else:
            return


def _behind(file: IO[bytes], byte: int) -> list[DamageError]:
    """Return the bytes after the end of a trace, whose data end at `byte`, as damage; none if the index is damaged."""
    end = byte
    try:
        for piece in pieces(file, byte):
            end = piece.byte + len(piece.data) + MAGIC_SIZE
    except DamageError:
        return []
    size = file.seek(0, 2)
    said = f"{size - end} bytes behind the end of the trace are left out: another one, perhaps"
    return [DamageError(end, said)] if size > end else []


def _copy_chunk(piece: Piece, index: _Index, copy: Copy, found: Recovered) -> None:
    try:
        for record in contents(piece):
            if isinstance(record, McapMessage):
                _copy_message(piece, record, index, copy, found)
            else:
                copy.add(record)
    except DamageError as damage:
        found.lost.append(damage)
    copy.end_chunk()


def _copy_message(piece: Piece, record: McapMessage, index: _Index, copy: Copy, found: Recovered) -> None:
    if not copy.knows(record.channel_id):  # the chunk that introduced the channels is lost
        for known in (*index.schemas, *index.channels):
            copy.add(known)
    if not copy.knows(record.channel_id):
        found.lost.append(DamageError(piece.byte, f"a message of channel {record.channel_id}, which is not known"))
        return
    copy.add(record)
    topic = copy.topic(record.channel_id)
    found.messages += 1
    found.steps += topic == "/action/result"
    found.ended |= topic == "/run/end"
    found.simulated_s = tick_at(record.log_time) / TICKS_PER_SECOND
