"""Weighted places of an object with an uncertain place, and the effect of a missed detection on them."""

import numpy as np
import pytest
from kit.searches import FRONT, LEFT, MIDDLE, RIGHT, TOP, Searcher, table_prior, thing

from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Sought
from skolem.traces.messages import Pose4


def searcher(at: Pose4, sd_m: float, really: Pose4 | None = None) -> Searcher:
    """Return a robot whose prior has a soda on the table and no other object."""
    scene = [] if really is None else [("soda", really)]
    return Searcher(table_prior(objects=[thing("soda1", "soda", at, sd_m=sd_m)], regions=()), scene)


def last_search(robot: Searcher) -> Sought:
    return [event for event in robot.belief.events if isinstance(event, Sought)][-1]


def place_of(robot: Searcher) -> tuple[float, float]:
    x, y, _, _ = robot.belief.snapshot(0).objects["soda1"].world_T_object
    return (x, y)


def test_place_that_is_known_well_is_not_searched_for() -> None:
    robot = searcher((1.1, 0.0, TOP, 0.0), 0.03)
    robot.look(FRONT)
    assert not [event for event in robot.belief.events if isinstance(event, Sought)]
    assert place_of(robot) == pytest.approx((1.1, 0.0), abs=1e-6)


def test_what_is_told_far_off_is_believed_on_the_top_of_its_support() -> None:
    robot = searcher((0.3, 0.9, TOP, 0.0), 0.5)
    x, y = place_of(robot)
    assert abs(x - 1.1) <= 0.3
    assert abs(y) <= 0.5


def test_silence_moves_the_place_to_where_the_look_did_not_reach() -> None:
    robot = searcher((1.1, 0.7, TOP, 0.0), 0.6)
    before = last_search(robot)
    robot.look(FRONT, at=(1.1, 0.4, TOP))
    after = last_search(robot)
    weight = {place[:3]: place[3] for place in before.places}
    assert sum(place[3] for place in after.places) == pytest.approx(1.0)
    less = [place for place in after.places if place[3] < 0.5 * weight[place[:3]]]
    more = [place for place in after.places if place[3] > weight[place[:3]]]
    assert np.mean([v for _, _, v, _ in less]) > np.mean([v for _, _, v, _ in more])
    assert place_of(robot)[1] < 0.0


def test_existence_falls_as_far_as_the_places_were_seen() -> None:
    robot = searcher((1.1, 0.0, TOP, 0.0), 0.3)
    robot.look(FRONT, at=(1.1, 0.4, TOP))
    (missed,) = robot.belief.events[-2].missed  # type: ignore[union-attr]
    assert 0.0 < missed.p_reported < 0.9
    silent = 0.99 * (1.0 - missed.p_reported)
    assert robot.belief.prob_exists("soda1") == pytest.approx(silent / (silent + 0.01), abs=1e-6)


@pytest.mark.parametrize("really", [(0.95, 0.35, TOP, 0.0), (1.25, -0.4, TOP, 0.0), (1.1, 0.1, TOP, 0.0)])
def test_looks_at_where_it_may_be_find_what_is_not_where_it_was_told(really: Pose4) -> None:
    robot = searcher((1.1, 0.0, TOP, 0.0), 0.4, really)
    for _ in range(8):
        x, y = place_of(robot)
        robot.look(FRONT, at=(x, y, TOP))
        if place_of(robot) == pytest.approx(really[:2], abs=0.01):
            break
    assert place_of(robot) == pytest.approx(really[:2], abs=0.01)
    assert robot.belief.anchors() == ("table1", "soda1")
    assert robot.belief.prob_exists("soda1") > 0.95
    assert robot.belief.prob_on("soda1", "table1") > 0.9


def test_what_is_nowhere_on_its_support_is_believed_to_be_gone() -> None:
    robot = searcher((1.1, 0.0, TOP, 0.0), 0.4)
    for eye in (FRONT, LEFT, RIGHT) * 3:
        for end in (-0.35, 0.0, 0.35):
            robot.look(eye, at=(MIDDLE[0], end, TOP))
    assert robot.belief.prob_exists("soda1") < EstimatorConfig().listed
