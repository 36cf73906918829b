"""Traces of whole runs on disk, each recorded once, and edited copies of them."""

import tempfile
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

from kit.places import SCENARIOS

from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.file.writer import TraceWriter
from skolem.traces.messages import JSON_TOPICS, Message

_FOLDER = tempfile.TemporaryDirectory()  # removed after the tests


@cache
def recorded(name: str, seed: int = 0, world: str = "symbolic", overrides: tuple[str, ...] = ()) -> Path:
    """Return the trace of a run of a scenario file, recorded at the first call."""
    path = Path(_FOLDER.name) / f"{name}-{seed}-{world}-{abs(hash(overrides))}.mcap"
    run(prepare(SCENARIOS / f"{name}.yaml", overrides, seed, world), path)
    return path


def rewritten(path: Path, out: Path, edit: Callable[[Recorded], Iterable[Message]]) -> Path:
    """Write a copy of a trace in which each JSON message is replaced by what `edit` returns for it."""
    trace = Trace(path)
    run_data = {key: value for key, value in trace.metadata["run"].items() if key != "schema_version"}
    writer = TraceWriter(out, attachments=trace.attachments, run=run_data, env=trace.metadata["env"])
    with writer:
        for message in trace.messages(*JSON_TOPICS):
            for each in edit(message):
                writer.write(message.topic, each, message.tick)
    return out


def unchanged(message: Recorded) -> Message:
    """Return a message as it is."""
    found = message.message
    assert isinstance(found, Message)
    return found
