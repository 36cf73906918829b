"""A run from the command line: what it leaves, what it says of it, and what it never replaces."""

import errno
import json
import os
import shutil
import sys
from pathlib import Path

import pytest
from kit.places import SCENARIOS
from mcap.writer import Writer

from skolem.tools import cli
from skolem.tools.run import watching
from skolem.traces.file.reader import Trace
from skolem.traces.file.writer import TraceWriter, partial_of

GREEN = str(SCENARIOS / "sim1_green.yaml")


def run(monkeypatch: pytest.MonkeyPatch, trace: Path, *options: str) -> int:
    monkeypatch.setattr(sys, "argv", ["skolem", "run", GREEN, "--world", "symbolic", "-q", "-o", str(trace), *options])
    return cli.main()


def test_a_run_interrupted_before_it_begins_leaves_nothing_and_names_no_trace(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Writer, "start", interrupted)
    assert run(monkeypatch, tmp_path / "a.mcap") == 130
    assert capsys.readouterr().out == "interrupted; 0 actions, 0 replans, 0.0 s simulated, 0.0 s wall\n"
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "a.mcap").write_text("an older run")
    assert run(monkeypatch, tmp_path / "a.mcap", "--json") == 130
    said = json.loads(capsys.readouterr().out)
    assert (said["trace"], said["content_hash"]) == (None, "")
    assert (tmp_path / "a.mcap").read_text() == "an older run"


def test_the_steps_of_a_killed_run_are_not_replaced_by_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    left = partial_of(tmp_path / "a.mcap")
    left.write_text("steps")
    assert run(monkeypatch, tmp_path / "a.mcap") == 2
    out, err = capsys.readouterr()
    assert (out, left.read_text()) == ("", "steps")
    assert f"`skolem recover {left} -o FILE`, or remove it" in err


def test_a_run_does_not_take_the_place_of_what_is_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert run(monkeypatch, tmp_path / "pipe") == 2
    said = f"{tmp_path / 'pipe'}: is a device, a pipe or a socket; give the name of a file\n"
    assert capsys.readouterr() == ("", said)
    assert (tmp_path / "pipe").is_fifo()


@pytest.mark.parametrize("json_wanted", [False, True])
def test_a_full_disk_ends_a_run_with_one_line_and_3(
    json_wanted: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(writer: Writer) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Writer, "flush", full)  # of the first step
    trace = tmp_path / "a.mcap"
    assert run(monkeypatch, trace, *(["--json"] if json_wanted else [])) == 3
    out, err = capsys.readouterr()
    left = partial_of(trace)
    remedy = f"`skolem recover {left} -o FILE` saves what reached it"
    said = f"{left}: cannot be written to its end: No space left on device; {remedy}"
    assert err == f"{said}\n"
    if json_wanted:
        told = json.loads(out)
        assert (told["status"], told["reason"], told["trace"]) == ("error", said, None)
    else:
        assert out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap.partial"]


@pytest.fixture
def blind(monkeypatch: pytest.MonkeyPatch) -> None:
    """A viewer that ends at once."""
    monkeypatch.setenv("DISPLAY", ":99")
    monkeypatch.setattr(sys, "executable", shutil.which("true"))


def test_a_run_that_is_watched_writes_the_file_that_the_viewer_holds(tmp_path: Path, blind: None) -> None:
    path = tmp_path / "a.mcap"
    with watching.watched(path) as file:
        held = partial_of(path).stat().st_ino
        with TraceWriter(path, attachments={}, run={}, env={}, file=file):
            pass
    assert Trace(path).path.stat().st_ino == held
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap"]


def test_a_watched_run_that_does_not_begin_leaves_nothing(tmp_path: Path, blind: None) -> None:
    with pytest.raises(KeyboardInterrupt), watching.watched(tmp_path / "a.mcap"):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []
