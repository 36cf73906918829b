"""Lines on a terminal and elsewhere."""

import sys

import pytest
from hypothesis import given, strategies as st

from skolem.tools.words.terminal import say, wrapped

LONG = "    plan for P(sodaC is the green thing) >= .9: look at sodaC (level 0 of 1); [conclude that sodaC is green]"


def test_what_goes_to_a_file_is_never_wrapped(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    say([LONG, "a\x1bb"])
    assert capsys.readouterr().out.splitlines() == [LONG, r"a\x1bb"]


def test_on_a_terminal_lines_are_wrapped_between_words_with_a_hanging_indent(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    say([LONG, "short"])
    first, *rest, last = capsys.readouterr().out.splitlines()
    assert first.startswith("    plan for")
    assert all(line.startswith("        ") for line in rest)
    assert last == "short"


@given(st.lists(st.text("ab(=).", min_size=1, max_size=12), min_size=1), st.integers(0, 30), st.integers(40, 120))
def test_wrapping_keeps_every_word_and_the_width(words: list[str], indent: int, width: int) -> None:
    line = " " * indent + " ".join(words)
    parts = wrapped(line, width)
    assert " ".join(parts).split() == line.split()
    assert all(len(part) <= width for part in parts)
