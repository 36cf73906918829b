"""The container of a trace, record by record, each with its offset in the file: for checking and recovery.

Nothing is trusted here: lengths are compared with the size of the file, and data with their checksums.
"""

import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Footer, Header, Message as McapMessage, Metadata, Schema
from mcap.stream_reader import MAGIC_SIZE, StreamReader
from mcap.writer import CompressionType, Writer

from skolem.traces.errors import Fault, InputError, TraceError
from skolem.traces.file.chunks import DAMAGE, TooLargeError, records_in
from skolem.traces.file.writer import LIBRARY
from skolem.traces.written import created, give_name, refuse_special, unwritable

HEAD_SIZE = 1 + 8  # bytes at the start of every record: its kind and its length
CRC_SIZE = 4
KINDS = {int(opcode): opcode.name.lower().replace("_", " ") for opcode in Opcode}


class DamageError(TraceError):
    """A record of the file is damaged.

    Attributes:
        byte: Offset of the damaged record.
        message: What is wrong with it.
        end: Offset of its end; None if its length cannot be trusted.
    """

    def __init__(self, byte: int, message: str, end: int | None = None) -> None:
        super().__init__(message)
        self.byte, self.message, self.end = byte, message, end


@dataclass(frozen=True, slots=True)
class Piece:
    """One record of the container.

    Attributes:
        byte: Its offset in the file.
        data: Its bytes.
        record: The decoded record; chunks are left whole.
    """

    byte: int
    data: bytes
    record: Any


def pieces(file: IO[bytes], byte: int = MAGIC_SIZE) -> Iterator[Piece]:
    """Yield the records from `byte` on, to the footer.

    Raises:
        DamageError: At the first record that is incomplete or cannot be read.
    """
    size = file.seek(0, 2)
    file.seek(byte)
    while True:
        head = file.read(HEAD_SIZE)
        if len(head) < HEAD_SIZE:
            raise DamageError(byte, "the file ends here, before the footer")
        kind, length = struct.unpack("<BQ", head)
        if kind not in KINDS:
            raise DamageError(byte, f"there is no record of kind {kind:#04x}")
        if byte + HEAD_SIZE + length > size:
            raise DamageError(byte, f"the file ends in the middle of a {KINDS[kind]} of {length} bytes")
        piece = Piece(byte, data := head + file.read(length), _parsed(byte, kind, data))
        yield piece
        if isinstance(piece.record, Footer):
            return
        byte += len(data)


def contents(piece: Piece) -> Iterator[Schema | Channel | McapMessage]:
    """Yield the records inside a chunk.

    Raises:
        DamageError: If the chunk does not match its checksum, or is too large.
    """
    try:
        yield from records_in(piece.record)
    except TooLargeError as error:
        raise DamageError(piece.byte, str(error), piece.byte + len(piece.data)) from error
    except DAMAGE as error:
        raise DamageError(piece.byte, "the chunk does not match its checksum: its bytes were changed") from error


def _parsed(byte: int, kind: int, data: bytes) -> Any:
    try:
        record = next(StreamReader(BytesIO(data), skip_magic=True, emit_chunks=True).records)
    except (*DAMAGE, StopIteration) as error:
        said = f"the {KINDS[kind]} cannot be read: its bytes were changed"
        raise DamageError(byte, said, byte + len(data)) from error
    if isinstance(record, Attachment):
        (crc,) = struct.unpack("<I", data[-CRC_SIZE:])
        if crc and zlib.crc32(data[HEAD_SIZE:-CRC_SIZE]) != crc:
            said = f"the attachment {record.name} does not match its checksum: its bytes were changed"
            raise DamageError(byte, said, byte + len(data))
    return record


class Copy:
    """A container that is written from records of other containers; used as a context manager.

    The file is called `NAME.copying` until it is complete; an exception removes it.

    Raises:
        InputError: From every method that writes, if the file cannot be written.
    """

    def __init__(self, path: Path, chunk_bytes: int) -> None:
        """Create the partial file.

        Raises:
            InputError: If the file cannot be created, or exists already.
        """
        refuse_special(path)
        self.path = path
        self._partial = path.with_name(path.name + ".copying")
        try:
            self._file = created(self._partial)
        except FileExistsError as error:
            said = "exists: another copy is being made, or one was not finished; remove it, or give another name"
            raise InputError([Fault(str(self._partial), 0, 0, said)]) from error
        except OSError as error:
            raise unwritable(self.path, error) from error
        self._mcap = Writer(self._file, compression=CompressionType.ZSTD, chunk_size=chunk_bytes, enable_data_crcs=True)
        self._started = False
        self._schemas: dict[int, int] = {}
        self._channels: dict[int, int] = {}
        self._topics: dict[int, str] = {}

    def start(self, profile: str = "", library: str = LIBRARY) -> None:
        """Begin the file, if it has not begun; every record but a header does so by itself."""
        if not self._started:
            with self._on_disk():
                self._mcap.start(profile=profile, library=library)
            self._started = True

    def knows(self, channel: int) -> bool:
        """Return whether a channel was added, by its number in the source."""
        return channel in self._channels

    def topic(self, channel: int) -> str:
        """Return the topic of a channel that was added."""
        return self._topics[channel]

    def add(self, record: object) -> None:
        """Append a record unchanged; indexes and checksums are left out, for the new file gets its own."""
        if isinstance(record, Header):
            self.start(record.profile, record.library)
        self.start()
        with self._on_disk():
            self._add(record)

    def _add(self, record: object) -> None:
        match record:
            case Metadata():
                self._mcap.add_metadata(record.name, record.metadata)
            case Attachment(create_time, log_time, name, media_type, data):
                self._mcap.add_attachment(create_time, log_time, name, media_type, data)
            case Schema():
                self._schemas[record.id] = self._mcap.register_schema(record.name, record.encoding, record.data)
            case Channel():
                schema = self._schemas.get(record.schema_id, 0)
                self._topics[record.id] = record.topic
                self._channels[record.id] = self._mcap.register_channel(
                    record.topic, record.message_encoding, schema, record.metadata
                )
            case McapMessage(channel_id, log_time, data, publish_time, sequence):
                self._mcap.add_message(self._channels[channel_id], log_time, data, publish_time, sequence)
            case _:
                pass

    def end_chunk(self) -> None:
        """Begin a new chunk with the next message."""
        with self._on_disk():
            self._mcap.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        try:
            if error is None:
                with self._on_disk():
                    self._mcap.finish()
                    self._file.close()
                    give_name(self._partial, self.path)
        finally:
            with suppress(OSError):  # the rest may have no room on the disk
                self._file.close()
            self._partial.unlink(missing_ok=True)

    @contextmanager
    def _on_disk(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise unwritable(self.path, error) from error
