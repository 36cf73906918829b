"""Writing of a run as one MCAP file, which is complete however the run ends.

Two runs of one scenario and seed on one machine write the same bytes: log times come from the tick counter, ids from
the topic table, and nothing in the file knows the time of day or the name of the machine.
"""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from google.protobuf.message import Message as Protobuf
from mcap.writer import CompressionType, Writer

from skolem.traces.errors import Fault, InputError, InternalError, UnwrittenError, error_text
from skolem.traces.file.clock import time_ns
from skolem.traces.file.codec import CONTENT, ContentHash, HashChain, counter_of, encode, schema_bytes, schema_name
from skolem.traces.file.interrupts import interrupts_held
from skolem.traces.messages import CLASS_OF, JSON_TOPICS, SCHEMA_VERSION, Chain, Message, RunEnd, RunStatus
from skolem.traces.written import created, give_name, refuse_special, unwritable

LIBRARY = "skolem-trace/1"  # mcap's default names its own version, so that an update would change the bytes
CHUNK_BYTES = 64 * 1024
LAST_NS = 2**64 - 1  # the greatest log time of a message


class TraceWriter:
    """A trace that is being written; used as a context manager.

    The file is called `NAME.partial` until it is complete. The end of the block, also by an exception or Ctrl-C, adds
    `/run/end` if it is missing and the content hash, closes the file and gives it its name. A killed process or a full
    disk leaves the partial file: `skolem recover` saves everything up to its last closed step or full chunk. So an
    existing partial file is never replaced: another run writes it, or its steps are worth saving.

    Attributes:
        path: Path of the complete trace.
        partial: Path of the trace until it is complete.
        written: Whether the trace lies under its name.
    """

    def __init__(
        self,
        path: Path,
        *,
        attachments: Mapping[str, bytes],
        run: Mapping[str, str],
        env: Mapping[str, str],
        profile: bool = False,
        file: IO[bytes] | None = None,
    ) -> None:
        """Keep the beginning of the trace; nothing is written before the block is entered.

        Args:
            path: Path of the complete trace; missing folders are made.
            attachments: `scenario.yaml` and `rules/*.lp`, by name: the inputs of the run.
            run: Metadata of the run, such as its seed; the schema version is added.
            env: Metadata of the machine, as `skolem.traces.file.environment.environment` gives them.
            profile: Whether `/perf` is recorded. Wall times differ from run to run, so by default they are dropped.
            file: The partial file, if the caller has begun it already.
        """
        self.path = path
        self.partial = partial_of(path)
        self.written = False
        self._attachments, self._begun = attachments, file
        self._metadata = {"run": dict(run) | {"schema_version": str(SCHEMA_VERSION)}, "env": env}
        self._profile = profile
        self._hash = ContentHash()
        self._chain = HashChain()
        self._counters = {"decision": 0, "truth": 0, "perf": 0}
        self._tick = 0
        self._results = 0
        self._candidate: tuple[float, str | None] = (0.0, None)
        self._ended = False

    def write(self, topic: str, message: Message | Protobuf, tick: int) -> None:
        """Append one message at a simulated time; an interrupt waits until the message is whole.

        Raises:
            InternalError: If the topic or type is wrong, time runs backwards or too far, or the run has ended already.
            UnwrittenError: If the file cannot be written further; it is closed, and what was written stays.
        """
        if topic == "/perf" and not self._profile:
            return
        data = encode(topic, message)
        counter = counter_of(topic)
        if tick < self._tick:
            raise InternalError(f"{topic}: tick {tick} comes after tick {self._tick}")
        if time_ns(tick) > LAST_NS:  # a message that cannot be packed would keep the trace from being closed
            raise InternalError(f"{topic}: tick {tick} is beyond the times that a trace can hold")
        if self._ended and counter == "decision":
            raise InternalError(f"{topic}: the run has ended")
        with interrupts_held(), self._on_disk():
            self._append(topic, data, tick, counter)

    def candidate(self, probability: float, anchor: str | None) -> None:
        """Remember the goal's best candidate so far, for the end record of a run that is cut short."""
        self._candidate = (probability if 0.0 <= probability <= 1.0 else 0.0, anchor)

    def close_step(self, step: int, tick: int) -> str:
        """Write the hash chain over the step's messages, write all messages to the disk, and return the chain."""
        self.write("/chain", Chain(step=step, chain=self._chain.close()), tick)
        return self._chain.link

    @property
    def content_hash(self) -> str:
        """Hash of everything written so far but PERF; final after the block."""
        return self._hash.content

    @property
    def decision_hash(self) -> str:
        """Hash of the INPUT and DERIVED messages written so far."""
        return self._hash.decision

    def __enter__(self) -> Self:
        """Create the partial file; an interrupt before the block leaves none.

        Raises:
            InputError: If the file cannot be created, has no room for its beginning, or exists already.
        """
        file = self._begun
        try:
            with interrupts_held():
                file = self._file = file or begin(self.path)
                self._start()
        except OSError as error:
            assert file is not None, "what cannot be created is an InputError"
            discard(file, self.path)
            raise unwritable(self.path, error) from error
        except BaseException:
            if file is not None:
                discard(file, self.path)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._file.closed:  # writing failed before
            return
        with interrupts_held(), self._file:
            try:
                if not self._ended:
                    self._cut_short(error)
            finally:  # also if the end itself cannot be told
                if not self._file.closed:
                    with self._on_disk():
                        self._finish()
            self.written = True

    def _finish(self) -> None:
        """Write the content hash and the index, and give the file its name."""
        self._mcap.flush()
        self._mcap.add_metadata(CONTENT, self._hash.metadata)
        self._mcap.finish()
        self._file.flush()
        os.fsync(self._file.fileno())
        give_name(self.partial, self.path)

    @contextmanager
    def _on_disk(self) -> Iterator[None]:
        """Close the file if the block cannot write: `recover` can save its whole messages."""
        try:
            yield
        except OSError as error:
            with suppress(OSError):  # closing tries the failed write again
                self._file.close()
            said = f"cannot be written to its end: {error.strerror or error}"
            remedy = f"`skolem recover {self.partial} -o FILE` saves what reached it"
            raise UnwrittenError(f"{self.partial}: {said}; {remedy}") from error

    def _start(self) -> None:
        """Write metadata, attachments, schemas and channels."""
        self._mcap = Writer(self._file, compression=CompressionType.ZSTD, chunk_size=CHUNK_BYTES, enable_data_crcs=True)
        self._mcap.start(profile="", library=LIBRARY)
        for name, metadata in self._metadata.items():
            self._mcap.add_metadata(name, dict(sorted(metadata.items())))
        for name in sorted(self._attachments):
            self._mcap.add_attachment(0, 0, name, "text/plain", self._attachments[name])
        self._channels = {topic: self._register(topic) for topic in CLASS_OF}

    def _register(self, topic: str) -> int:
        schema_encoding, encoding = ("jsonschema", "json") if topic in JSON_TOPICS else ("protobuf", "protobuf")
        schema = self._mcap.register_schema(schema_name(topic), schema_encoding, schema_bytes(topic))
        return self._mcap.register_channel(topic, encoding, schema)

    def _append(self, topic: str, data: bytes, tick: int, counter: str) -> None:
        sequence, log_time_ns = self._counters[counter], time_ns(tick)
        self._mcap.add_message(self._channels[topic], log_time_ns, data, log_time_ns, sequence)
        if topic == "/chain":
            self._mcap.flush()
        self._file.flush()
        self._hash.add(topic, data, log_time_ns, sequence)
        self._chain.add(topic, data)
        self._counters[counter] += 1
        self._tick = tick
        self._results += topic == "/action/result"
        self._ended |= topic == "/run/end"

    def _cut_short(self, error: BaseException | None) -> None:
        """Write the end record of a run that has none."""
        status: RunStatus = "interrupted" if isinstance(error, KeyboardInterrupt) else "error"
        reason = "closed without an end record" if error is None else error_text(error)
        probability, anchor = self._candidate
        end = RunEnd(
            status=status,
            steps=self._results,
            reason=reason.encode("utf-8", "backslashreplace").decode(),
            goal_probability=probability,
            anchor=anchor,
        )
        self.write("/run/end", end, self._tick)


def partial_of(path: Path) -> Path:
    """Return the path of a trace until it is complete."""
    return path.parent / f"{path.name}.partial"


def begin(path: Path) -> IO[bytes]:
    """Create the partial file of a trace, and return it open.

    Raises:
        InputError: If the file cannot be created or renamed in the end, or exists already.
    """
    refuse_special(path)
    partial = partial_of(path)
    try:
        return created(partial)
    except OSError as error:
        if os.path.lexists(partial):
            said = "exists: another run is writing it, or one was killed; wait for it, save its steps with"
            remedy = f"`skolem recover {partial} -o FILE`, or remove it"
            raise InputError([Fault(str(partial), 0, 0, f"{said} {remedy}")]) from error
        raise unwritable(path, error) from error


def discard(file: IO[bytes], path: Path) -> None:
    """Close and remove the partial file of a trace that was not written."""
    partial_of(path).unlink(missing_ok=True)
    with suppress(OSError):  # the rest may have no room on the disk
        file.close()
