"""Reading of a trace while it is written: every chunk as soon as it is on the disk.

The writer does not know of the reader. A run writes its messages to the disk at the end of each step.
"""

import os
import struct
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message as McapMessage

from skolem.traces.errors import TraceError
from skolem.traces.file.chunks import records_in
from skolem.traces.file.clock import tick_at
from skolem.traces.file.reader import MAGIC, Recorded

_HEADER = struct.Struct("<BQ")  # operation code and length of a record


def follow(path: Path) -> Iterator[Recorded | None]:
    """Yield the messages of a growing trace in file order, and None whenever no further message is there yet.

    The iterator ends with the trace. After a None the caller waits, and it stops when nobody writes any more.

    Raises:
        TraceError: If the file does not begin as an MCAP file.
    """
    while not os.path.exists(path):
        yield None
    channels: dict[int, Channel] = {}
    with path.open("rb") as file:
        while (magic := _complete(file, len(MAGIC))) is None:
            yield None
        if magic != MAGIC:
            raise TraceError(f"{path}: not a trace: it does not begin as an MCAP file")
        while True:
            record = _record(file)
            if record is None:
                yield None
                continue
            code, data = record
            if code == Opcode.DATA_END:
                return
            if code == Opcode.CHUNK:
                yield from _messages(data, channels)


def _record(file: IO[bytes]) -> tuple[int, bytes] | None:
    """Return the code and the bytes of the next record; None if it is incomplete, with the file where it was."""
    start = file.tell()
    header = _complete(file, _HEADER.size)
    if header is not None:
        code, length = _HEADER.unpack(header)
        data = _complete(file, length)
        if data is not None:
            return code, data
    file.seek(start)
    return None


def _complete(file: IO[bytes], size: int) -> bytes | None:
    """Return the next `size` bytes; None if there are fewer, with the file where it was."""
    start = file.tell()
    data = file.read(size)
    if len(data) == size:
        return data
    file.seek(start)
    return None


def _messages(data: bytes, channels: dict[int, Channel]) -> Iterator[Recorded]:
    """Yield the messages of a chunk, and add its channels to `channels`."""
    for record in records_in(Chunk.read(ReadDataStream(BytesIO(data)))):
        if isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, McapMessage):
            topic = channels[record.channel_id].topic
            yield Recorded(topic, tick_at(record.log_time), record.sequence, record.data)
