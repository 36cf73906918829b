"""Words: what the shipped ones mean, and how a user's own rule file adds and changes them."""

from pathlib import Path

import pytest

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.vocabulary import Vocabulary, comparison
from skolem.traces.errors import InputError
from skolem.traces.messages import HsvUnion, HsvVolume, ObjectType, TypeIs, WeightInterval


@pytest.fixture(scope="module")
def shipped() -> Rulebook:
    return Rulebook.load(Queries)


def with_own(tmp_path: Path, text: str) -> Rulebook:
    path = tmp_path / "own.lp"
    path.write_text(text, encoding="utf-8")
    return Rulebook.load(Queries, [path])


def test_a_type_has_a_shape_and_is_a_property(shipped: Rulebook) -> None:
    vocabulary = shipped.vocabulary
    assert vocabulary.types["soda"] == ObjectType(shape="cylinder", size_m=(0.066, 0.066, 0.115), graspable=True)
    assert not vocabulary.types["table"].graspable
    assert vocabulary.meanings["soda"] == TypeIs(type="soda")


def test_a_colour_is_a_volume(shipped: Rulebook) -> None:
    orange = HsvVolume(hue=(12 / 360, 42 / 360), saturation=(0.6, 1.0), value=(0.72, 1.0))
    assert shipped.vocabulary.meanings["orange"] == orange


def test_a_colour_with_several_facts_is_a_union_of_boxes(shipped: Rulebook) -> None:
    yellow = shipped.vocabulary.meanings["yellow"]
    assert isinstance(yellow, HsvUnion)
    assert [box.hue for box in yellow.boxes] == [(42 / 360, 62 / 360), (62 / 360, 76 / 360)]


def test_red_goes_through_hue_zero(shipped: Rulebook) -> None:
    red = shipped.vocabulary.meanings["red"]
    assert isinstance(red, HsvUnion)
    assert (345 / 360, 12 / 360) in [box.hue for box in red.boxes]


def test_heavy_is_an_interval_without_end(shipped: Rulebook) -> None:
    assert shipped.vocabulary.meanings["heavy"] == WeightInterval(at_least_kg=0.4, below_kg=None)
    assert shipped.vocabulary.meanings["light"] == WeightInterval(at_least_kg=0.0, below_kg=0.4)


def test_words_of_goals_and_their_numbers_of_arguments(shipped: Rulebook) -> None:
    words = shipped.vocabulary.words()
    assert {word: words[word] for word in ("Green", "Soda", "Heavy", "On", "In")} == {
        "Green": 1,
        "Soda": 1,
        "Heavy": 1,
        "On": 2,
        "In": 2,
    }


def test_shipped_colours_do_not_overlap(shipped: Rulebook) -> None:
    assert shipped.warnings == ()


def test_a_user_adds_words_by_a_rule_file_alone(tmp_path: Path) -> None:
    own = "type(soda_box). box(soda_box, 89, 54, 118). graspable(soda_box). colour(teal, 165, 195, 40, 100, 20, 100)."
    vocabulary = with_own(tmp_path, own).vocabulary
    assert vocabulary.types["soda_box"] == ObjectType(shape="box", size_m=(0.089, 0.054, 0.118), graspable=True)
    assert vocabulary.words()["SodaBox"] == vocabulary.words()["Teal"] == 1


def test_a_users_fact_replaces_the_shipped_one(tmp_path: Path) -> None:
    vocabulary = with_own(tmp_path, "weight(heavy, 300, any). box(soda, 66, 66, 115).").vocabulary
    assert vocabulary.meanings["heavy"] == WeightInterval(at_least_kg=0.3, below_kg=None)
    assert vocabulary.types["soda"].shape == "box"


def test_a_users_one_box_replaces_all_shipped_boxes_of_the_word(tmp_path: Path) -> None:
    own = with_own(tmp_path, "colour(green, 87, 161, 20, 100, 15, 100).")
    box = HsvVolume(hue=(87 / 360, 161 / 360), saturation=(0.2, 1.0), value=(0.15, 1.0))
    assert own.vocabulary.meanings["green"] == box


def test_overlapping_colours_are_a_warning_with_its_place(tmp_path: Path) -> None:
    book = with_own(tmp_path, "\ncolour(rust, 355, 30, 50, 100, 30, 70).")
    found = [(fault.line, fault.message.removeprefix("warning: ")) for fault in book.warnings]
    assert sorted(found) == [
        (2, "the colours brown and rust overlap"),
        (2, "the colours red and rust overlap"),
    ]
    assert {fault.file for fault in book.warnings} == {str(tmp_path / "own.lp")}


def test_rules_know_which_quantity_a_word_is_about(shipped: Rulebook) -> None:
    measures = shipped.solve([], None, ["vocabulary"]).atoms["measures"]
    assert {("green", "colour"), ("soda", "type"), ("heavy", "weight")} <= set(measures)
    assert sorted(str(word) for word, _ in measures) == list(shipped.vocabulary.meanings)


def test_words_are_sorted_whatever_the_order_of_facts(tmp_path: Path) -> None:
    vocabulary: Vocabulary = with_own(tmp_path, "weight(airy, 0, 1).").vocabulary
    assert list(vocabulary.meanings) == sorted(vocabulary.meanings)


@pytest.mark.parametrize(
    ("thousandths", "name"),
    [
        (400_000, "heavier_than_400"),
        (500, "heavier_than_0_5"),
        (-1_250, "heavier_than_minus_1_25"),
        (0, "heavier_than_0"),
    ],
)
def test_a_comparison_has_a_name_that_no_word_can_have(tmp_path: Path, thousandths: int, name: str) -> None:
    assert comparison("heavier_than", thousandths) == name
    with pytest.raises(InputError, match="expected a word in lower case"):
        with_own(tmp_path, f"weight({name}, 1, any).")
