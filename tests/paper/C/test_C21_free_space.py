"""C21: the update reasons about free space and about objects that were not known."""

import pytest
from kit.papers import at_five_percent, can
from kit.searches import BACK, FRONT, LEFT, REGION, RIGHT, TOP, Searcher, table_prior, thing as known


def test_space_seen_empty_makes_it_less_likely_that_something_is_hidden_there() -> None:
    """ "Updates its belief, which may include reasoning about free space." """
    robot = Searcher(table_prior())
    exists = [robot.belief.prob_exists_in(REGION, 0.5)]
    for eye in (FRONT, LEFT, RIGHT, BACK):
        robot.look(eye)
        exists.append(robot.belief.prob_exists_in(REGION, 0.5))
    assert exists == sorted(exists, reverse=True)
    assert exists[0] == pytest.approx(0.2212, abs=1e-3)  # 1 - exp(-.5 * .5)
    assert exists[-1] < 0.01


def test_an_object_believed_in_space_that_is_seen_empty_loses_its_existence() -> None:
    """ "Reasoning about free space": what should be seen and is not is perhaps not there."""
    robot = Searcher(at_five_percent([can("rumour")]))
    existence = [robot.belief.prob_exists("rumour")]
    for _ in range(3):
        robot.look(FRONT)
        existence.append(robot.belief.prob_exists("rumour"))
    assert existence == sorted(existence, reverse=True)
    assert existence[-1] < 0.1


def test_an_object_that_may_be_hidden_keeps_its_existence() -> None:
    """ "Robust in real robot domains with substantial occlusion": not seeing behind a screen proves nothing."""
    screen = (0.9, 0.0, TOP, 0.0)
    objects = [known("screen1", "screen", screen), can("hidden", world_T_object=(1.2, 0.0, TOP, 0.0))]
    robot = Searcher(at_five_percent(objects), [("screen", screen)])
    for _ in range(3):
        robot.look(FRONT)
    assert robot.belief.prob_exists("hidden") > 0.95


def test_what_is_seen_and_was_not_known_is_added() -> None:
    """ "And the addition of newly postulated objects to its representation." """
    robot = Searcher(table_prior(), [("soda", (1.0, 0.1, TOP, 0.0))])
    before = robot.belief.prob_exists_in(REGION, 1.0)
    robot.look(FRONT)
    assert robot.belief.anchors() == ("table1", "_o1_")
    assert robot.belief.prob_exists_in(REGION, 1.0) < before
