"""What the verbs write: no link is followed or replaced, and lost output changes no run."""

import os
import resource
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from kit.places import GOLDEN, ROOT

from skolem.tools import cli
from skolem.traces.file.check import check
from skolem.traces.file.reader import Trace
from skolem.traces.file.writer import partial_of
from skolem.traces.messages import RunEnd

GREEN = str(ROOT / "scenarios" / "sim1_green.yaml")
TRACE = str(GOLDEN / "sim1_green.mcap")
COMMAND = [sys.executable, "-c", "import sys; from skolem.tools.cli import main; sys.exit(main())"]
SHORT = ["--world", "symbolic", "--set", "limits.steps=1"]
VERBS = {  # each with the place to write to as its last argument
    "run": ["run", GREEN, *SHORT, "-q", "-o"],
    "generate": ["generate", "three", "-o"],
    "rules doc": ["rules", "doc", "-o"],
    "recover": ["recover", TRACE, "-o"],
    "view --save": ["view", TRACE, "--save"],
    "view --shot": ["view", TRACE, "--shot"],
    "reproduce --keep": ["reproduce", TRACE, "-q", "--keep"],
    "sweep --write": ["sweep", GREEN, *SHORT, "--seeds", "0", "-q", "-o", "swept", "--write"],
}


@pytest.fixture
def said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[..., list[str]]:
    """Run a command in an empty folder; return its exit status and the lines that it prints, on both streams."""
    monkeypatch.chdir(tmp_path)

    def run(*args: str) -> list[str]:
        monkeypatch.setattr(sys, "argv", ["skolem", *args])
        status = cli.main()
        out, err = capfd.readouterr()
        return [str(status), *out.splitlines(), *err.splitlines()]

    return run


@contextmanager
def small_files(most: int) -> Iterator[None]:
    """Let no file grow beyond some bytes, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("verb", VERBS)
def test_no_verb_writes_through_a_link_or_in_its_place(
    verb: str, said: Callable[..., list[str]], tmp_path: Path
) -> None:
    (tmp_path / "mine").write_text("before")
    for target in ("mine", "nowhere"):
        (tmp_path / "link").symlink_to(target)
        status, line = said(*VERBS[verb], "link")
        assert (status, line[:6]) == ("2", "link: ")
        assert os.readlink(tmp_path / "link") == target
        (tmp_path / "link").unlink()
    assert (tmp_path / "mine").read_text() == "before"
    assert not (tmp_path / "nowhere").exists()


@pytest.mark.parametrize("verb", VERBS)
def test_a_place_where_nothing_can_be_written_is_one_line_and_2(
    verb: str, said: Callable[..., list[str]], tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("before")
    for place in ("folder", "file/within", "x" * 300, "/proc/none/x"):
        status, line = said(*VERBS[verb], place)
        assert (status, place in line) == ("2", True)


@pytest.mark.parametrize("verb", ["generate", "rules doc", "view --save", "reproduce --keep"])
def test_a_disk_that_is_full_is_one_line_and_leaves_what_was_there(
    verb: str, said: Callable[..., list[str]], tmp_path: Path
) -> None:
    with small_files(2000):
        status, line = said(*VERBS[verb], "out")
    assert status in ("2", "3")
    assert "File too large" in line
    assert list(tmp_path.iterdir()) == []


def test_output_that_cannot_be_written_stops_no_run(tmp_path: Path) -> None:
    command = [*COMMAND, "run", GREEN, *SHORT, "-o", "a.mcap", "--json"]
    with open("/dev/full", "wb") as full:
        done = subprocess.run(command, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 3
    assert done.stderr.splitlines()[-1] == "standard output cannot be written: No space left on device"
    assert check(tmp_path / "a.mcap").sound
    [end] = Trace(tmp_path / "a.mcap").of(RunEnd)
    assert end.status == "limit_reached"


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_stream_that_is_closed_is_not_taken_for_the_trace(number: int, tmp_path: Path) -> None:
    command = " ".join(map(shlex.quote, [*COMMAND, "run", GREEN, *SHORT, "-o", "a.mcap"]))
    done = subprocess.run(["bash", "-c", f"{command} {number}>&-"], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, "Traceback" in done.stderr) == (1, False)
    assert check(tmp_path / "a.mcap").sound


def test_a_reader_that_leaves_does_not_cut_a_run_short(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = [*COMMAND, "run", GREEN, *SHORT, "-o", "a.mcap"]
    done = subprocess.run(command, cwd=tmp_path, stdout=writer, stderr=writer)
    os.close(writer)
    assert done.returncode == 141
    [end] = Trace(tmp_path / "a.mcap").of(RunEnd)
    assert end.status == "limit_reached"


def test_a_link_in_the_place_of_a_draft_is_not_followed(said: Callable[..., list[str]], tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("before")
    for name in ("out.partial", "out.copying"):
        (tmp_path / name).symlink_to("mine")
    assert [said(*VERBS[verb], "out")[0] for verb in ("run", "recover", "generate")] == ["2", "2", "0"]
    assert (tmp_path / "mine").read_text() == "before"
    assert partial_of(tmp_path / "out").is_symlink()
