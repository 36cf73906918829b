"""`skolem rules`: what is printed for people and machines, and the exit status."""

import json
from pathlib import Path
from shutil import copytree

import pytest
from kit.places import ROOT
from typer.testing import CliRunner, Result

from skolem.reasoner.lint.docs import reference
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.tools.rules.command import app

DOUBTFUL = "step(wipe(O)) :- goal(holding(O)).\n"


def called(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)))


def test_the_shipped_rules_pass_with_the_allowances_they_explain() -> None:
    result = called("check")
    assert result.exit_code == 0
    assert "warning" not in result.stdout


def test_a_folder_with_every_shipped_name_is_a_set_of_rules_by_itself(tmp_path: Path) -> None:
    rules = tmp_path / "rules"
    copytree(ROOT / "rules", rules)
    (rules / "weigh.lp").write_text((rules / "weigh.lp").read_text().replace("held(right", "heldd(right"))
    assert called("check", ROOT / "rules").exit_code == 0
    result = called("check", rules)
    assert result.exit_code == 2
    assert f"{rules}/weigh.lp:12:1: error: heldd is not a fluent" in result.stdout


def test_warnings_alone_are_told_from_faults_by_the_exit_status(tmp_path: Path) -> None:
    (tmp_path / "own.lp").write_text(DOUBTFUL)
    result = called("check", tmp_path)
    assert result.exit_code == 1
    assert "own.lp:1:1: warning: wipe has no result: it is never taken; state what it does by" in result.stdout
    assert "[without_result]" in result.stdout
    (tmp_path / "wrong.lp").write_text("precond(S, krd(O)) :- stepp(S), S = wipe(O).\n")
    result = called("check", tmp_path)
    assert result.exit_code == 2
    assert "error: stepp/1 is never defined; did you mean step/1?" in result.stdout


HIDING = """step(push(O)) :- goal(b(on(O, S), _)), not goal(krd(O)), @rigid(S) = 1.
executes(S, look(O)) :- step(S), S = push(O).
result(S, b(on(O, T), P)) :- step(S), S = push(O), goal(b(on(O, T), _)).
precond(S, krd(O), 0) :- step(S), S = push(O).
precond(S, loose(O), 2) :- step(S), S = push(O).
step(wipe(O)) :- goal(holding(O)).
colour(glossy, 400, 20, 40, 100, 20, 100).
type(mug, a, b, c, d, e).
"""


def test_no_fault_hides_another_nor_what_is_doubtful_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "own.lp"
    path.write_text(HIDING)
    result = called("check", path)
    assert result.exit_code == 2
    for place, words in (
        ("1:1: warning", "push has no precondition of level 1"),
        ("1:44: error", "goal/1 may not stand under 'not', in an aggregate or in a condition; derive a predicate"),
        ("3:23: error", "unsafe variable P"),
        ("6:1: warning", "wipe has no result"),
        ("7:16: error", "colour glossy: expected a hue from 0 to 360 degrees, found 400; 400 degrees are 40"),
        ("8:1: error", "type/6 is never used; did you mean type/1?"),
    ):
        assert f"{path}:{place}: {words}" in result.stdout
    counts, last = result.stdout.splitlines()[-2:]
    assert counts.startswith("4 errors, 2 warnings")
    assert last == "more may follow once these are mended"


def test_nothing_is_said_that_would_not_hold_once_the_faults_are_mended(tmp_path: Path) -> None:
    path = tmp_path / "own.lp"
    path.write_text("step(push(O)) :- goal(b(on(O, S), _)).\nreslut(S, holding(O)) :- stepp(S), S = push(O).\n")
    rows = [json.loads(line) for line in called("check", path, "--json").stdout.splitlines()]
    assert [row["message"].partition(";")[0] for row in rows if row["file"] == str(path)] == [
        "reslut/2 is never used",
        "stepp/1 is never defined",
    ]
    assert not any(row["complete"] for row in rows)
    path.write_text(
        "step(push(O)) :- goal(b(on(O, S), _)).\nresult(S, holding(O)) :- step(S), S = push(O\ntype(mug).\n"
    )
    rows = [json.loads(line) for line in called("check", path, "--json").stdout.splitlines()]
    assert [(row["line"], row["code"]) for row in rows if row["file"] == str(path)] == [(3, "refused")]


def test_a_file_that_cannot_be_read_hides_nothing_of_the_others(tmp_path: Path) -> None:
    (tmp_path / "own.lp").write_text("result(S, holdin(O)) :- step(S), S = look(O), told(O).\n")
    result = called("check", tmp_path / "own.lp", tmp_path / "missing.lp")
    assert result.exit_code == 2
    assert "told/1" not in result.stdout.replace("told(O)", "")
    assert "own.lp:1:1: error: holdin is not a fluent" in result.stdout
    assert "missing.lp: error: cannot be read" in result.stdout


def test_machines_get_one_object_per_complaint(tmp_path: Path) -> None:
    (tmp_path / "own.lp").write_text(DOUBTFUL)
    rows = [json.loads(line) for line in called("check", tmp_path, "--json").stdout.splitlines()]
    assert {row["severity"] for row in rows} == {"warning", "allowed"}
    (own,) = (row for row in rows if row["severity"] == "warning")
    assert (own["file"], own["line"], own["column"]) == (str(tmp_path / "own.lp"), 1, 1)
    assert own["code"] == "without_result"
    assert own["complete"]
    assert all(row["allowed"] for row in rows if row["severity"] == "allowed")


def test_a_warning_about_words_is_a_complaint_too(tmp_path: Path) -> None:
    (tmp_path / "own.lp").write_text("colour(rose, 330, 350, 40, 100, 20, 100).\n")
    result = called("check", tmp_path / "own.lp")
    assert result.exit_code == 1
    assert "warning: the colours pink and rose overlap [words]" in result.stdout


@pytest.mark.parametrize("name", ["missing.lp", ""])
def test_a_file_that_is_not_there_and_an_empty_folder_are_faults(tmp_path: Path, name: str) -> None:
    assert called("check", tmp_path / name if name else tmp_path).exit_code == 2


def test_the_reference_is_printed_or_written(tmp_path: Path) -> None:
    page = reference(Rulebook.load(Queries))
    assert called("doc").stdout == page
    assert called("doc", "-o", tmp_path / "page.md").exit_code == 0
    assert (tmp_path / "page.md").read_text() == page
    assert set(json.loads(called("doc", "--json").stdout)) == {"files", "fluents", "words", "queries"}
