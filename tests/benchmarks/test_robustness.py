"""The campaign of generated inputs in a short form, and its judge tried on commands that end badly."""

import json
import os
import signal
import time
from pathlib import Path
from random import Random

import pytest

from benchmarks.robustness import trying
from benchmarks.robustness.__main__ import BAD, campaign, drawn, page
from benchmarks.robustness.inputs import KINDS, ROOT, Case
from benchmarks.robustness.trying import ENDINGS, tried
from benchmarks.robustness.values import changed, garbled, places
from skolem.tools import cli

ROUNDS = 12  # of one input of each kind: the same in every run


def test_no_input_of_a_short_campaign_ends_badly(tmp_path: Path) -> None:
    counts = campaign(tmp_path / "state.json", seed=1, seconds=600, kinds=list(KINDS), rounds=ROUNDS)
    found = [json.loads(case.read_text()) for case in sorted(tmp_path.glob("found/*/case.json"))]
    assert (found, {ending: 0 for ending in BAD}) == ([], {e: sum(c[e] for c in counts.values()) for e in BAD})
    assert list(counts) == list(KINDS)


def test_a_described_neighbour_of_a_table_can_be_searched_for() -> None:
    """Found by the campaign."""
    goal = "exists o. B(Den(lambda x. exists y. (Near(x, y) & Near(y, table1)), o), 0.8)"
    scenario = (ROOT / "scenarios" / "occluded.yaml").read_bytes()
    options = ("--world", "symbolic", "-q", "--set", f"goal={goal}", "--max-steps", "2", "-o", "a.mcap")
    assert tried(Case(("run", "s.yaml", *options), {"s.yaml": scenario})).ending == "verdict"


def test_a_campaign_goes_on_where_it_was_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    state = tmp_path / "state.json"
    tries: list[Case] = []

    def kept(case: Case) -> trying.Tried:
        tries.append(case)
        return trying.Tried("verdict", 0, "")

    monkeypatch.setattr("benchmarks.robustness.__main__.tried", kept)
    monkeypatch.setattr(time, "monotonic", iter(range(100)).__next__)
    campaign(state, seed=7, seconds=2, kinds=["goals"])
    counts = campaign(state, seed=8, seconds=2, kinds=["goals"])  # it keeps its own seed
    assert tries == [drawn("goals", 7, number, tmp_path) for number in range(len(tries))]
    assert counts == {"goals": dict.fromkeys(ENDINGS, 0) | {"verdict": len(tries)}}
    assert f"| goals | {len(tries)} | {len(tries)} | 0 | 0 | 0 | 0 | 0 |" in page(counts, 7)


@pytest.mark.parametrize("kind", ["scenarios", "goals", "rule files", "command lines"])
def test_an_input_is_drawn_from_its_seed_and_number_alone(kind: str, tmp_path: Path) -> None:
    assert drawn(kind, 3, 5, tmp_path) == drawn(kind, 3, 5, tmp_path) != drawn(kind, 3, 6, tmp_path)


@pytest.mark.parametrize(
    ("main", "ending"),
    [
        (lambda: 0, "verdict"),
        (lambda: 1, "verdict"),
        (lambda: os.write(2, b"s.yaml: is wrong\n") and 2, "refused well"),
        (lambda: 2, "refused badly"),
        (lambda: os.write(2, b"\x1b[31mwrong\n") and 3, "refused badly"),
        (lambda: os.write(2, b"Traceback (most recent call last)\n") and 2, "refused badly"),
        (lambda: 4, "internal error"),
        (lambda: 1 // 0, "internal error"),
        (lambda: os.kill(os.getpid(), signal.SIGSEGV), "internal error"),
        (lambda: bytearray(3 << 29) and 0, "over 1 GB"),
    ],
)
def test_a_planted_fault_is_judged(main: object, ending: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "main", main)
    assert tried(Case((), {})).ending == ending


def test_a_command_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trying, "CPU_S", 1)

    def forever() -> int:
        while True:
            pass

    monkeypatch.setattr(cli, "main", forever)
    assert tried(Case((), {})).ending == "hang"


def test_changes_of_trees_and_texts_are_keyed_and_change_something() -> None:
    tree = {"a": [1.0, 2.0, {"b": "c"}], "d": {"e": 5}}
    assert list(places({"a": [1], "b": {}})) == [("a",), ("a", 0), ("b",)]
    assert changed(tree, Random("x"), 0.9) == changed(tree, Random("x"), 0.9)
    assert len({repr(changed(tree, Random(i), 0.9)) for i in range(50)}) > 25
    assert len({garbled("exists o. B(Green(o), 0.9)", Random(i)) for i in range(50)}) > 40
    assert tree == {"a": [1.0, 2.0, {"b": "c"}], "d": {"e": 5}}
