"""A recorded run, run again from its trace alone."""

from pathlib import Path

import pytest
from recordings import recorded, rewritten, unchanged

from skolem.tools.live import Silence
from skolem.tools.reproducing import reproduce, setup_in
from skolem.traces.diff import Comparison, Tolerance
from skolem.traces.errors import TraceError
from skolem.traces.messages import TrueState
from skolem.traces.reader import Trace


def again(path: Path, out: Path) -> Comparison:
    trace = Trace(path)
    return reproduce(trace, setup_in(trace), out, Silence(), Tolerance())


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


def test_a_trace_without_its_scenario_cannot_be_run(record_run: object, tmp_path: Path) -> None:
    path = rewritten(recorded("sim1_green"), tmp_path / "t.mcap", lambda _: [])
    with pytest.raises(TraceError, match="nothing to run"):
        setup_in(Trace(path))
