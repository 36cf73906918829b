"""Traces are read by other people's programs: every topic and every schema, by the npm package @mcap/core and rerun.

`npm ci --prefix tests/readers` installs the package; without it, or without node, the tests that need it are skipped.
"""

import base64
import json
import os
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rerun_cli
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from needs import missing

from skolem.traces.codec import schema_bytes, schema_name
from skolem.traces.messages import CLASS_OF, JSON_TOPICS
from skolem.traces.reader import Trace

READERS = Path(__file__).parent / "readers"


@pytest.fixture(scope="module")
def read_by_node() -> Callable[[Path], dict[str, Any]]:
    node = shutil.which("node") or missing("node")
    if not (READERS / "node_modules" / "@mcap" / "core").is_dir():
        missing("the npm package @mcap/core: npm ci --prefix tests/readers")

    def read(path: Path) -> dict[str, Any]:
        command = [node, str(READERS / "read.mjs"), str(path)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
        assert done.returncode == 0, done.stderr
        found: dict[str, Any] = json.loads(done.stdout)
        return found

    return read


@pytest.fixture
def sample(tmp_path: Path, record_run: Callable[..., str]) -> Path:
    path = tmp_path / "sample.mcap"
    record_run(path, profile=True)
    return path


def test_mcap_core_reads_every_topic_and_schema_by_the_index_and_as_a_stream(
    sample: Path, green_trace: Path, read_by_node: Callable[[Path], dict[str, Any]]
) -> None:
    for path in (sample, green_trace):
        found = read_by_node(path)
        assert found["index"]["topics"] == found["stream"]["topics"]
        assert found["stream"]["done"] is True
        topics = found["index"]["topics"]
        assert topics.keys() == CLASS_OF.keys()
        counted = Counter(recorded.topic for recorded in Trace(path).messages())
        assert {topic: row["messages"] for topic, row in topics.items()} == {t: counted[t] for t in topics}
        assert {topic: row["schema"] for topic, row in topics.items()} == {t: schema_name(t) for t in topics}
        assert {t: base64.b64decode(row["schemaBase64"]) for t, row in topics.items()} == {
            t: schema_bytes(t) for t in topics
        }
        assert found["index"]["attachments"] == {name: len(data) for name, data in Trace(path).attachments.items()}


def test_mcap_core_reads_a_golden_trace(read_by_node: Callable[[Path], dict[str, Any]]) -> None:
    path = next((Path(__file__).parent / "golden").glob("*.mcap"))
    found = read_by_node(path)
    assert found["index"]["topics"] == found["stream"]["topics"]
    assert sum(row["messages"] for row in found["index"]["topics"].values()) == len(list(Trace(path).messages()))


def test_every_schema_is_what_its_encoding_says() -> None:
    """JSON Schema with an object at the top, as Foxglove wants it; a protobuf descriptor set that has the message."""
    for topic in CLASS_OF:
        data = schema_bytes(topic)
        if topic in JSON_TOPICS:
            assert json.loads(data)["type"] == "object", topic
        else:
            files = FileDescriptorSet.FromString(data).file
            names = {f"{file.package}.{message.name}" for file in files for message in file.message_type}
            assert schema_name(topic) in names


def test_rerun_converts_a_trace(sample: Path, tmp_path: Path) -> None:
    """Its own importer draws transforms and images of it; the JSON topics are kept as they are."""
    program, out = Path(rerun_cli.__file__).parent / "rerun", tmp_path / "out.rrd"
    home = tmp_path / "home"
    (home / "rerun").mkdir(parents=True)
    (home / "rerun" / "analytics.json").write_text('{"analytics_enabled":false}')
    env = os.environ | {"CI": "1", "XDG_CONFIG_HOME": str(home), "XDG_DATA_HOME": str(home), "RUST_LOG": "error"}
    command = [str(program), "mcap", "convert", str(sample), "-o", str(out), "--timeline-type", "duration"]
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    printed = [str(program), "rrd", "print", str(out)]
    said = subprocess.run(printed, capture_output=True, text=True, env=env, check=True, timeout=60).stdout
    written = {recorded.topic for recorded in Trace(sample).messages()}
    assert {topic for topic in written if topic in said} == written
