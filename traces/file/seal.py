"""The checksums of a whole trace, and the index at its end.

Readers of a trace rely on the index. So it has to list every record at its offset, no more and no less.
"""

import zlib
from dataclasses import dataclass, field

from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Message as McapMessage,
    Metadata,
    MetadataIndex,
    Schema,
)

from skolem.traces.file.container import CRC_SIZE, DamageError, Piece
from skolem.traces.file.reader import MAGIC


@dataclass(slots=True)
class _Listed:
    """The parts of a trace: once as they stand in the file, once as the index lists them."""

    chunks: dict[int, frozenset[int]] = field(default_factory=dict)  # channels that have messages, by offset
    attachments: dict[int, str] = field(default_factory=dict)  # name, by offset
    metadata: dict[int, str] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)


class Seal:
    """Checks the checksums of the whole file and the index at its end."""

    def __init__(self) -> None:
        """Begin with the first bytes of the file."""
        self._crc = zlib.crc32(MAGIC)
        self._there, self._index = _Listed(), _Listed()
        self._in_index = False
        self.missing = False  # whether a checksum is left out, as other writers may

    def take(self, piece: Piece) -> None:
        """Take in the next record of the file.

        Raises:
            DamageError: If a checksum or the index is wrong.
        """
        match piece.record:
            case DataEnd(data_section_crc=crc):
                self.missing |= not crc
                if crc and crc != self._crc:
                    raise DamageError(piece.byte, "the records before do not match their checksum: bytes were changed")
                self._crc, self._in_index = 0, True
                return
            case Footer(summary_crc=crc):
                self.missing |= not crc
                if crc and crc != zlib.crc32(piece.data[:-CRC_SIZE], self._crc):
                    raise DamageError(piece.byte, "the index does not match its checksum: its bytes were changed")
                self._compare(piece.byte)
            case Attachment(name=name):
                self._there.attachments[piece.byte] = name
            case Metadata(name=name):
                self._there.metadata[piece.byte] = name
            case Chunk():
                self._there.chunks[piece.byte] = frozenset()
            case ChunkIndex(chunk_start_offset=start, message_index_offsets=channels):
                self._index.chunks[start] = frozenset(channels)
            case AttachmentIndex(offset=start, name=name):
                self._index.attachments[start] = name
            case MetadataIndex(offset=start, name=name):
                self._index.metadata[start] = name
            case Schema() | Channel():
                self.take_inner(piece.byte, piece.record)
            case _:
                pass
        self._crc = zlib.crc32(piece.data, self._crc)

    def take_inner(self, byte: int, record: Schema | Channel | McapMessage) -> None:
        """Take in a record of the chunk at an offset."""
        listed = self._index if self._in_index else self._there
        match record:
            case Schema(id=number):
                listed.schemas[number] = record
            case Channel(id=number):
                listed.channels[number] = record
            case McapMessage(channel_id=number):
                self._there.chunks[byte] |= {number}

    def _compare(self, byte: int) -> None:
        there, index = self._there, self._index
        listed = {
            "chunks": there.chunks == index.chunks,
            "attachments": there.attachments == index.attachments,
            "metadata": there.metadata == index.metadata,
            "schemas": there.schemas.items() <= index.schemas.items(),  # the index alone lists those without messages
            "channels": there.channels.items() <= index.channels.items(),
        }
        for what, agree in listed.items():
            if not agree:
                raise DamageError(byte, f"the index does not list the {what} that there are")
