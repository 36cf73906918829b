"""The records inside a chunk: its checksum compared, and no more unpacked than a trace ever has in one."""

import struct
from typing import Final

from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, Message as McapMessage, Schema
from mcap.stream_reader import breakup_chunk
from zstandard import ZstdError, frame_content_size

MOST_BYTES: Final = 1 << 27  # a chunk is 64 KiB and what its last message is above that; of a golden trace, 64 MiB
DAMAGE: Final = (  # what the container library raises at bytes that are not as any container is written
    McapError,
    ZstdError,
    ValueError,
    KeyError,
    struct.error,
    MemoryError,
    OverflowError,
    OSError,
)


class TooLargeError(ValueError):
    """A chunk would be larger than any that a trace has."""


def records_in(chunk: Chunk) -> list[Schema | Channel | McapMessage]:
    """Return the records inside a chunk.

    Raises:
        TooLargeError: If it is larger than `MOST_BYTES`, before it is unpacked.
        McapError, ZstdError, ..: `DAMAGE`, if it does not match its checksum.
    """
    size = chunk.uncompressed_size
    if chunk.compression == "zstd":
        size = max(size, frame_content_size(chunk.data))
    if size > MOST_BYTES:
        raise TooLargeError(f"a chunk of {size} bytes; at most {MOST_BYTES} are unpacked")
    return breakup_chunk(chunk, validate_crc=True)  # type: ignore[return-value]
