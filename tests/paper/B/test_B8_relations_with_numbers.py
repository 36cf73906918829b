"""B8: relations other than On and In, and relations of numbers."""

import math

import pytest
from kit.papers import HEAVY, Handler, at_five_percent, can, denotes, shipped


def test_relations_of_the_paper_are_words_of_the_language() -> None:
    """ "R(c1, .., cn)": Near(x, desk) and HeavierThan(x, 400)."""
    assert {"Near": 2, "HeavierThan": 2}.items() <= shipped().vocabulary.words().items()


def test_heavier_than_a_number_is_evaluated() -> None:
    """ "Where c1, .., cn are numeric constants or anchors." """
    belief = Handler(at_five_percent([can("can1", 1.0)])).belief
    heavier = denotes("lambda x. HeavierThan(x, 400)", belief)["can1"]
    assert heavier == pytest.approx(belief.prob_exists("can1") * belief.prob_property("can1", HEAVY))
    assert heavier < denotes("lambda x. HeavierThan(x, 100)", belief)["can1"]


def test_near_an_anchor_is_evaluated() -> None:
    """ "Anchors to objects." """
    here, there = (1.0, 0.0, 0.7, 0.0), (1.1, 0.45, 0.7, 0.0)
    belief = Handler(
        at_five_percent([can("a", 1.0, here), can("b", 1.0, there), can("c", 1.0, (1.05, 0, 0.7, 0))])
    ).belief
    values = denotes("lambda x. Near(x, c)", belief)
    assert values["a"] > values["b"]
    assert not math.isnan(values["c"])
