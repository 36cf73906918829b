"""The verb `view`, and runs that are shown while they go on."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from kit.places import SCENARIOS
from kit.recordings import recorded
from kit.views import need_driver
from PIL import Image, ImageChops

from skolem.tools import cli
from skolem.tools.loop.children import end
from skolem.tools.run.watching import watched
from skolem.tools.view import viewing
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Trace

SKOLEM = [sys.executable, "-c", "from skolem.tools.cli import main; raise SystemExit(main())"]
NOBODY = "unix:no-display-here"  # names a display that does not exist


def called(monkeypatch: pytest.MonkeyPatch, *args: str) -> int:
    """Run the command in this process and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["skolem", *args])
    return cli.main()


def test_a_recording_is_written_where_it_is_wanted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trace, out = recorded("sim3_unknown"), tmp_path / "new" / "sim3.rrd"
    assert called(monkeypatch, "view", str(trace), "--save", str(out), "--json") == 0
    assert out.read_bytes().startswith(b"RRF2")
    assert json.loads(capsys.readouterr().out) == {"trace": str(trace), "recording": str(out), "faults": []}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--at", "step=1"], "--shot"),
        (["--shot", "x.png", "--at", "1"], "step=N or time=S"),
        (["--shot", "x.png", "--at", "step=one"], "step=N or time=S"),
        (["--shot", "x.png", "--at", "time=1e9"], "the run has time 0 to"),
        (["--shot", "x.png", "--web"], "exclude one another"),
        (["--save", "/proc/none/x.rrd"], "cannot be written"),
        (["--shot", "/proc/none/x.png"], "cannot be written"),
        (["--save", "."], "is a folder"),
    ],
)
def test_mistakes_are_named(
    options: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, "view", str(recorded("sim3_unknown")), *options) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--save", "--shot"])
@pytest.mark.parametrize("name", ["looked-at.mcap", "link.mcap", "other.mcap", "running.mcap.partial"])
def test_no_trace_is_written_over(
    option: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    content = recorded("sim3_unknown").read_bytes()
    trace = tmp_path / "looked-at.mcap"
    for each in (trace, tmp_path / "other.mcap", tmp_path / "running.mcap.partial"):
        each.write_bytes(content)
    (tmp_path / "link.mcap").symlink_to(trace)
    assert called(monkeypatch, "view", str(trace), option, str(tmp_path / name)) == 2
    assert ("give the name of the file" if "link" in name else "give another name") in capsys.readouterr().err
    assert (tmp_path / name).read_bytes() == content


def test_a_file_that_is_no_trace_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x.mcap").write_bytes(b"something else")
    assert called(monkeypatch, "view", str(tmp_path / "x.mcap"), "--save", str(tmp_path / "x.rrd")) == 3
    assert "not a trace" in capsys.readouterr().err


def test_moments_are_steps_or_seconds() -> None:
    trace = Trace(recorded("sim3_unknown"))
    assert viewing.moment_of("step=2", trace) == ("step", 2)
    assert viewing.moment_of("time=1.5", trace) == ("time", 1.5)


@pytest.mark.viewer
def test_a_picture_of_a_step_is_written_by_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    need_driver()
    trace, steps = recorded("sim3_unknown"), (1, 2)
    pictures = [tmp_path / "new" / f"{step}.png" for step in steps]
    for step, picture in zip(steps, pictures, strict=True):
        shot = ["--shot", str(picture), "--at", f"step={step}", "--json"]
        assert called(monkeypatch, "view", str(trace), *shot) == 0
        assert json.loads(capsys.readouterr().out) == {"trace": str(trace), "picture": str(picture), "faults": []}
    first, second = (Image.open(picture) for picture in pictures)
    assert first.size == second.size == (1600, 1000)
    assert ImageChops.difference(first, second).getbbox() is not None


# ---------------------------------------------------------------- while it goes on


def test_without_a_display_a_run_is_not_shown_and_not_started(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(InputError, match="no display"), watched(tmp_path / "run.mcap"):
        pytest.fail("the run was started")


@pytest.mark.viewer
def test_a_window_that_cannot_be_opened_does_not_hinder_the_run(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    options = ["--set", "limits.steps=2", "--seed", "0", "--world", "symbolic", "-q", "--view", "-o", str(path)]
    ran = subprocess.run(
        [*SKOLEM, "run", str(SCENARIOS / "sim1_green.yaml"), *options],
        env=os.environ | {"DISPLAY": NOBODY},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ran.returncode == 1, ran.stderr  # the limit was reached
    assert path.read_bytes() == recorded("sim1_green", overrides=("limits.steps=2",)).read_bytes()


@pytest.mark.viewer
def test_who_watches_is_gone_when_the_run_is_killed(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path; from skolem.tools.run.watching import watched\n"
        "with watched(Path(sys.argv[1])):\n    time.sleep(60)"
    )
    run = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "x.mcap")], env=os.environ | {"DISPLAY": NOBODY})
    me, deadline = psutil.Process(run.pid), time.monotonic() + 20.0
    while not (children := me.children(recursive=True)) and time.monotonic() < deadline:
        time.sleep(0.05)
    run.kill()
    run.wait(10)
    gone, alive = psutil.wait_procs(children, timeout=10)
    assert gone
    assert not alive


def test_a_process_that_does_not_end_when_asked_is_ended() -> None:
    code = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(flush=True); time.sleep(60)"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as stubborn:
        assert stubborn.stdout is not None
        stubborn.stdout.readline()
        end(stubborn, seconds=0.2)
        assert stubborn.returncode is not None
