"""The records inside a chunk, read with a check of its checksum and of its size."""

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import Final

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message as McapMessage, Schema
from zstandard import ZstdDecompressor, ZstdError

MOST_BYTES: Final = 1 << 27  # a chunk is 64 KiB and the rest of its last message; in a golden trace it is 64 MiB
DAMAGE: Final = (  # errors of the container library for damaged bytes
    McapError,
    ZstdError,
    ValueError,
    KeyError,
    struct.error,
    MemoryError,
    OverflowError,
    OSError,
    RuntimeError,  # of lz4
)
_HEAD: Final = struct.Struct("<BQ")  # kind and length of a record
_MESSAGE: Final = struct.Struct("<HIQQ")  # channel, sequence, times; the data follow
_OTHERS: Final[dict[int, type[Schema] | type[Channel]]] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel}


class TooLargeError(ValueError):
    """A chunk is larger than any that the product writes."""


def records_in(chunk: Chunk) -> Iterator[Schema | Channel | McapMessage]:
    """Yield the records inside a chunk; it is unpacked, and its checksum compared, before the first.

    Raises:
        TooLargeError: If the chunk is larger than `MOST_BYTES`; it is not unpacked then.
        McapError, ZstdError, ..: One of `DAMAGE`, if the chunk does not match its checksum or holds something else.
    """
    data = _unpacked(chunk)
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise ValueError("a chunk does not match its checksum")
    return _records(memoryview(data))


def _unpacked(chunk: Chunk) -> bytes:
    """Return the bytes of a chunk, never more than it says that there are."""
    size = chunk.uncompressed_size
    if size > MOST_BYTES:
        raise TooLargeError(f"a chunk of {size} bytes; at most {MOST_BYTES} are unpacked")
    match chunk.compression:
        case "zstd":
            data: bytes = ZstdDecompressor().stream_reader(chunk.data).read(size + 1)
        case "lz4":
            from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]  # comes with mcap

            data = LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        case "":
            data = chunk.data
        case other:
            raise ValueError(f"a chunk is compressed by {other!r}; known are zstd and lz4")
    if len(data) != size:
        raise ValueError("a chunk has another size than it says")
    return data


def _records(data: memoryview) -> Iterator[Schema | Channel | McapMessage]:
    byte = 0
    while byte < len(data):
        kind, length = _HEAD.unpack_from(data, byte)
        byte += _HEAD.size
        if byte + length > len(data):
            raise ValueError("a record reaches beyond its chunk")
        content = data[byte : byte + length]
        byte += length
        if kind == Opcode.MESSAGE:
            channel, sequence, log_time, publish_time = _MESSAGE.unpack_from(content)
            yield McapMessage(channel, log_time, bytes(content[_MESSAGE.size :]), publish_time, sequence)
        elif kind in _OTHERS:
            yield _OTHERS[kind].read(ReadDataStream(BytesIO(bytes(content))))
        else:
            raise ValueError(f"a record of kind {kind:#04x} stands inside of a chunk")
