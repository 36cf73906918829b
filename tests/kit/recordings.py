"""Traces of whole runs on disk, each made once by whichever process of the tests needs it first, and spoilt copies."""

import fcntl
import hashlib
import os
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

from kit.places import RECORDINGS, SCENARIOS

from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.file.writer import TraceWriter
from skolem.traces.messages import JSON_TOPICS, Message


@cache
def recorded(name: str, seed: int = 0, world: str = "symbolic", overrides: tuple[str, ...] = ()) -> Path:
    """Return the trace of a run of a scenario file, made at the first call; it is to be read only."""
    asked = hashlib.sha256(repr((name, seed, world, overrides)).encode()).hexdigest()[:16]
    path = _folder() / asked / f"{name}-{seed}-{world}.mcap"
    path.parent.mkdir(parents=True, exist_ok=True)
    with (path.parent / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            new = path.with_suffix(".new.mcap")
            run(prepare(SCENARIOS / f"{name}.yaml", overrides, seed, world), new)
            new.rename(path)
    return path


def _folder() -> Path:
    """Return the folder of the workers of xdist; any other process has its own, since a fork may try out a mutant."""
    owner = "workers" if "PYTEST_XDIST_WORKER" in os.environ else str(os.getpid())
    return Path(os.environ[RECORDINGS]) / owner


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
