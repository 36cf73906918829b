"""`skolem rules`: what is printed for people and machines, and the exit status."""

import json
from pathlib import Path
from shutil import copytree

import pytest
from typer.testing import CliRunner, Result

from skolem.reasoner.queries import Queries
from skolem.reasoner.rule_docs import reference
from skolem.reasoner.rulebook import Rulebook
from skolem.tools.rules import app

ROOT = Path(__file__).parent.parent
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
    assert "own.lp:1:1: warning: wipe has no result: it is never taken [without_result]" in result.stdout
    (tmp_path / "wrong.lp").write_text("precond(S, krd(O)) :- stepp(S), S = wipe(O).\n")
    result = called("check", tmp_path)
    assert result.exit_code == 2
    assert "error: stepp/1 is never defined; did you mean step/1?" in result.stdout


def test_machines_get_one_object_per_complaint(tmp_path: Path) -> None:
    (tmp_path / "own.lp").write_text(DOUBTFUL)
    rows = [json.loads(line) for line in called("check", tmp_path, "--json").stdout.splitlines()]
    assert {row["severity"] for row in rows} == {"warning", "allowed"}
    (own,) = (row for row in rows if row["severity"] == "warning")
    assert (own["file"], own["line"], own["column"]) == (str(tmp_path / "own.lp"), 1, 1)
    assert own["code"] == "without_result"
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
