"""Folders of traces replayed in several processes: as if one after the other."""

import json
import os
from pathlib import Path

import pytest
from kit.recordings import recorded

from skolem.tools.cli import main
from skolem.tools.replay.pool import reports
from skolem.tools.replay.replayer import Replayer
from skolem.tools.replay.reports import Report, Wanted
from skolem.traces.errors import InternalError

SHARED = ("--workers", "2")


class Fatal:
    """Ends the process that it is sent to."""

    def __reduce__(self) -> tuple[object, tuple[int]]:
        return os._exit, (1,)


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, list[str]]:
    """Return the exit status of `skolem replay` and what it printed, but for how long it took."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["skolem", "replay", *arguments])
        status = main()
    return status, [line.split(";")[0] for line in capsys.readouterr().out.splitlines()]


def test_processes_tell_in_the_order_of_the_traces_what_one_would(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    none = tmp_path / "none.mcap"
    none.write_text("not a trace")
    traces = [str(recorded("sim1_green")), str(none), str(recorded("occluded"))]
    alone = printed(capsys, *traces)
    assert alone[0] == 3
    assert [line.split(": ")[1] for line in alone[1]] == [
        "IDENTICAL",
        "not a trace",
        "IDENTICAL",
        "2 identical, 1 unsound",
    ]
    assert printed(capsys, *traces, *SHARED) == alone


def test_processes_are_told_what_would_be_otherwise(capsys: pytest.CaptureFixture[str]) -> None:
    traces = [str(recorded(name)) for name in ("sim1_green", "occluded")]
    alone = printed(capsys, *traces, "--set", "limits.steps=2")
    assert (alone[0], alone[1][-1]) == (1, "2 traces: 2 changed")
    assert printed(capsys, *traces, "--set", "limits.steps=2", *SHARED) == alone


def test_a_trace_over_which_we_fail_does_not_keep_others_from_being_replayed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    bad, good = str(recorded("occluded")), str(recorded("sim1_green"))
    report = Replayer.report

    def fails(self: Replayer, path: Path) -> Report:
        return report(self, path) if str(path) != bad else 1 / 0  # type: ignore[return-value]

    monkeypatch.setattr(Replayer, "report", fails)
    status, lines = printed(capsys, bad, good)
    said = [line.removeprefix(f"{bad}: ").removeprefix(f"{good}: ") for line in lines]
    assert (status, said[0]) == (4, "internal error: ZeroDivisionError: division by zero")
    assert said[1].startswith("IDENTICAL: ")
    assert said[2] == "2 traces: 1 identical, 1 internal"
    status, lines = printed(capsys, bad, good, "--json")
    assert (status, [json.loads(line)["status"] for line in lines]) == (4, ["internal", "identical"])


def test_a_process_that_fails_over_a_trace_goes_on_with_the_next() -> None:
    traces = [recorded("sim1_green"), recorded("occluded")]
    wrong = Wanted("x", False, False, None, None, False, None, ())  # type: ignore[arg-type]
    assert [report.status for report in reports(traces, wrong, 2)] == ["internal", "internal"]


def test_what_is_wrong_whatever_the_trace_is_told_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    traces = [str(recorded("sim1_green")), str(recorded("occluded"))]
    assert printed(capsys, *traces, "--rules", str(tmp_path), *SHARED) == (2, [])


def test_a_process_that_dies_ends_the_command_with_a_remedy() -> None:
    with pytest.raises(InternalError, match="--workers 1"):
        list(reports([Path("a"), Path("b")], Fatal(), 2))  # type: ignore[arg-type]
