"""Rule files examined at once: what a fault concerns is set aside, and what may be missing because of it is known."""

from pathlib import Path

import pytest

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import rule_files
from skolem.reasoner.rulebook.examination import Doubt, Examined, examine


def examined(folder: Path, text: str) -> Examined:
    path = folder / "own.lp"
    path.write_text(text, encoding="utf-8")
    sources, unread = rule_files([path])
    assert not unread
    return examine(sources, Queries)


def test_rules_without_a_fault_leave_no_doubt(tmp_path: Path) -> None:
    found = examined(tmp_path, "weight(airy, 0, 1).")
    assert (found.faults, bool(found.doubt)) == ((), False)
    assert "airy" in found.vocabulary.meanings


@pytest.mark.parametrize(
    ("text", "uncertain"),
    [
        ("precond(S, krd(O)) :- step(S), S = look(O).", {("precond", 3)}),
        ("rejected(S, whim) :- stepp(S).", {("stepp", 1)}),
        ("{ rejected(S, whim) } :- step(S).", {("rejected", 2)}),
        (":- step(pour(_)).", set()),
    ],
    ids=["misspelt head", "misspelt body", "refused head", "no head"],
)
def test_what_may_be_missing_because_of_a_fault_is_known(
    tmp_path: Path, text: str, uncertain: set[tuple[str, int]]
) -> None:
    found = examined(tmp_path, text)
    assert len(found.faults) == 1
    assert found.doubt.uncertain == uncertain


def test_a_file_that_does_not_parse_leaves_everything_in_doubt_but_is_read_where_it_does(tmp_path: Path) -> None:
    found = examined(tmp_path, "weight(airy, 0, 1).\nweight(dense, 5 6).\nweight(dull, 5, -6).")
    assert [(fault.line, fault.column) for fault in sorted(found.faults)] == [(2, 17), (3, 17)]
    assert found.doubt.about([("anything", 1)])
    assert "airy" in found.vocabulary.meanings


def test_rules_that_clingo_cannot_ground_hide_no_word_of_the_others(tmp_path: Path) -> None:
    found = examined(tmp_path, "rejected(S, N) :- step(S).\nweight(airy, 0, 1).\nweight(dull, 6, 5).")
    assert [fault.message.partition(":")[0] for fault in sorted(found.faults)] == [
        "unsafe variable N",
        "weight dull",
    ]
    assert "airy" in found.vocabulary.meanings


@pytest.mark.parametrize(("text", "column"), [("weight(groß, 5, 6).", 11), ("weight(airy,\u00a05, 6).", 13)])
def test_letters_that_clingo_cannot_take_are_named_but_in_comments_and_texts(
    tmp_path: Path, text: str, column: int
) -> None:
    (fault,) = examined(tmp_path, f"% schön\n{text}").faults
    assert (fault.line, fault.column) == (2, column)
    assert "is not ASCII" in fault.message


@pytest.mark.parametrize(("hues", "faults"), [("360, 0", 1), ("40, 40", 1), ("0, 360", 0), ("350, 10", 0)])
def test_a_colour_without_a_hue_is_a_fault(tmp_path: Path, hues: str, faults: int) -> None:
    assert len(examined(tmp_path, f"colour(odd, {hues}, 40, 100, 20, 100).").faults) == faults


def test_doubt_is_about_the_predicates_it_names() -> None:
    doubt = Doubt(uncertain=frozenset({("result", 2)}))
    assert doubt.about([("step", 1), ("result", 2)])
    assert not doubt.about([("step", 1)])
    assert not Doubt().about([("result", 2)])
