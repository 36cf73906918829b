"""B4: B(Den(expr, obj), p)."""

import pytest
from kit.papers import Handler, at_five_percent, can, denotes, posed, seen_as

from skolem.reasoner.terms import nll, parse_term

PLACES = {"can1": (1.0, -0.2, 0.7, 0.0), "can2": (1.0, 0.0, 0.7, 0.0), "can3": (1.0, 0.2, 0.7, 0.0)}
GOAL = "exists o. B(Den(lambda x. Green(x) & Soda(x), o), 0.9) & B(On(o, table1), 0.5)"


def test_every_anchor_has_a_probability_and_the_threshold_parts_them() -> None:
    """ "The robot believes, with probability at least p, that obj can be denoted by expr." """
    robot = Handler(at_five_percent([can(name, 0.8, at) for name, at in PLACES.items()]))
    robot.see(seen_as(PLACES["can1"]), seen_as(PLACES["can2"], kind="bottle"))
    values = denotes("lambda x. Green(x) & Soda(x)", robot.belief)
    assert tuple(values) == robot.belief.anchors()
    assert values["can1"] == pytest.approx(0.99 * 0.987, abs=0.01)
    assert values["can2"] == pytest.approx(0.99 * 0.174, abs=0.01)
    assert values["table1"] == 0.0
    at = posed(GOAL, robot.belief).situation
    for anchor, value in values.items():
        assert at.holds(parse_term(f"b(den(e1,{anchor}),{nll(0.9)})")) is (value >= 0.9)
        assert at.holds(parse_term(f"b(den(e1,{anchor}),{nll(0.1)})")) is (value >= 0.1)


def test_the_goal_is_achieved_by_the_anchor_that_is_denoted() -> None:
    """ "Where obj is an internal name, or anchor for an object." """
    robot = Handler(at_five_percent([can(name, 0.8, at) for name, at in PLACES.items()]))
    assert posed(GOAL, robot.belief).achieved() is None
    robot.see(seen_as(PLACES["can3"]))
    achieved = posed(GOAL, robot.belief).achieved()
    assert achieved is not None
    assert {str(f) for f in achieved} == {f"b(den(e1,can3),{nll(0.9)})", f"b(on(can3,table1),{nll(0.5)})"}
