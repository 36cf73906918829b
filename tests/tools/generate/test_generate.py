"""The verb `generate`, and families in a sweep: files that are sound, answers that no robot reads."""

import json
import sys
from pathlib import Path

import pytest
from kit.drawn_worlds import world_of

from skolem.sim.families.ranges import FAMILIES
from skolem.tools import cli
from skolem.tools.loop.families import drawn_text
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Belief, Decision, Plan, RunEnd


def called(monkeypatch: pytest.MonkeyPatch, *args: str) -> int:
    """Run the command in this process and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["skolem", *args])
    return cli.main()


def test_a_generated_file_is_what_is_printed_and_passes_the_check(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "new" / "three.yaml"
    assert called(monkeypatch, "generate", "three", "--seed", "5") == 0
    printed = capsys.readouterr().out
    assert called(monkeypatch, "generate", "three", "--seed", "5", "-o", str(out)) == 0
    assert out.read_text() == printed == drawn_text("three", 5)
    assert called(monkeypatch, "scenario", "check", str(out)) == 0


def test_an_existing_file_is_replaced(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    out = tmp_path / "three.yaml"
    out.write_text("before")
    assert called(monkeypatch, "generate", "three", "-o", str(out)) == 0
    assert out.read_text() == drawn_text("three", 0)
    assert [path.name for path in tmp_path.iterdir()] == ["three.yaml"]


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["generate", "thre"], "no family 'thre'; did you mean 'three'?"),
        (["generate", "three", "--bound", "0.995"], "--bound: expected a probability above 0, at most 0.99"),
        (["generate", "three", "-o", "/proc/three.yaml"], "/proc/three.yaml: cannot be written"),
        (["sweep", "--family", "thre", "-o", "OUT"], "no family 'thre'; did you mean 'three'?"),
        (["sweep", "-o", "OUT"], "give scenario files or --family"),
        (["sweep", "--family", "three", "--family", "three", "-o", "OUT"], "'three' was given already"),
        (["sweep", "scenarios/sim1_green.yaml", "--bound", "0.9", "-o", "OUT"], "give --family, or change the goal"),
    ],
)
def test_bad_input_exits_with_2_and_names_the_remedy(
    args: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert called(monkeypatch, *(str(tmp_path / "out") if arg == "OUT" else arg for arg in args)) == 2
    assert said in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_every_family_names_its_world_as_a_run_of_it_is_named(family: str) -> None:
    assert world_of(family, 0).scenario.name == family


def test_a_family_is_swept_without_files_and_once_only(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    args = ["sweep", "--family", "three", "--seeds", "0-1", "--world", "symbolic", "--set", "limits.steps=1"]
    args += ["--workers", "1", "-o", str(tmp_path), "--json", "-q"]
    called(monkeypatch, *args)
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(row["scenario"], row["seed"], row["own"]) for row in rows] == [("three", 0, False), ("three", 1, False)]
    answers = [world_of("three", seed).scenario.expect for seed in (0, 1)]
    assert [row["expected"] for row in rows] == [answer.status for answer in answers if answer]
    text = (tmp_path / "summary.md").read_text()
    assert "2 worlds, each with a goal and an answer." in text
    assert "| achieved, of the achievable | 0 of " in text
    assert "`skolem sweep --family three --seeds 0-1 --world symbolic --set limits.steps=1 -o DIR`" in text
    monkeypatch.setattr("skolem.tools.sweep.task.perform", None)
    called(monkeypatch, *args)
    assert [json.loads(line)["seed"] for line in capsys.readouterr().out.splitlines()] == [0, 1]


def test_the_answer_of_a_scenario_changes_no_decision(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Two scenarios that differ in `expect` alone: what is believed, planned and done is the same."""
    drawn = drawn_text("three", 0)
    without = drawn.partition("\nexpect:")[0] + "\n"
    lying = f"{without}expect:\n  status: goal_unachievable\n"
    traces = []
    for name, text in [("with", drawn), ("without", without), ("lying", lying)]:
        (tmp_path / f"{name}.yaml").write_text(text)
        trace = tmp_path / f"{name}.mcap"
        args = ["run", str(tmp_path / f"{name}.yaml"), "--world", "symbolic", "--set", "limits.steps=4", "-q"]
        assert called(monkeypatch, *args, "-o", str(trace)) in (0, 1)
        traces.append(Trace(trace))
    kinds = (Belief, Plan, Decision, Action, RunEnd)
    first, *others = [[list(trace.of(kind)) for kind in kinds] for trace in traces]
    assert len(first[3]) == 4
    assert others == [first, first]
