"""Colour words: every colour has exactly one, and rule files that leave gaps or make overlaps hear of it."""

from itertools import product
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.traces.errors import InputError
from skolem.traces.messages import ColourMeaning

SHIPPED = Rulebook.load(Queries)
COLOURS = {word: each for word, each in SHIPPED.vocabulary.meanings.items() if isinstance(each, ColourMeaning)}
# The colours of the shipped scenarios, with the words of their comments.
OF_SCENARIOS = {
    "red": (0.99, 0.9, 0.8),
    "blue": (0.63, 0.9, 0.8),
    "green": (0.33, 0.9, 0.8),
    "yellow": (0.14, 0.7, 0.8),  # oil
    "brown": (0.083, 0.46, 0.65),  # tables and desks
}
TRIPLES = st.tuples(*[st.floats(0.0, 1.0)] * 3)


def words_of(hsv: tuple[float, float, float]) -> list[str]:
    return [word for word, meaning in COLOURS.items() if meaning.contains(hsv)]


def messages(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "own.lp"
    path.write_text(text, encoding="utf-8")
    return [warning.message for warning in Rulebook.load(Queries, [path]).warnings]


def test_every_colour_of_a_grid_has_exactly_one_word() -> None:
    """The grid has the faces of all boxes that are multiples of 3 degrees and 4 percent, and the ends of each range."""
    levels = [k / 100 for k in range(0, 101, 4)]
    grid = product([k / 360 for k in range(0, 361, 3)], levels, levels)
    assert [hsv for hsv in grid if len(words_of(hsv)) != 1] == []


@given(TRIPLES)
def test_every_colour_has_exactly_one_word(hsv: tuple[float, float, float]) -> None:
    assert len(words_of(hsv)) == 1


def test_every_corner_of_every_box_has_exactly_one_word() -> None:
    boxes = [box for meaning in COLOURS.values() for box in meaning.boxes]
    corners = {corner for box in boxes for corner in product(box.hue, box.saturation, box.value)}
    assert [corner for corner in sorted(corners) if len(words_of(corner)) != 1] == []


def test_at_most_forty_boxes_cover_all_colours() -> None:
    assert sum(len(meaning.boxes) for meaning in COLOURS.values()) <= 40
    assert SHIPPED.warnings == ()


@pytest.mark.parametrize(("word", "hsv"), OF_SCENARIOS.items())
def test_colours_of_the_shipped_scenarios_are_called_as_there(word: str, hsv: tuple[float, float, float]) -> None:
    assert words_of(hsv) == [word]


@given(TRIPLES)
def test_a_colour_without_colour_is_black_grey_or_white_whatever_its_hue(hsv: tuple[float, float, float]) -> None:
    assert set(words_of((hsv[0], hsv[1] * 0.19, hsv[2]))) <= {"black", "grey", "white"}


def test_a_planted_gap_is_told_with_its_place(tmp_path: Path) -> None:
    """Also where colours are dark or pale; the box of white ends at a saturation of 15 % instead of 20 %."""
    assert messages(tmp_path, "colour(white, 0, 360, 0, 15, 80, 100).") == [
        "warning: no colour for hue 0 to 360 degrees, saturation 15 to 20 %, value 80 to 100 %"
    ]
    assert messages(tmp_path, "colour(black, 0, 360, 0, 100, 5, 15).") == [
        "warning: no colour for hue 0 to 360 degrees, saturation 0 to 100 %, value 0 to 5 %"
    ]


def test_a_gap_that_wraps_through_hue_zero_is_told_at_the_users_own_fact(tmp_path: Path) -> None:
    path = tmp_path / "own.lp"
    path.write_text("\ncolour(pink, 304, 345, 20, 100, 79, 100).\n", encoding="utf-8")
    found = Rulebook.load(Queries, [path]).warnings
    assert [(each.file, each.line) for each in found] == [(str(path), 2)] * 2
    assert [each.message for each in found] == [
        "warning: no colour for hue 345 to 360 degrees, saturation 20 to 60 %, value 72 to 100 %",
        "warning: no colour for hue 0 to 12 degrees, saturation 20 to 60 %, value 72 to 100 %",
    ]


def test_many_gaps_are_summed_up(tmp_path: Path) -> None:
    *_, last = found = messages(tmp_path, "colour(green, 100, 110, 50, 60, 50, 60).")
    assert len(found) == 6
    assert "more places; together" in last


def test_a_planted_overlap_of_dark_colours_is_told(tmp_path: Path) -> None:
    assert messages(tmp_path, "colour(navy, 200, 240, 50, 100, 10, 30).") == [
        "warning: the colours black and navy overlap",
        "warning: the colours blue and navy overlap",
    ]


def test_boxes_of_one_word_share_no_colour(tmp_path: Path) -> None:
    """Their probabilities are added."""
    text = "colour(teal, 170, 190, 40, 100, 20, 100). colour(teal, 185, 200, 40, 60, 20, 40)."
    with pytest.raises(InputError, match=r"colour\(teal,185,.*overlaps colour\(teal,170,.*share no colour"):
        messages(tmp_path, text)


def test_boxes_of_one_word_may_touch(tmp_path: Path) -> None:
    found = messages(tmp_path, "colour(teal, 170, 190, 40, 100, 20, 100). colour(teal, 190, 200, 40, 100, 20, 100).")
    assert {message.partition(":")[2] for message in found} == {
        " the colours blue and teal overlap",
        " the colours teal and turquoise overlap",
    }
