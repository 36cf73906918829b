"""Fluents in a belief that is a table: what counts as known of an object that a hand holds."""

import pytest
from kit.minds import TableBelief, TableGeometry, Thing

from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.terms import parse_term
from skolem.traces.messages import Hand


def holds(fluent: str, hand: Hand | None) -> bool:
    """Return whether a fluent holds of `can`, whose place is known to 3 cm and whose heading is not."""
    belief = TableBelief({"can": Thing({"soda": 1.0}, hand=hand)})
    situation = Situation(belief, TableGeometry(), lambda *_: 0.5, lambda *_: 0.5, {})
    return situation.holds(parse_term(fluent))


def test_any_place_of_a_held_object_is_known_however_close_a_bound_is_asked() -> None:
    fluent = "bn(pose(can),any,sd(8,8,any),any,105361)"
    assert holds(fluent, "right")
    assert not holds(fluent, None)


@pytest.mark.parametrize("hand", ["right", None])
def test_a_held_object_is_not_known_to_be_at_a_certain_place(hand: Hand | None) -> None:
    """A pose in a hand is known relative to the hand: whether it is a given one is asked of the Gaussian."""
    assert not holds("bn(pose(can),v(500,0,0),sd(8,8,any),tol(10,10,any),105361)", hand)
    assert not holds("bn(pose(can),v(0,0,0),sd(8,8,any),tol(10,10,any),105361)", hand)
    assert not holds("bn(pose(can),v(500,0,0),sd(40,40,any),tol(10,10,any),105361)", hand)
    assert holds("bn(pose(can),v(0,0,0),sd(40,40,any),tol(10,10,any),105361)", hand)


@pytest.mark.parametrize("hand", ["right", None])
def test_holding_an_object_tells_neither_its_colour_nor_its_weight(hand: Hand | None) -> None:
    assert not holds("bn(colour(can),any,sd(20,20,20),any,105361)", hand)
    assert not holds("bn(weight(can),any,sd(20),any,105361)", hand)
