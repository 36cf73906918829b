"""Checks of a trace by itself, without simulator, estimator or reasoner.

The file is read once, from the beginning, with one chunk in memory. The first fault ends the reading: later ones may be
consequences of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import Never

from google.protobuf.message import Message as Protobuf
from mcap.records import Attachment, Channel, Chunk, Message as McapMessage, Metadata, Schema
from mcap.stream_reader import MAGIC_SIZE

from skolem.traces.errors import TraceError
from skolem.traces.file.clock import tick_at, time_ns
from skolem.traces.file.codec import (
    CONTENT,
    ContentHash,
    HashChain,
    counter_of,
    decode,
    encode,
    misfit,
    schema_bytes,
    schema_name,
)
from skolem.traces.file.container import DamageError, Piece, contents, pieces
from skolem.traces.file.known_fields import KnownFields
from skolem.traces.file.made_of import NOT_ATTACHED, digest, disagreements
from skolem.traces.file.reader import MAGIC, opened
from skolem.traces.file.seal import Seal
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, SCHEMA_VERSION, Chain, Message, RunEnd, RunStart, canonical

RECOVER = "`skolem recover {path} -o GOOD.mcap` saves every message that is whole"
OLDER = "remark: this skolem has other schemas for {topics}; it reads these messages, and the schemas are not compared"
HASHLESS = "remark: no hash of its content stands in the trace: that the truth is as it was written cannot be told"
UNPROTECTED = "remark: not protected: it has neither checksums nor a hash of its content, by which a change would show"
CHANGED = "not as the hash of the content says that it was: a message was changed, dropped or moved"
AGAIN = "take the file from where it was recorded; nothing can tell what it said there"
FOREIGN = "this skolem cannot read it; use the version that recorded it (`skolem info` names it)"
KILLED = "the run was killed; what is recorded can be read, shown and replayed as far as it goes"
ENCODINGS = {True: ("jsonschema", "json"), False: ("protobuf", "protobuf")}  # by whether the topic is JSON


@dataclass(frozen=True, slots=True)
class Flaw:
    """The first fault of a trace.

    Attributes:
        message: What is wrong.
        remedy: What to do.
        byte: Offset in the file of the record that shows it (for a message, of its chunk); None for the whole file.
        number: Index of the message, counted from 0 in file order; None if the fault is not in a message.
        topic: Topic of that message.
        step: Number of the decision that the message belongs to; None before the first.
    """

    message: str
    remedy: str
    byte: int | None = None
    number: int | None = None
    topic: str | None = None
    step: int | None = None

    def __str__(self) -> str:
        """Return position and message, and the remedy on a line of its own."""
        return f"{self.position}{self.message}\n    {self.remedy}"

    @property
    def position(self) -> str:
        """The position in words, with a colon; empty for the whole file."""
        parts = [
            *([] if self.number is None else [f"message {self.number}"]),
            *([] if self.topic is None else [self.topic]),
            *([] if self.step is None else [f"step {self.step}"]),
            *([] if self.byte is None else [f"{'byte' if self.number is None else 'chunk at byte'} {self.byte}"]),
        ]
        return f"{', '.join(parts)}: " if parts else ""


@dataclass(frozen=True, slots=True)
class Checked:
    """The result of checking one file.

    Attributes:
        path: The file.
        flaw: The first fault; None if the trace is sound.
        messages: Number of messages read, to the end or to the fault.
        steps: Number of executed actions among them.
        content_hash: Hash of what was read, without wall times.
        decision_hash: Hash of what the robot sensed, believed and decided.
        remarks: Unusual points that are no faults.
    """

    path: Path
    flaw: Flaw | None
    messages: int
    steps: int
    content_hash: str
    decision_hash: str
    remarks: tuple[str, ...] = ()

    @property
    def sound(self) -> bool:
        """Whether the trace has no fault."""
        return self.flaw is None


def check(path: Path) -> Checked:
    """Read a trace from beginning to end and return the first fault, if there is one."""
    examiner = _Examiner()
    flaw = _first_flaw(path, examiner)
    hashes = examiner.hashes
    return Checked(path, flaw, examiner.number, examiner.results, hashes.content, hashes.decision, examiner.remarks)


def _first_flaw(path: Path, examiner: "_Examiner") -> Flaw | None:
    try:
        with opened(path) as file:
            seal = Seal()
            for piece in pieces(file):
                seal.take(piece)
                for record in examiner.take(piece):
                    seal.take_inner(piece.byte, record)
            examiner.protected = not seal.missing
            if file.read(MAGIC_SIZE + 1) != MAGIC:
                raise DamageError(file.tell(), "the file does not end as an MCAP file")
        examiner.end()
    except _UnsoundError as unsound:
        return unsound.flaw
    except DamageError as damage:
        return Flaw(damage.message, RECOVER.format(path=path), byte=damage.byte)
    except TraceError as error:
        return Flaw(str(error).removeprefix(f"{path}: "), "name a file that `skolem run` has written", byte=0)
    return None


class _UnsoundError(Exception):
    def __init__(self, flaw: Flaw) -> None:
        self.flaw = flaw


_expected_schema = cache(schema_bytes)


class _Examiner:
    """Compares the parts of a trace with one another."""

    def __init__(self) -> None:
        self.hashes = ContentHash()
        self.number = self.results = 0
        self.protected = True  # whether the checksums of the container are there
        self._chain = HashChain()
        self._counters = {"decision": 0, "truth": 0, "perf": 0}
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, str] = {}
        self._older: dict[str, KnownFields | None] = {}  # topics whose schema is of another version; None for protobuf
        self._attached: dict[str, str] = {}
        self._metadata: dict[str, dict[str, str]] = {}
        self._start: RunStart | None = None
        self._ended = False
        self._log_time_ns = 0
        self._step: int | None = None
        self._byte: int | None = MAGIC_SIZE
        self._topic: str | None = None

    @property
    def remarks(self) -> tuple[str, ...]:
        """Unusual points so far that are no faults."""
        older = (OLDER.format(topics=", ".join(sorted(self._older))),) if self._older else ()
        if CONTENT in self._metadata:
            return older
        return (*older, HASHLESS if self.protected else UNPROTECTED)

    def take(self, piece: Piece) -> Iterator[Schema | Channel | McapMessage]:
        """Take in the next record of the container; yield the records inside, if it is a chunk.

        Raises:
            _UnsoundError: At the first fault.
        """
        self._byte = piece.byte
        match piece.record:
            case Metadata(name=name) | Attachment(name=name):
                self._take_file(name, piece.record)
            case Chunk():
                if "run" in self._metadata:
                    self._check_version()
                for record in contents(piece):
                    self._take_inner(record)
                    yield record
            case McapMessage():
                self._fail("a message stands outside of the chunks, where a trace has none", FOREIGN)
            case _:
                pass

    def _take_file(self, name: str, record: Metadata | Attachment) -> None:
        """Take in an input of the run, or the hash at the end: each once, before or after the messages."""
        known = self._metadata if isinstance(record, Metadata) else self._attached
        if name in known:
            self._fail(f"{name} is there twice", AGAIN)
        if isinstance(record, Metadata):
            self._metadata[name] = record.metadata
        else:
            self._attached[name] = digest(record.data)

    def _take_inner(self, record: Schema | Channel | McapMessage) -> None:
        match record:
            case Schema(id=number):
                self._schemas[number] = record
            case Channel():
                self._take_channel(record)
            case McapMessage(channel_id=number):
                if number not in self._channels:
                    self._fail(f"belongs to channel {number}, which does not exist", AGAIN)
                self._topic = self._channels[number]
                self._take_message(self._topic, record)
                self._topic = None
                self.number += 1

    def _check_version(self) -> None:
        written = self._metadata.get("run", {}).get("schema_version")
        if written is None:
            self._fail("an MCAP file, but not a trace: its metadata names no schema version", FOREIGN)
        if written != str(SCHEMA_VERSION):
            self._fail(f"has schema version {written}, known is {SCHEMA_VERSION}", FOREIGN)

    def _take_channel(self, channel: Channel) -> None:
        """Compare a topic's schema with the one of this version, which may have more fields."""
        topic, schema = channel.topic, self._schemas.get(channel.schema_id)
        if topic not in CLASS_OF:
            self._fail(f"there is no topic {topic}", FOREIGN)
        schema_encoding, encoding = ENCODINGS[topic in JSON_TOPICS]
        if schema is None or (schema.name, schema.encoding) != (schema_name(topic), schema_encoding):
            found = "none" if schema is None else f"{schema.encoding} {schema.name}"
            self._fail(f"{topic} has the schema {found}, expected {schema_encoding} {schema_name(topic)}", FOREIGN)
        if channel.message_encoding != encoding:
            self._fail(f"messages of {topic} are {channel.message_encoding}, expected {encoding}", FOREIGN)
        if schema.data != _expected_schema(topic):
            self._older[topic] = self._known_fields(topic, schema) if topic in JSON_TOPICS else None
        self._channels[channel.id] = topic

    def _known_fields(self, topic: str, schema: Schema) -> KnownFields:
        try:
            return KnownFields(schema.data)
        except ValueError:
            self._fail(f"the schema of {topic} is no JSON Schema", AGAIN)

    def _take_message(self, topic: str, record: McapMessage) -> None:
        """Compare a message with earlier messages and with its own schema."""
        message, counter = self._decoded(topic, record.data), counter_of(topic)
        if counter == "decision":
            self._step = getattr(message, "step", self._step)
        expected = self._counters[counter]
        if record.sequence != expected:
            said = f"is {counter} message {record.sequence}, expected {expected}: dropped, repeated or moved"
            self._fail(said, AGAIN)
        if record.log_time < self._log_time_ns:
            self._fail(f"its time {record.log_time} ns is before {self._log_time_ns} ns", AGAIN)
        if record.publish_time != record.log_time or time_ns(tick_at(record.log_time)) != record.log_time:
            self._fail(f"its time {record.log_time} ns is not that of a tick", AGAIN)
        if self._start is None and topic != "/run/start":
            self._fail("comes before /run/start", AGAIN)
        if counter == "decision":
            self._check_order(topic, message)
        if isinstance(message, Chain) and message.chain != self._chain.close():
            self._fail("the chain does not fit: a message since the link before was changed, dropped or moved", AGAIN)
        self._chain.add(topic, record.data)
        self.hashes.add(topic, record.data, record.log_time, record.sequence)
        self._counters[counter] += 1
        self._log_time_ns = record.log_time
        self.results += topic == "/action/result"

    def _decoded(self, topic: str, data: bytes) -> object:
        try:
            message = decode(topic, data)
        except ValueError as error:
            self._fail(misfit(error), FOREIGN if topic in self._older else AGAIN)
        written = self._encoded(topic, message)
        if written is not None and written != data:
            byte = next((i for i, (a, b) in enumerate(zip(written, data, strict=False)) if a != b), len(written))
            self._fail(f"is not written canonically, from byte {byte} of the message on", AGAIN)
        return message

    def _encoded(self, topic: str, message: Message | Protobuf) -> bytes | None:
        """Return the bytes that the recording version would write for a message; None if they are not known."""
        if topic not in self._older:
            return encode(topic, message)
        known = self._older[topic]
        if not known or not isinstance(message, Message):
            return None
        try:
            return canonical(known.of(message.model_dump(mode="json")))
        except ValueError as error:
            self._fail(f"the schema of {topic} is none that a trace can have: {error}", AGAIN)

    def _check_order(self, topic: str, message: object) -> None:
        """Check that the run begins with its start and ends with its end."""
        if self._start is not None and topic == "/run/start":
            self._fail("the run starts twice", AGAIN)
        if self._ended:
            self._fail("comes after /run/end", AGAIN)
        self._ended = topic == "/run/end"
        if isinstance(message, RunEnd) and message.steps != self.results:
            self._fail(f"says that there were {message.steps} steps, and there are {self.results}", AGAIN)
        if isinstance(message, RunStart):
            self._start = message
            for said in self._disagreements():
                if not said.endswith(NOT_ATTACHED):  # it may follow the messages
                    self._fail(said, AGAIN)

    def end(self) -> None:
        """Check that the run is complete at the end of the container.

        Raises:
            _UnsoundError: If the run has no end, or its content does not match the recorded hash.
        """
        self._byte = None
        self._check_version()
        if self._start is None:
            self._fail("the trace holds no /run/start", FOREIGN)
        for said in self._disagreements():
            self._fail(said, AGAIN)
        if not self._ended:
            raise _UnsoundError(Flaw(f"/run/end is missing after {self.results} steps", KILLED))
        self._compare_content()

    def _disagreements(self) -> Iterator[str]:
        assert self._start is not None, "the run has begun"
        return disagreements(self._start, self._attached, self._metadata.get("run", {}))

    def _compare_content(self) -> None:
        """Compare all messages but wall times, and their order, with the hash that the writer recorded."""
        written = self._metadata.get(CONTENT)
        if written is None or written == self.hashes.metadata:
            return
        steps = zip_longest(written.get("steps", "").split(), self.hashes.steps)
        step = next((number for number, (then, now) in enumerate(steps) if then != now), None)
        where = "what follows the last step" if step is None else "what was recorded since the step before"
        raise _UnsoundError(Flaw(f"{where} is {CHANGED}", AGAIN, step=step))

    def _fail(self, message: str, remedy: str) -> Never:
        in_message = self._topic is not None
        raise _UnsoundError(
            Flaw(
                message,
                remedy,
                self._byte,
                self.number if in_message else None,
                self._topic,
                self._step if in_message else None,
            )
        )
