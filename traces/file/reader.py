"""Reading of a trace with one chunk in memory.

Opening a trace compares both checksums of the container with the whole file, so that a file that opens can be read.
"""

import io
import struct
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import IO, TypeVar

from google.protobuf.message import Message as Protobuf
from mcap.data_stream import ReadDataStream
from mcap.reader import FOOTER_SIZE, McapReader, make_reader
from mcap.records import Channel, Chunk, Message as McapMessage
from mcap.stream_reader import MAGIC_SIZE
from mcap.summary import Summary

from skolem.traces.errors import TraceError
from skolem.traces.file.chunks import DAMAGE, records_in
from skolem.traces.file.clock import tick_at, time_ns
from skolem.traces.file.codec import CONTENT, ContentHash, counter_of, decode, misfit
from skolem.traces.given import opened_regular
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, SCHEMA_VERSION, TICKS_PER_SECOND, Message

MAGIC = b"\x89MCAP0\r\n"  # the first and the last bytes of the file
DATA_END_SIZE = 1 + 8 + 4
BLOCK_BYTES = 1 << 20
RECOVER = "`skolem recover` saves what is whole"
UNREADABLE = "`skolem check` says whether the trace was changed; if not, use the version that recorded it"

M = TypeVar("M", bound=Message)
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Recorded:
    """One message of a trace.

    Attributes:
        topic: One of `messages.topics`.
        tick: Simulated time, in ticks since the start.
        sequence: Position among the messages of its class group (decisions, truth, perf).
        data: The bytes as recorded.
        path: The trace, for errors; None for a message that is in no file.
    """

    topic: str
    tick: int
    sequence: int
    data: bytes
    path: Path | None = field(default=None, compare=False, repr=False)

    @property
    def message(self) -> Message | Protobuf:
        """The decoded message.

        Raises:
            TraceError: If the bytes are not a message of the topic's type.
        """
        try:
            return decode(self.topic, self.data)
        except ValueError as error:
            file, time = f"{self.path}: " if self.path else "", f"{self.tick / TICKS_PER_SECOND:.2f} s"
            place = f"{self.topic}, {counter_of(self.topic)} message {self.sequence}, {time}"
            raise TraceError(f"{file}{place}: {misfit(error)}; {UNREADABLE}") from error


class Trace:
    """A complete trace on disk. No file stays open between calls; every iteration starts at the beginning.

    Attributes:
        path: The file.
        metadata: The run and its environment, by name.
        attachments: The scenario and the rule files of the run, by name.
    """

    def __init__(self, path: Path) -> None:
        """Open and check a trace.

        Raises:
            TraceError: If the file is missing, not a trace, truncated, damaged, or of a newer version.
        """
        self.path = path
        with opened(path) as file:
            protected = _check_whole(path, file)
            with _readable(path):
                reader = make_reader(file)
                self._summary = _summary_of(reader)
                self.metadata = _by_name(path, ((record.name, record.metadata) for record in reader.iter_metadata()))
                self.attachments = _by_name(path, ((record.name, record.data) for record in reader.iter_attachments()))
        written = self.metadata.get("run", {}).get("schema_version")
        if written is None:
            raise TraceError(f"{path}: an MCAP file, but not a trace: its metadata names no schema version")
        if not written.isdecimal() or int(written) > SCHEMA_VERSION:
            raise TraceError(f"{path}: has schema version {written}, known is {SCHEMA_VERSION}; install a newer skolem")
        if not protected and self.metadata.get(CONTENT, self.hashes.metadata) != self.hashes.metadata:
            raise TraceError(f"{path}: damaged: the messages do not match the hash of their content; {RECOVER}")

    @cached_property
    def schemas(self) -> dict[str, bytes]:
        """The schema of each topic that may have messages; a trace of an older version has fewer and older schemas."""
        found: dict[str, bytes] = {}
        for channel in self._summary.channels.values():
            schema = self._summary.schemas.get(channel.schema_id)
            if schema is None:
                raise TraceError(f"{self.path}: the topic {channel.topic} has no schema; {UNREADABLE}")
            found[channel.topic] = schema.data
        return found

    def messages(self, *topics: str) -> Iterator[Recorded]:
        """Yield the messages of `topics` (of all, if none is given) in file order.

        Raises:
            TraceError: If a topic is unknown, or if all topics are read and a message is missing.
        """
        count = dict.fromkeys(("decision", "truth", "perf"), 0)
        for channel, record in _indexed(self.path, self._summary, topics):
            recorded = _recorded(self.path, channel, record)
            counter = counter_of(recorded.topic)
            if not topics and recorded.sequence != count[counter]:
                raise TraceError(f"{self.path}: {recorded.topic}: {counter} message {count[counter]} is missing")
            count[counter] += 1
            yield recorded

    def last(self, topic: str) -> Recorded | None:
        """Return the last message of a topic, searched from the end of the file; None if there is none."""
        found = next(_indexed(self.path, self._summary, (topic,), backwards=True), None)
        return None if found is None else _recorded(self.path, *found)

    def of(self, model: type[M]) -> Iterator[M]:
        """Yield the messages of one type, decoded, in file order: `trace.of(Belief)`."""
        for recorded in self.messages(*(topic for topic, (known, _) in JSON_TOPICS.items() if known is model)):
            message = recorded.message
            assert isinstance(message, model), f"no topic carries {model.__name__}"
            yield message

    @cached_property
    def hashes(self) -> ContentHash:
        """The content and decision hashes, as the writer computed them."""
        hashes = ContentHash()
        for recorded in self.messages():
            hashes.add(recorded.topic, recorded.data, time_ns(recorded.tick), recorded.sequence)
        return hashes

    @property
    def content_hash(self) -> str:
        """Hash of everything recorded but PERF."""
        return self.hashes.content

    @property
    def decision_hash(self) -> str:
        """Hash of what the robot sensed, believed and decided."""
        return self.hashes.decision


def opened(path: Path) -> IO[bytes]:
    """Open a file that begins as an MCAP file, and return it at its beginning.

    Raises:
        TraceError: If the file cannot be read, or does not begin as an MCAP file.
    """
    try:
        file = opened_regular(path)
        is_mcap = file.read(MAGIC_SIZE) == MAGIC
        file.seek(0)
    except OSError as error:
        raise TraceError(f"{path}: cannot read the trace: {error.strerror or error}") from error
    if not is_mcap:
        file.close()
        raise TraceError(f"{path}: not a trace: it does not begin as an MCAP file")
    return file


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Raise `TraceError` for damaged bytes even if somebody has made their checksums fit."""
    try:
        yield
    except DAMAGE as error:
        raise TraceError(f"{path}: damaged: {str(error) or type(error).__name__}; {UNREADABLE}") from error


def _by_name(path: Path, found: Iterable[tuple[str, T]]) -> dict[str, T]:
    by_name: dict[str, T] = {}
    for name, content in found:
        if name in by_name:
            raise TraceError(f"{path}: {name} is there twice; {UNREADABLE}")
        by_name[name] = content
    return by_name


def _summary_of(reader: McapReader) -> Summary:
    summary = reader.get_summary()
    assert summary is not None, "the checksum of the summary was compared"
    return summary


def _check_whole(path: Path, file: IO[bytes]) -> bool:
    """Compare both checksums of the container (data section, summary) with the file, and rewind it.

    Return whether there are both: other writers may leave them out, and put 0 there.
    """
    size = file.seek(0, io.SEEK_END)
    tail = MAGIC_SIZE + FOOTER_SIZE
    file.seek(max(0, size - tail))
    footer = file.read(tail)
    if size < MAGIC_SIZE + tail + DATA_END_SIZE or footer[-MAGIC_SIZE:] != MAGIC:
        raise TraceError(f"{path}: truncated: the run was killed, or is still being recorded; {RECOVER}")
    summary, _, summary_crc = struct.unpack("<QQI", footer[-MAGIC_SIZE - 20 : -MAGIC_SIZE])
    data_end = summary - DATA_END_SIZE
    if not MAGIC_SIZE < data_end < size or (summary_crc and _crc(file, summary, size - MAGIC_SIZE - 4) != summary_crc):
        raise TraceError(f"{path}: damaged: the index at the end does not match its checksum; {RECOVER}")
    file.seek(data_end)
    opcode_and_length, data_crc = file.read(9), struct.unpack("<I", file.read(4))[0]
    is_end = opcode_and_length == b"\x0f" + (4).to_bytes(8, "little")
    if not is_end or (data_crc and _crc(file, 0, data_end) != data_crc):
        raise TraceError(f"{path}: damaged: the messages do not match their checksum; {RECOVER}")
    file.seek(0)
    return bool(summary_crc and data_crc)


def _crc(file: IO[bytes], start: int, end: int) -> int:
    """Return the checksum of the bytes from `start` up to `end`, read in blocks."""
    file.seek(start)
    crc = 0
    while start < end and (block := file.read(min(BLOCK_BYTES, end - start))):
        crc = zlib.crc32(block, crc)
        start += len(block)
    return crc


def _indexed(
    path: Path, summary: Summary, topics: tuple[str, ...], backwards: bool = False
) -> Iterator[tuple[Channel, McapMessage]]:
    """Yield the messages of `topics` (of all, if none is given) in file order, one chunk in memory at a time.

    The container library's own iteration in file order loads every chunk before the first message.
    """
    wanted = {number for number, channel in summary.channels.items() if not topics or channel.topic in topics}
    with path.open("rb") as file:
        for index in sorted(summary.chunk_indexes, key=lambda index: index.chunk_start_offset, reverse=backwards):
            if wanted.isdisjoint(index.message_index_offsets):
                continue
            with _readable(path):
                file.seek(index.chunk_start_offset + 1 + 8)
                every = records_in(Chunk.read(ReadDataStream(file)))
                found = (r for r in every if isinstance(r, McapMessage) and r.channel_id in wanted)
                for record in reversed(list(found)) if backwards else found:
                    yield summary.channels[record.channel_id], record


def _recorded(path: Path, channel: Channel, record: McapMessage) -> Recorded:
    if channel.topic not in CLASS_OF:
        raise TraceError(f"{path}: unknown topic {channel.topic}; known are: {', '.join(CLASS_OF)}")
    return Recorded(channel.topic, tick_at(record.log_time), record.sequence, record.data, path)
