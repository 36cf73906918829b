"""D3: belief copes with detections that are missed."""

import pytest
from kit.papers import STANDS, at_five_percent, can
from kit.searches import FRONT, Searcher

FOUND = 0.9  # of the detector
SURE = 0.99  # existence of what the robot is told of
SCREEN = ("screen", (0.85, 0.0, 0.7, 0.0))  # between FRONT and STANDS


def robot(*before: tuple[str, tuple[float, float, float, float]]) -> Searcher:
    """A robot that is told of one can, which is there, with things before it."""
    return Searcher(at_five_percent([can()]), [("soda", STANDS), *before])


def robbed() -> Searcher:
    """The same robot; someone has taken the can."""
    return Searcher(at_five_percent([can()]))


def missed() -> float:
    """Return by Bayes' rule what is left of the existence after a miss, if all of the object was to be seen."""
    return SURE * (1.0 - FOUND) / (SURE * (1.0 - FOUND) + 1.0 - SURE)


def test_a_miss_in_plain_view_lowers_existence_as_bayes_rule_says_and_a_sighting_restores_it() -> None:
    """ "Robust in the presence of substantial occlusion and sensing error." """
    searcher, there = robbed(), robot().solids[1]
    searcher.look(FRONT)
    assert searcher.belief.prob_exists("can1") == pytest.approx(missed())
    searcher.solids.append(there)
    searcher.look(FRONT)
    assert searcher.belief.prob_exists("can1") > missed()
    assert searcher.belief.anchors() == ("table1", "can1")


def test_two_to_three_misses_in_plain_view_end_the_belief_in_an_object() -> None:
    """ "Sensing error": one miss is none yet, more of them say that it is gone."""
    assert looks_to_give_up(robbed()) in (2, 3)


def test_where_the_picture_shows_that_something_stands_it_takes_more_misses() -> None:
    """What stands there is the object or something else, for which the prior is one in ten; it is news only once."""
    assert looks_to_give_up(robbed()) < looks_to_give_up(robot()) <= 6


def looks_to_give_up(searcher: Searcher) -> int:
    looks = 0
    while searcher.belief.prob_exists("can1") >= 0.5:
        searcher.look(FRONT, found=False)
        looks += 1
    return looks


def test_a_miss_of_what_is_out_of_sight_is_no_evidence() -> None:
    """ "Substantial occlusion": existence falls by the share that could be seen, and nothing could."""
    searcher = robot(SCREEN)
    searcher.look(FRONT)
    assert searcher.belief.prob_exists("can1") == pytest.approx(SURE)
