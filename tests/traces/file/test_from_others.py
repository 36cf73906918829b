"""Traces as other writers make them are read; traces that are made to do harm are refused at little cost."""

import random
import resource
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from kit.recordings import recorded
from kit.tampering import records_of
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.writer import CompressionType, Writer

from skolem.tools.recorded.replaying import Options, replay
from skolem.tools.recorded.run import RecordedRun
from skolem.traces.compare.diff import tolerance_for
from skolem.traces.errors import TraceError
from skolem.traces.file.check import check
from skolem.traces.file.codec import CONTENT
from skolem.traces.file.reader import Trace

Edit = Callable[[list[object]], list[object]]
FILES = (Metadata, Attachment)


def written(target: Path, edit: Edit = lambda found: found, **options: object) -> Path:
    """Write a run again by the official writer, with its options."""
    with target.open("wb") as file:
        writer = Writer(file, **options)  # type: ignore[arg-type]
        numbers: dict[tuple[type, int], int] = {}
        writer.start()
        for record in edit(records_of(recorded("sim1_green"))):
            match record:
                case Metadata():
                    writer.add_metadata(record.name, record.metadata)
                case Attachment(create_time, log_time, name, media_type, data):
                    writer.add_attachment(create_time, log_time, name, media_type, data)
                case Schema():
                    numbers[Schema, record.id] = writer.register_schema(record.name, record.encoding, record.data)
                case Channel():
                    schema = numbers.get((Schema, record.schema_id), 0)
                    numbers[Channel, record.id] = writer.register_channel(
                        record.topic, record.message_encoding, schema, record.metadata
                    )
                case Message(channel_id, log_time, data, publish_time, sequence):
                    writer.add_message(numbers[Channel, channel_id], log_time, data, publish_time, sequence)
                case _:
                    pass  # header and indexes: the writer makes its own
        writer.finish()
    return target


def files_last(found: list[object]) -> list[object]:
    return [*(r for r in found if not isinstance(r, FILES)), *(r for r in found if isinstance(r, FILES))]


def files_first(found: list[object]) -> list[object]:
    return [*(r for r in found if isinstance(r, FILES)), *(r for r in found if not isinstance(r, FILES))]


@pytest.mark.parametrize("crcs", [True, False], ids=["with checksums", "without"])
@pytest.mark.parametrize("compression", list(CompressionType), ids=lambda each: str(each.name).lower())
@pytest.mark.parametrize("chunk_size", [1, 10_000, 10_000_000])
@pytest.mark.parametrize("order", [files_first, files_last])
def test_a_sound_trace_of_another_writer_is_read(
    tmp_path: Path, crcs: bool, compression: CompressionType, chunk_size: int, order: Edit
) -> None:
    path = written(
        tmp_path / "a.mcap",
        order,
        enable_crcs=crcs,
        enable_data_crcs=crcs,
        compression=compression,
        chunk_size=chunk_size,
    )
    original, found = check(recorded("sim1_green")), check(path)
    assert (found.flaw, found.content_hash, found.remarks) == (None, original.content_hash, original.remarks)
    assert Trace(path).content_hash == original.content_hash


def test_without_checksums_the_hash_of_the_content_is_compared(tmp_path: Path) -> None:
    def changed(found: list[object]) -> list[object]:
        return [replace(r, data=r.data + b" ") if isinstance(r, Message) and r.sequence == 3 else r for r in found]

    path = written(tmp_path / "a.mcap", changed, enable_crcs=False, enable_data_crcs=False)
    assert check(path).flaw is not None
    with pytest.raises(TraceError, match="do not match the hash of their content"):
        Trace(path)


def test_what_is_not_protected_is_said_to_be_so(tmp_path: Path) -> None:
    def hashless(found: list[object]) -> list[object]:
        return [r for r in found if not (isinstance(r, Metadata) and r.name == CONTENT)]

    found = check(written(tmp_path / "a.mcap", hashless, enable_crcs=False, enable_data_crcs=False))
    assert found.sound
    assert any("not protected" in remark for remark in found.remarks)


def test_a_trace_without_schemas_is_refused_by_name(tmp_path: Path) -> None:
    path = written(tmp_path / "a.mcap", lambda found: [r for r in found if not isinstance(r, Schema)])
    assert check(path).flaw is not None
    with pytest.raises(TraceError, match="has no schema"):
        replay(RecordedRun(path), Options(tolerance_for("equal machine")))


@pytest.mark.parametrize("deep", [b"[" * 500, b'{"a":' * 5_000, b"[" * 100_000])
def test_deep_json_is_refused(tmp_path: Path, deep: bytes) -> None:
    def deeper(found: list[object]) -> list[object]:
        number = next(r.id for r in found if isinstance(r, Channel) and r.topic == "/plan")
        return [replace(r, data=deep) if isinstance(r, Message) and r.channel_id == number else r for r in found]

    path = written(tmp_path / "a.mcap", deeper, enable_crcs=False, enable_data_crcs=False)
    assert check(path).flaw is not None
    with pytest.raises(TraceError):
        replay(RecordedRun(path), Options(tolerance_for("equal machine")))


@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4])
@pytest.mark.parametrize("filling", [b"\0", b" "])
def test_a_chunk_that_inflates_costs_little(tmp_path: Path, compression: CompressionType, filling: bytes) -> None:
    def inflated(found: list[object]) -> list[object]:
        last = max(i for i, r in enumerate(found) if isinstance(r, Message))
        message = found[last]
        assert isinstance(message, Message)
        return [*found[:last], replace(message, data=filling * 100_000_000), *found[last + 1 :]]

    path = written(tmp_path / "a.mcap", inflated, compression=compression, enable_crcs=False, enable_data_crcs=False)
    code = "import sys; from skolem.traces.file.check import check; from pathlib import Path; "
    code += "print(check(Path(sys.argv[1])).sound)"
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    found = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True)
    assert found.stdout == "False\n"
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before < 5


@pytest.mark.parametrize("seed", range(30))
def test_bytes_that_are_changed_anywhere_are_a_flaw_or_change_nothing(tmp_path: Path, seed: int) -> None:
    draw = random.Random(seed)
    data = bytearray(written(tmp_path / "a.mcap", enable_crcs=False, enable_data_crcs=False).read_bytes())
    for _ in range(draw.choice([1, 8])):
        data[draw.randrange(8, len(data))] = draw.choice([0, 0xFF, draw.randrange(256)])
    path = tmp_path / "b.mcap"
    path.write_bytes(data)
    found = check(path)
    try:
        assert Trace(path).content_hash == check(recorded("sim1_green")).content_hash or not found.sound
    except TraceError:
        pass
