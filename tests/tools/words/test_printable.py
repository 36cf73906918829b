"""What comes from files is printed by one function, and has no power over terminals, tables and reports."""

import ast
import csv
import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from kit.places import ROOT, SCENARIOS
from kit.recordings import recorded
from kit.tampering import each, rewrite
from mcap.records import Channel, Message, Metadata

from skolem.tools import cli
from skolem.tools.words.printable import cell, markdown, printable, printable_lines

HOSTILE = (
    "\x1b]0;owned\x07\x1b[2J",
    "\u202egnp.exe\u202c",
    "a\u2028b\u200b\ufeff\x9b31m",
    "=HYPERLINK('x')",
    "<script>alert(1)</script>",
    "| a | `b` [c](javascript:d)",
    "\x00\x7f\r\x08",
)
BY_ITSELF = {"tools/words/terminal.py"}  # prints for all others
DRAWN = {"tools/explain/command.py", "tools/sweep/progress.py", "tools/words/live.py"}  # with rich, on a terminal


def around(path: Path) -> Iterator[str]:
    """Yield the calls in a module that print without making text printable."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            said = ast.unparse(node.func)
            if said in ("print", "sys.stdout.write", "sys.stderr.write", "traceback.print_exception", "typer.echo"):
                yield said
            if said == "Console" and path.relative_to(ROOT).as_posix() not in DRAWN:
                yield said


def test_nothing_prints_around_the_one_function() -> None:
    files = [
        path for path in sorted((ROOT / "tools").rglob("*.py")) if path.relative_to(ROOT).as_posix() not in BY_ITSELF
    ]
    assert {path.relative_to(ROOT).as_posix(): found for path in files if (found := list(around(path)))} == {}


@pytest.mark.parametrize("text", HOSTILE)
def test_a_printed_text_has_only_characters_that_are_shown(text: str) -> None:
    assert printable(text).isprintable()
    assert printable_lines(f"{text}\n{text}").count("\n") == 1


@pytest.mark.parametrize("text", [*HOSTILE, "+1+1", "-2-3", "@SUM(A1)", "\t=1", "=1,2\n=3"])
def test_a_cell_is_no_formula_and_comes_back_in_one_piece(text: str) -> None:
    stream = io.StringIO()
    csv.writer(stream).writerow([cell(text)])
    (row,) = csv.reader(io.StringIO(stream.getvalue()))
    assert row[0][:1] not in ("=", "+", "-", "@", "\t", "\r")
    assert len(row) == 1


@pytest.mark.parametrize("number", ["-1", "+2.5", "1e-3", "-0.5e+10", ""])
def test_a_number_stays_a_number_in_a_cell(number: str) -> None:
    assert cell(number) == number


@pytest.mark.parametrize("text", HOSTILE)
def test_markdown_takes_nothing_for_a_mark(text: str) -> None:
    assert not set("<>|`[]*\\") & set(markdown(text).replace("\\x", "").replace("\\u", "").replace("\\r", ""))


def said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Return the exit status of a command, and everything that it prints."""
    monkeypatch.setattr("sys.argv", ["skolem", *arguments])
    status = cli.main()
    out, err = capsys.readouterr()
    return status, out + err


def shown(text: str) -> bool:
    return all(line.isprintable() for line in text.split("\n"))


@pytest.mark.parametrize("place", ["id: sodaE", "name: sim1_green", "type: soda", "goal: exists", "seed: 0", "world:"])
def test_names_in_a_scenario_reach_no_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], place: str
) -> None:
    text = (SCENARIOS / "sim1_green.yaml").read_text(encoding="utf-8")
    assert place in text
    for name in HOSTILE:
        key, _, value = place.partition(":")
        quoted = '"' + name.encode("unicode_escape").decode().replace('"', '\\"') + value + '"'
        path = tmp_path / "a.yaml"
        path.write_text(text.replace(place, f"{key}: {quoted}" if value else f"{quoted}:", 1), encoding="utf-8")
        for verb in (("scenario", "check"), ("run", "--world", "symbolic", "-q", "-o", str(tmp_path / "a.mcap"))):
            status, printed = said(monkeypatch, capsys, *verb, str(path))
            assert status in (0, 1, 2)
            assert shown(printed)


@pytest.mark.parametrize("name", HOSTILE)
def test_names_in_a_rule_file_reach_no_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    path = tmp_path / "own.lp"
    path.write_text(f'wait("{name}", 1). % {name}\n% allow {name}: x\n{name}(1).', encoding="utf-8", newline="")
    status, printed = said(monkeypatch, capsys, "rules", "check", str(path))
    assert status == 2
    assert shown(printed)


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("what", ["topic", "metadata", "text"])
def test_names_in_a_trace_reach_no_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], what: str, name: str
) -> None:
    changes = {
        "topic": each(Channel, lambda c: replace(c, topic=name) if c.topic == "/plan" else c),
        "metadata": each(Metadata, lambda m: replace(m, metadata={key: name for key in m.metadata})),
        "text": each(Message, lambda m: replace(m, data=m.data.replace(b"sodaE", name.encode()))),
    }
    bad = rewrite(recorded("sim1_green"), tmp_path / "bad.mcap", changes[what])
    for verb in ("check", "info", "show", "replay", "explain", "reproduce"):
        status, printed = said(monkeypatch, capsys, verb, str(bad))
        assert status in (0, 1, 2, 3), (verb, printed)
        assert shown(printed)
