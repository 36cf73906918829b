"""Encoding of messages as bytes, schemas of topics, and hashes that show whether two runs agree.

JSON topics hold canonical JSON (sorted keys, no spaces, UTF-8); protobuf topics hold deterministic serialisations.
"""

import hashlib
import json
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from typing import Any

from google.protobuf.message import DecodeError, Message as Protobuf
from pydantic import ValidationError

from skolem.traces.errors import InternalError
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, PERF, PROTOBUF_TOPICS, TRUTH, Message

NO_CHAIN = "0" * 32
CONTENT = "content"  # name of the metadata at the end of a trace with the hash of the messages before it
STEP_DIGITS = 16  # kept digits of the hash at the end of each step: enough to find the step of a change


def encode(topic: str, message: Message | Protobuf) -> bytes:
    """Return the bytes that stand for `message` on `topic`.

    Raises:
        InternalError: If there is no such topic, or the message is not of the topic's type.
    """
    if topic in JSON_TOPICS and isinstance(message, Message) and type(message) is JSON_TOPICS[topic][0]:
        return message.canonical()
    if topic in PROTOBUF_TOPICS and isinstance(message, protobuf_class(topic)):
        return bytes(message.SerializeToString(deterministic=True))
    if topic not in CLASS_OF:
        raise InternalError(f"no topic {topic!r}; there are: {', '.join(CLASS_OF)}")
    raise InternalError(f"{topic} carries {schema_name(topic)}, got {type(message).__name__}")


def decode(topic: str, data: bytes) -> Message | Protobuf:
    """Return the message that `data` stands for on `topic`.

    Raises:
        ValueError: If the bytes are not a message of the topic's type.
    """
    if topic in JSON_TOPICS:
        return JSON_TOPICS[topic][0].model_validate_json(data)
    try:
        return protobuf_class(topic).FromString(data)
    except DecodeError as error:
        raise ValueError(str(error)) from error


def misfit(error: ValueError) -> str:
    """Return in one line why `decode` refused a message: the first wrong field, and what was expected."""
    if not isinstance(error, ValidationError):
        return f"does not follow its schema: {error}"
    first = error.errors(include_url=False)[0]
    where = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in first["loc"])
    return f"{where or 'its text'}: {first['msg']}"


def protobuf_class(topic: str) -> Any:
    """Return the generated class of a protobuf topic, imported on first use."""
    name = PROTOBUF_TOPICS[topic][0].removeprefix("foxglove.")
    return getattr(import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)


def schema_name(topic: str) -> str:
    """Return the name under which a trace registers the topic's schema."""
    return f"skolem.{JSON_TOPICS[topic][0].__name__}" if topic in JSON_TOPICS else PROTOBUF_TOPICS[topic][0]


@cache
def schema_bytes(topic: str) -> bytes:
    """Return the topic's JSON Schema, or its protobuf descriptor set; equal schemas give equal bytes."""
    if topic in JSON_TOPICS:
        schema = JSON_TOPICS[topic][0].model_json_schema()
        return json.dumps(schema, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()
    from mcap_protobuf.schema import build_file_descriptor_set  # loads most of protobuf, which a replay does not need

    return bytes(build_file_descriptor_set(protobuf_class(topic)).SerializeToString(deterministic=True))


def counter_of(topic: str) -> str:
    """Return the name of the gap-free sequence counter of a topic; INPUT and DERIVED share the counter of decisions."""
    return {TRUTH: "truth", PERF: "perf"}.get(CLASS_OF[topic], "decision")


class ContentHash:
    """Two running sha256: one over everything but PERF, one over the decisions (INPUT and DERIVED) alone.

    They do not depend on compression, chunks or metadata: a new compression library changes a file, not its hash.

    Attributes:
        steps: The first digits of the content hash at the end of each step, by which the step of a change is found.
    """

    def __init__(self) -> None:
        self._content = hashlib.sha256()
        self._decision = hashlib.sha256()
        self.steps: list[str] = []

    def add(self, topic: str, data: bytes, log_time_ns: int, sequence: int) -> None:
        """Take in the next message in file order."""
        counter = counter_of(topic)
        if counter == "perf":
            return
        parts = b"".join(_length_prefixed(topic.encode(), schema_name(topic).encode(), data))
        parts += log_time_ns.to_bytes(8, "little") + sequence.to_bytes(4, "little")
        self._content.update(parts)
        if counter == "decision":
            self._decision.update(parts)
        if topic == "/chain":
            self.steps.append(self.content[:STEP_DIGITS])

    @property
    def metadata(self) -> dict[str, str]:
        """The metadata `CONTENT` of a complete trace: its content hash, and the digits of each step."""
        return {"sha256": self.content, "steps": " ".join(self.steps)}

    @property
    def content(self) -> str:
        """Hash of everything but PERF, in hexadecimal."""
        return self._content.hexdigest()

    @property
    def decision(self) -> str:
        """Hash of what the robot sensed, believed and decided, in hexadecimal."""
        return self._decision.hexdigest()


class HashChain:
    """A chain of hashes: each link covers the link before and the decisions since.

    Equal links mean that two runs agree up to there.
    """

    def __init__(self, link: str = NO_CHAIN) -> None:
        """Start a chain after `link`; by default a new chain."""
        self.link = link
        self._next = self._start()

    def add(self, topic: str, data: bytes) -> None:
        """Take in the next message in file order; TRUTH, PERF and the chain itself are ignored."""
        if counter_of(topic) == "decision" and topic != "/chain":
            for part in _length_prefixed(topic.encode(), data):
                self._next.update(part)

    def close(self) -> str:
        """Return the link over the messages since the last link, and start the next one."""
        self.link = self._next.hexdigest()
        self._next = self._start()
        return self.link

    def _start(self) -> "hashlib.blake2b":
        return hashlib.blake2b(bytes.fromhex(self.link), digest_size=len(NO_CHAIN) // 2)


def _length_prefixed(*parts: bytes) -> Iterator[bytes]:
    for part in parts:
        yield len(part).to_bytes(8, "little") + part
