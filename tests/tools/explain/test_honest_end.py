"""A goal that cannot be reached: the run ends by itself, says what was searched and how near it came, exit status 1."""

import json
import re
import sys
from pathlib import Path

import pytest
from kit.places import SCENARIOS

from skolem.tools import cli
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Plan, RunEnd

IMPOSSIBLE = SCENARIOS / "impossible.yaml"
REGIONS = ("_reg1_", "_reg2_", "_reg3_")
THRESHOLD = 0.9  # of the goal


def run(monkeypatch: pytest.MonkeyPatch, trace: Path, *args: str) -> int:
    """Run the scenario in this process, without physics, and return the exit status."""
    command = ["skolem", "run", str(IMPOSSIBLE), "--world", "symbolic", "-q", "-o", str(trace), *args]
    monkeypatch.setattr(sys, "argv", command)
    return cli.main()


@pytest.mark.parametrize("seed", ["0", "1"])
def test_it_exits_with_1_and_says_what_was_searched_and_the_best_candidate(
    seed: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trace = tmp_path / "a.mcap"
    assert run(monkeypatch, trace, "--seed", seed) == 1
    out = capsys.readouterr().out
    first, *_ = out.splitlines()
    (end,) = Trace(trace).of(RunEnd)
    assert first.startswith("goal not achieved: no plan with a probability of at least 0.0001 reaches the goal")
    assert f"best candidate {end.anchor or 'no object'}, p = {end.goal_probability:.3f}" in first
    assert end.goal_probability < THRESHOLD
    seen = dict(re.findall(r"(_reg\d_) (\d+) %", out))
    assert sorted(seen) == list(REGIONS)
    assert all(int(percent) >= 90 for percent in seen.values())
    assert "true in the simulator: no" in out


def test_a_candidate_is_told_of_with_each_of_its_properties(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With this seed the search leaves an object of which it is open what colour it has."""
    assert run(monkeypatch, tmp_path / "a.mcap", "--seed", "1", "--json") == 1
    said = json.loads(capsys.readouterr().out)
    assert (said["status"], said["believed"], said["true"]) == ("goal_unachievable", False, False)
    assert said["anchor"] is not None
    assert list(said["conjuncts"]) == ["purple"]
    assert said["conjuncts"]["purple"] < THRESHOLD
    assert sorted(said["regions"]) == list(REGIONS)


def test_it_does_not_spin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every region is looked at, none more often than it has something new to show; then it ends, once."""
    trace = tmp_path / "a.mcap"
    assert run(monkeypatch, trace) == 1
    rows = [action.op for action in Trace(trace).of(Action)]
    looked = [row.removeprefix("LookAtRegion(").rstrip(")") for row in rows if row.startswith("LookAtRegion(")]
    assert list(dict.fromkeys(looked)) == list(REGIONS)
    assert len(rows) <= 12
    causes = [plan.cause for plan in Trace(trace).of(Plan)]
    assert (causes[-1], causes.count("giveup")) == ("giveup", 1)
