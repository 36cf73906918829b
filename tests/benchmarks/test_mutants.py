"""The mutation check's own ground: what is drawn, that a mutant is what everybody calls, and how a mutant may end."""

import os
import time
from pathlib import Path

import numpy as np
import pytest
from kit.places import ROOT

from benchmarks.mutants import drawing
from benchmarks.mutants.checking import apart, rows, said, summary
from benchmarks.mutants.drawing import Mutant, drawn
from benchmarks.mutants.forking import Ended, allow, in_fork, put_in
from skolem.estimation.se2 import compose, exp

SMALL = '''"""A module."""

LIMIT = 3


def chosen(x: "int", y: int = 4) -> "bool":
    """Return a choice."""
    if (
        x < y
    ):
        return not x
    return x + LIMIT == 7
'''
SE2 = "estimation/se2.py"


def changed(before: str, after: str, name: str = "") -> Mutant:
    """Return a mutant of the module of poses; `name` tells those apart that change the same line."""
    text = (ROOT / SE2).read_text(encoding="utf-8")
    line = text[: text.index(before)].count("\n") + 1
    return Mutant("estimation", SE2, line, 0, (line, line), before, name or after, text.replace(before, after, 1))


def test_bodies_of_functions_are_changed_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "small.py").write_text(SMALL, encoding="utf-8")
    monkeypatch.setattr(drawing, "ROOT", tmp_path)
    mutants = drawn("room", 99, seed=0)
    assert [(m.path, m.line, m.lines, m.before, m.after) for m in mutants] == [
        ("room/small.py", 9, (8, 10), "< y", "<= y"),
        ("room/small.py", 11, (11, 11), "not x", "x"),
        ("room/small.py", 12, (12, 12), "x + LIMIT", "x - LIMIT"),
        ("room/small.py", 12, (12, 12), "== 7", "!= 7"),
        ("room/small.py", 12, (12, 12), "7", "8"),
    ]
    for mutant in mutants:
        assert len({*SMALL.splitlines()} - {*mutant.source.splitlines()}) == 1
    assert drawn("room", 2, seed=0) == drawn("room", 2, seed=0) != drawn("room", 2, seed=1)


def test_a_function_is_changed_for_whoever_took_it_by_name_and_only_in_the_fork() -> None:
    mutant = changed("a * x - b * y, b * x + a * y", "a * x, b * x")

    def moved() -> float:
        put_in(mutant)
        return exp_of_a_quarter()

    there = exp_of_a_quarter()
    assert in_fork(moved) == 0.0
    assert exp_of_a_quarter() == there == compose((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))[0]


def exp_of_a_quarter() -> float:
    """Return how far a step to the left and then forward leads ahead."""

    return exp(np.array([0.0, 1.0, 0.0]))[1]


def test_a_change_that_is_nowhere_in_the_program_is_no_mutant() -> None:
    with pytest.raises(LookupError, match=r"estimation/se2.py:\d+: no function has the changed code"):
        put_in(changed('"""Rigid motion', '"""XRigid motion'))


def test_a_fork_that_loops_is_stopped_and_one_that_dies_is_told_of() -> None:
    def forever() -> None:
        allow(0.1)
        while True:
            pass

    assert in_fork(forever) == Ended("timeout")
    assert in_fork(lambda: time.sleep(600.0), wait_s=0.1) == Ended("timeout")
    assert in_fork(lambda: os._exit(3)) == Ended("crashed")


def test_mutants_are_killed_survive_or_are_not_run_at_all_and_are_not_checked_twice(tmp_path: Path) -> None:
    out = tmp_path / "mutants.jsonl"
    mutants = [
        changed("a * x - b * y", "a * x + b * y"),
        changed("a * x - b * y", "-b * y + a * x", name="the same sum"),
        changed("return compose(inverse(w_T_a), w_T_b)", "return None"),
        changed("d = a * a + b * b", "d = 1 / 0"),
    ]
    tests = ["tests/estimation/test_se2.py::test_log_undoes_exp"]
    for _ in range(2):
        apart("room", tests, mutants, out)
    assert [row["outcome"] for row in rows(out)] == ["killed", "survived", "uncovered", "killed"]
    assert {row["by"] for row in rows(out)} == {"", *tests}
    lines = summary([*rows(out), said("replays", mutants[1]) | {"outcome": "killed"}]).splitlines()
    assert lines[2] == "| estimation | 4 | 2 | 1 | 1 | 50% | 75% |"
    assert lines[4:] == [f"{SE2}:{mutants[2].line}: {mutants[2].before} -> return None (uncovered)"]
