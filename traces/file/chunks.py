"""The records inside a chunk, read with a check of its checksum and of its size."""

import struct
from typing import Final

from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, Message as McapMessage, Schema
from mcap.stream_reader import breakup_chunk
from zstandard import ZstdError, frame_content_size

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
)


class TooLargeError(ValueError):
    """A chunk is larger than any that the product writes."""


def records_in(chunk: Chunk) -> list[Schema | Channel | McapMessage]:
    """Return the records inside a chunk.

    Raises:
        TooLargeError: If the chunk is larger than `MOST_BYTES`; it is not unpacked then.
        McapError, ZstdError, ..: One of `DAMAGE`, if the chunk does not match its checksum.
    """
    size = chunk.uncompressed_size
    if chunk.compression == "zstd":
        size = max(size, frame_content_size(chunk.data))
    if size > MOST_BYTES:
        raise TooLargeError(f"a chunk of {size} bytes; at most {MOST_BYTES} are unpacked")
    return breakup_chunk(chunk, validate_crc=True)  # type: ignore[return-value]
