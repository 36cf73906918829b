"""A2: the type of an object is a multinoulli over a fixed finite set."""

import math

import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, seen_as

from skolem.traces.messages import TypeIs

SODA = TypeIs(type="soda")


@pytest.mark.parametrize(("before", "after"), [(0.80, 0.987), (0.91, 0.995), (0.92, 0.995)])
def test_one_right_detection_is_bayes_rule_by_hand(before: float, after: float) -> None:
    """ "Multinoulli distribution over a fixed finite set of possible object types." """
    robot = Handler(at_five_percent([can(soda=before)]))
    robot.see(seen_as(STANDS))
    by_hand = before * 0.95 / (before * 0.95 + (1.0 - before) * 0.05)
    assert robot.belief.prob_property("can1", SODA) == pytest.approx(by_hand, abs=1e-9)
    assert by_hand == pytest.approx(after, abs=5e-4)


def test_a_detection_of_another_type_lowers_the_belief() -> None:
    """ "A high-fidelity belief-update step based on object detections." """
    robot = Handler(at_five_percent([can(soda=0.8)]))
    robot.see(seen_as(STANDS, kind="bottle"))
    assert robot.belief.prob_property("can1", SODA) == pytest.approx(0.8 * 0.05 / (0.8 * 0.05 + 0.2 * 0.95))


def test_the_probabilities_sum_to_one_after_every_update_and_the_set_stays_the_same() -> None:
    """ "A fixed finite set of possible object types." """
    robot = Handler(at_five_percent([can(soda=0.8)]))
    for kind in ("soda", "bottle", "bottle", "soda", "soda", "bottle"):
        robot.see(seen_as(STANDS, kind=kind))
        types = robot.belief.snapshot(0).objects["can1"].type
        assert math.fsum(types.values()) == pytest.approx(1.0, abs=1e-12)
        assert set(types) == {"soda", "bottle"}
