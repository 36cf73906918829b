"""The index at the end of a trace says what there is: who reads by it sees what `check` has seen."""

import struct
import zlib
from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import AttachmentIndex, Channel, ChunkIndex, DataEnd, Footer, MetadataIndex, Schema, SummaryOffset
from mcap.writer import CompressionType, Writer

from skolem.traces.errors import TraceError
from skolem.traces.file.check import check
from skolem.traces.file.chunks import MOST_BYTES
from skolem.traces.file.container import pieces
from skolem.traces.file.reader import MAGIC, Trace


@pytest.fixture
def trace(tmp_path: Path, record_run: Callable[..., str]) -> Path:
    path = tmp_path / "sample.mcap"
    record_run(path)
    return path


def reindexed(path: Path, change: Callable[[Any], Any | None]) -> Path:
    """Return a trace whose index is changed record by record, None to leave one out, with checksums that fit."""
    content = path.read_bytes()
    with BytesIO(content) as file:
        every = list(pieces(file))
    at = next(i for i, piece in enumerate(every) if isinstance(piece.record, DataEnd))
    data = content[: every[at].byte + len(every[at].data)]
    summary = b""
    for piece in every[at + 1 :]:
        if isinstance(piece.record, SummaryOffset | Footer):
            continue
        record = change(piece.record)
        if record is piece.record:
            summary += piece.data
        elif record is not None:
            builder = RecordBuilder()
            record.write(builder)
            summary += builder.end()
    footer = struct.pack("<BQQQ", 0x02, 20, len(data), 0)
    crc = zlib.crc32(summary + footer)
    other = path.with_name("reindexed.mcap")
    other.write_bytes(data + summary + footer + struct.pack("<I", crc) + MAGIC)
    return other


def without(kind: type[object], matches: Callable[[Any], bool] = lambda _: True) -> Callable[[Any], Any | None]:
    return lambda record: None if isinstance(record, kind) and matches(record) else record


def emptied(record: Any) -> Any:
    if not isinstance(record, ChunkIndex):
        return record
    return replace(record, message_index_offsets=dict(list(record.message_index_offsets.items())[1:]))


def test_an_index_that_was_written_anew_as_it_was_is_sound(trace: Path) -> None:
    assert check(reindexed(trace, lambda record: record)).sound


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (without(Channel, lambda channel: channel.topic == "/run/end"), "channels"),
        (without(Schema, lambda schema: schema.id == 1), "schemas"),
        (without(AttachmentIndex, lambda index: index.name == "scenario.yaml"), "attachments"),
        (without(MetadataIndex, lambda index: index.name == "env"), "metadata"),
        (without(ChunkIndex), "chunks"),
        (emptied, "chunks"),
    ],
)
def test_an_index_that_leaves_something_out_is_noticed(
    trace: Path, change: Callable[[Any], Any | None], what: str
) -> None:
    flaw = check(reindexed(trace, change)).flaw
    assert flaw is not None
    assert flaw.message == f"the index does not list the {what} that there are"


def bomb(path: Path) -> Path:
    """Write a container of a few bytes that would unpack to more than any trace has in a chunk."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE, enable_data_crcs=True)
        writer.start(profile="", library="")
        writer.add_metadata("run", {"schema_version": "1"})
        schema = writer.register_schema("s", "jsonschema", b"{}")
        writer.add_message(writer.register_channel("/x", "json", schema), 0, b"{}", 0)
        writer.finish()
    with path.open("rb") as file:
        every = list(pieces(file))
    chunk = next(piece for piece in every if type(piece.record).__name__ == "Chunk")
    size = MOST_BYTES + 1
    packed = zstandard.compress(bytes(size))
    body = (
        struct.pack("<QQQI", 0, 0, size, 0) + struct.pack("<I", 4) + b"zstd" + struct.pack("<Q", len(packed)) + packed
    )
    head = path.read_bytes()[: chunk.byte]
    path.write_bytes(head + struct.pack("<BQ", 0x06, len(body)) + body)
    return path


def test_what_would_unpack_to_more_than_a_trace_ever_has_is_refused_unread(tmp_path: Path) -> None:
    path = bomb(tmp_path / "bomb.mcap")
    assert path.stat().st_size < 100_000
    flaw = check(path).flaw
    assert flaw is not None
    assert flaw.message == f"a chunk of {MOST_BYTES + 1} bytes; at most {MOST_BYTES} are unpacked"


def test_a_chunk_that_does_not_begin_where_the_index_says_is_a_damaged_trace(trace: Path) -> None:
    def moved(record: Any) -> Any:
        if not isinstance(record, ChunkIndex):
            return record
        return replace(record, chunk_start_offset=record.chunk_start_offset + 3)

    path = reindexed(trace, moved)
    with pytest.raises(TraceError, match="damaged: "):
        list(Trace(path).messages())
