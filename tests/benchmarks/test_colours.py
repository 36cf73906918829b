"""The boxes of colour words: fitted by a script, and as good as the rules say."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from benchmarks.colour_boxes import CUBE, CUT, FEW, LEAVES, Named, called, fit
from benchmarks.colours import BOXES, RIGHT, RIGHT_OF_WORD, VOCABULARY, WORDS, by_boxes, facts, rates, survey


def test_the_vocabulary_has_the_boxes_that_the_script_fits() -> None:
    assert facts(fit(survey())) in VOCABULARY.read_text(encoding="utf-8")


def test_the_survey_has_the_colours_whose_name_ends_in_a_word() -> None:
    named = survey()
    assert len(named.word) == 584
    assert {WORDS[i] for i in named.word} == set(WORDS)


def test_boxes_fitted_to_the_others_call_a_colour_as_people_do() -> None:
    found = rates(survey(), by_boxes(LEAVES))
    assert found["all"] >= RIGHT
    assert found["mean"] >= RIGHT_OF_WORD
    assert len(fit(survey())) <= BOXES


@pytest.mark.parametrize("leaves", [1, 7, 28])
def test_boxes_cover_every_colour_once(leaves: int) -> None:
    """Their volumes add up to that of all colours, and each of many colours is in one."""
    boxes = fit(survey(), leaves)
    sizes = [np.prod(np.subtract(box[1::2], box[::2])) for _, box in boxes]
    assert sum(sizes) == np.prod(np.subtract(CUBE[1::2], CUBE[::2]))
    hsv = np.random.default_rng(3).uniform((0, 0, 0), (360, 100, 100), size=(5000, 3))
    assert (called(boxes, Named(hsv, np.zeros(len(hsv), dtype=np.intp), WORDS)) >= 0).all()


def test_a_word_that_few_colours_have_keeps_the_part_of_its_box_that_others_leave() -> None:
    """Without the colours of its neighbours it keeps the whole box."""
    named = survey()
    neighbours = [WORDS.index(word) for word in ("green", "yellow", "blue")]
    alone = fit(named.only(~np.isin(named.word, neighbours)))
    for word, box in FEW.items():
        whole = (box[0] - CUT + 360, box[1] - CUT + 360, *box[2:])
        (part,) = (found for called_so, found in fit(named) if called_so == word)
        assert (word, whole) in alone
        assert part != whole
        assert all(part[i] >= whole[i] and part[i + 1] <= whole[i + 1] for i in (0, 2, 4))
