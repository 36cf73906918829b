"""A7: a weight is a Gaussian over its logarithm; before a reading it is that of an arbitrary object."""

import math

import numpy as np
import pytest
from kit.papers import HEAVY, STANDS, Handler, at_five_percent, normal_tail, seen_as, shipped

from skolem.tools.words.belief_table import belief_rows


def met() -> Handler:
    """A robot that has discovered a soda."""
    robot = Handler(at_five_percent())
    robot.see(seen_as(STANDS))
    robot.see(seen_as(STANDS))
    assert robot.belief.anchors() == ("table1", "_o1_")
    return robot


def test_a_discovered_object_weighs_what_an_arbitrary_one_does() -> None:
    """ " 'Prior' means the robot's distribution of the weight is a prior distribution for an arbitrary object." """
    robot = met()
    believed = robot.belief.gaussian("weight", "_o1_")
    assert (believed.mean[0], believed.covariance[0, 0]) == pytest.approx((math.log(0.3), 0.36))
    expected = normal_tail(math.log(0.4), math.log(0.3), 0.6)
    assert robot.belief.prob_property("_o1_", HEAVY) == pytest.approx(expected)
    assert robot.belief.prob_property_of_new(HEAVY) == pytest.approx(expected)
    rows = {row[0]: row[4] for row in belief_rows(robot.belief.snapshot(0), shipped().vocabulary.meanings)}
    assert rows["_o1_"] == "prior"


@pytest.mark.parametrize(("kg", "heavy"), [(0.1, 0.0), (0.5, 1.0)])
def test_a_reading_decides_whether_it_is_heavy(kg: float, heavy: float) -> None:
    """ "The robot gets an observation that _o2_ weighs 100 g and updates its belief state accordingly." """
    robot = met()
    robot.pick("_o1_")
    robot.weigh(kg)
    assert abs(robot.belief.prob_property("_o1_", HEAVY) - heavy) < 1e-3
    believed = robot.belief.gaussian("weight", "_o1_")
    assert believed.mean[0] == pytest.approx(math.log(kg), abs=0.01)
    rows = {row[0]: row[4] for row in belief_rows(robot.belief.snapshot(0), shipped().vocabulary.meanings)}
    assert rows["_o1_"] == f"{1000 * kg:.0f} g, low"


def test_equal_shares_of_a_weight_are_equally_uncertain() -> None:
    """ "Gaussian in log-weight space": the prior is symmetric in ratios, not in grams."""
    belief = met().belief
    half, double = np.exp(belief.gaussian("weight", "_o1_").mean[0]) * np.array([0.5, 2.0])
    over = [belief.prob_property("_o1_", HEAVY.model_copy(update={"at_least_kg": float(kg)})) for kg in (half, double)]
    assert over[0] + over[1] == pytest.approx(1.0)
