"""Traces are read by other people's programs: every topic and every schema, by the npm package @mcap/core and rerun.

`npm ci --prefix tests/readers` installs the packages; without them, or without node, the tests that need them are
skipped.
"""

import base64
import json
import os
import shutil
import subprocess
from collections import Counter, defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rerun_cli
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message as Protobuf
from kit.needs import missing
from kit.places import GOLDEN, TESTS
from kit.views import filmed
from rerun.chunk import RrdReader

from skolem.traces.file.codec import schema_bytes, schema_name
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, PROTOBUF_TOPICS

READERS = TESTS / "readers"


@pytest.fixture(scope="module")
def read_by_node() -> Callable[[Path], dict[str, Any]]:
    node = shutil.which("node") or missing("node")
    for package in ("@mcap/core", "protobufjs"):
        if not (READERS / "node_modules" / package).is_dir():
            missing(f"the npm package {package}: npm ci --prefix tests/readers")

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


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the trace of two steps with physics: joints, transforms, and what the camera saw."""
    path = tmp_path_factory.mktemp("film") / "film.mcap"
    filmed(path, "sim1_green", 2)
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


@pytest.mark.physics
def test_every_message_means_to_others_what_it_means_to_us(
    film: Path, read_by_node: Callable[[Path], dict[str, Any]]
) -> None:
    """Joints, transforms and pictures too, decoded by nothing but the descriptors that the trace holds of them."""
    found = read_by_node(film)
    recorded = list(Trace(film).messages())
    written = {message.topic for message in recorded}
    assert {topic for topic in PROTOBUF_TOPICS if topic != "/log"} <= written  # nobody writes a log
    for topic in sorted(written):
        ours = [plain(message) for message in recorded if message.topic == topic]
        for reader in ("index", "stream"):
            assert found[reader]["topics"][topic]["contents"] == ours, topic


def plain(recorded: Recorded) -> Any:
    """Return a message in dictionaries, lists and values; of protobuf what differs from the default."""
    message = recorded.message
    return fields(message) if isinstance(message, Protobuf) else json.loads(recorded.data)


def fields(message: Protobuf) -> dict[str, Any]:
    """Return the fields of a protobuf message; bytes in base64."""

    def value(each: Any) -> Any:
        if isinstance(each, Protobuf):
            return fields(each)
        return base64.b64encode(each).decode() if isinstance(each, bytes) else each

    return {f.name: [*map(value, each)] if f.is_repeated else value(each) for f, each in message.ListFields()}


def test_mcap_core_reads_a_golden_trace(read_by_node: Callable[[Path], dict[str, Any]]) -> None:
    path = next(GOLDEN.glob("*.mcap"))
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


@pytest.mark.physics
def test_rerun_converts_a_trace(film: Path, tmp_path: Path) -> None:
    """Its own importer draws transforms and images of it; joints and the JSON topics are kept as they are."""
    program, out = Path(rerun_cli.__file__).parent / "rerun", tmp_path / "out.rrd"
    home = tmp_path / "home"
    (home / "rerun").mkdir(parents=True)
    (home / "rerun" / "analytics.json").write_text('{"analytics_enabled":false}')
    env = os.environ | {"CI": "1", "XDG_CONFIG_HOME": str(home), "XDG_DATA_HOME": str(home), "RUST_LOG": "error"}
    command = [str(program), "mcap", "convert", str(film), "-o", str(out), "--timeline-type", "duration"]
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    counted = Counter(recorded.topic for recorded in Trace(film).messages())
    found = components(out)
    assert {path for path in found if not path.startswith("/__mcap")} == counted.keys()
    shown_as = {
        "/tf": ("Transform3D:translation", sum(len(t["transforms"]) for t in transforms(film))),
        "/camera/rgb": ("EncodedImage:blob", counted["/camera/rgb"]),
        "/camera/depth": ("Image:buffer", counted["/camera/depth"]),
        "/camera/info": ("Pinhole:image_from_camera", counted["/camera/info"]),
        "/robot/joint_states": ("foxglove.JointStates:message", counted["/robot/joint_states"]),
    }
    for topic, count in counted.items():
        component, rows = shown_as.get(topic, ("McapMessage:data", count))
        assert found[topic][component] == rows, topic


def transforms(path: Path) -> list[dict[str, Any]]:
    """Return the messages of /tf."""
    return [plain(recorded) for recorded in Trace(path).messages("/tf")]


def components(recording: Path) -> dict[str, Counter[str]]:
    """Return how many rows a rerun recording holds by entity, in full, and component."""
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for chunk in RrdReader(recording).stream().to_chunks():
        for name in chunk.to_record_batch().schema.names:
            found[chunk.entity_path][name] += chunk.num_rows
    return found
