"""A trace read while it is written: every closed step at once, nothing twice, nothing left out."""

from collections.abc import Callable
from pathlib import Path

import pytest
from kit.sample_run import record_step, run_start

from skolem.traces.errors import TraceError
from skolem.traces.file.following import follow
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.file.writer import TraceWriter


def written(follower: object) -> list[Recorded]:
    """Return what is there for now."""
    return list(iter(follower.__next__, None))  # type: ignore[attr-defined]


def test_each_step_is_there_as_soon_as_it_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    follower = follow(path.with_name("run.mcap.partial"))
    assert next(follower) is None
    with TraceWriter(path, attachments={"scenario.yaml": b"skolem: 1\n"}, run={}, env={}) as writer:
        writer.write("/run/start", run_start(), 0)
        assert next(follower) is None
        for step in range(3):
            record_step(writer, step)
            seen = written(follower)
            assert [found.topic for found in seen][-1] == "/chain"
            assert ("/run/start" in [found.topic for found in seen]) == (step == 0)
    assert [found.topic for found in follower if found is not None] == ["/run/end"]


def test_a_followed_trace_is_the_trace(tmp_path: Path, record_run: Callable[..., str]) -> None:
    path = tmp_path / "run.mcap"
    record_run(path, steps=5)
    assert list(follow(path)) == list(Trace(path).messages())


def test_a_step_that_is_half_on_the_disk_is_not_there_yet(tmp_path: Path, record_run: Callable[..., str]) -> None:
    path, growing = tmp_path / "run.mcap", tmp_path / "growing"
    record_run(path, steps=2)
    whole, seen = path.read_bytes(), []
    growing.write_bytes(b"")
    follower = follow(growing)
    for end in range(0, len(whole) + 1, 97):
        growing.write_bytes(whole[:end])
        seen += written(follower)
    growing.write_bytes(whole)
    assert seen + [found for found in follower if found is not None] == list(Trace(path).messages())


def test_what_is_no_trace_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap.partial"
    path.write_bytes(b"something else entirely")
    with pytest.raises(TraceError, match="not a trace"):
        next(follow(path))
