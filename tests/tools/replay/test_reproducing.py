"""A recorded run, run again from its trace alone."""

import sys
from pathlib import Path

import pytest
from kit.recordings import recorded, rewritten, unchanged

from skolem.tools import cli
from skolem.tools.loop.mind import Mind
from skolem.tools.loop.session import Unwatched, run
from skolem.tools.replay.reproducing import end_of_again, reproduce, setup_in
from skolem.traces.compare.diff import Comparison, Tolerance
from skolem.traces.errors import InternalError, TraceError
from skolem.traces.file.reader import Trace
from skolem.traces.file.writer import partial_of
from skolem.traces.messages import TrueState


def again(path: Path, out: Path) -> Comparison:
    trace = Trace(path)
    return reproduce(trace, setup_in(trace), out, Unwatched(), Tolerance())


@pytest.mark.parametrize(("scenario", "seed"), [("sim1_green", 3), ("sim3_unknown", 0), ("sim1_moved", 0)])
def test_a_run_can_be_made_again_from_its_trace(scenario: str, seed: int, tmp_path: Path) -> None:
    path = recorded(scenario, seed)
    comparison = again(path, tmp_path / "again.mcap")
    assert comparison.divergences == []
    assert comparison.compared["/truth/state"] > 2
    assert (tmp_path / "again.mcap").read_bytes() == path.read_bytes()


@pytest.mark.physics
def test_a_run_with_physics_can_be_made_again(tmp_path: Path) -> None:
    comparison = again(recorded("sim1_green", 0, "pybullet"), tmp_path / "again.mcap")
    assert comparison.divergences == []
    assert comparison.compared["/tf"] > 100


def test_overrides_are_part_of_the_trace(tmp_path: Path) -> None:
    path = recorded("sim1_green", 0, "symbolic", ("limits.steps=4",))
    assert again(path, tmp_path / "again.mcap").identical


def test_another_truth_is_found(tmp_path: Path) -> None:
    def moved(message: object) -> list[object]:
        found = unchanged(message)  # type: ignore[arg-type]
        if isinstance(found, TrueState) and found.step == 2:
            found = found.model_copy(update={"sha256": "0" * 64})
        return [found]

    path = rewritten(recorded("sim1_green"), tmp_path / "t.mcap", moved)  # type: ignore[arg-type]
    [first] = again(path, tmp_path / "again.mcap").divergences
    assert (first.topic, first.changes[0].path) == ("/truth/state", ".sha256")


def test_a_run_that_was_cut_short_is_compared_as_far_as_it_goes(tmp_path: Path) -> None:
    left = [60]

    def first_ones(message: object) -> list[object]:
        left[0] -= 1
        return [unchanged(message)] if left[0] >= 0 else []  # type: ignore[arg-type]

    path = rewritten(recorded("sim1_green"), tmp_path / "t.mcap", first_ones)  # type: ignore[arg-type]
    assert again(path, tmp_path / "again.mcap").divergences == []


def test_an_error_that_does_not_come_again_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails(self: Mind, *_: object) -> None:
        raise InternalError("boom")

    path, out = tmp_path / "t.mcap", tmp_path / "again.mcap"
    setup = setup_in(Trace(recorded("sim1_green")))
    monkeypatch.setattr(Mind, "update", fails)
    with pytest.raises(InternalError):
        run(setup, path)
    assert again(path, out).identical
    assert end_of_again(Trace(path), Trace(out)) == ""
    monkeypatch.undo()
    monkeypatch.setattr(sys, "argv", ["skolem", "reproduce", "-q", str(path)])
    assert cli.main() == 0
    said = capsys.readouterr().out
    assert said.endswith(" messages: IDENTICAL; the recorded error (InternalError: boom) does not come again\n")


def test_the_new_trace_is_kept_beside_what_a_killed_run_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old, keep = recorded("sim1_green"), tmp_path / "new" / "k.mcap"
    left = partial_of(keep)
    left.parent.mkdir()
    left.write_text("steps")
    monkeypatch.setattr(sys, "argv", ["skolem", "reproduce", "-q", str(old), "--keep", str(keep)])
    assert cli.main() == 0
    assert keep.read_bytes() == old.read_bytes()
    assert {*keep.parent.iterdir()} == {keep, left}


def test_a_place_where_nothing_can_be_kept_is_refused_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    keep = str(tmp_path / "file" / "k.mcap")
    monkeypatch.setattr(sys, "argv", ["skolem", "reproduce", "-q", str(recorded("sim1_green")), "--keep", keep])
    assert cli.main() == 2
    assert capsys.readouterr().err.startswith(f"{keep}: cannot be written: ")


def test_a_trace_without_its_scenario_cannot_be_run(record_run: object, tmp_path: Path) -> None:
    path = rewritten(recorded("sim1_green"), tmp_path / "t.mcap", lambda _: [])
    with pytest.raises(TraceError, match="nothing to run"):
        setup_in(Trace(path))
