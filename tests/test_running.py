"""A run from the command line: what it leaves, what it says of it, and what it never replaces."""

import json
import sys
from pathlib import Path

import pytest
from mcap.writer import Writer

from skolem.tools import cli, watching
from skolem.traces.reader import Trace
from skolem.traces.writer import TraceWriter, partial_of

GREEN = str(Path(__file__).parent.parent / "scenarios" / "sim1_green.yaml")


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


@pytest.fixture
def blind(monkeypatch: pytest.MonkeyPatch) -> None:
    """A viewer that ends at once."""
    monkeypatch.setenv("DISPLAY", ":99")
    monkeypatch.setattr(watching, "_SKOLEM", "pass")


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
