"""Fluents in a belief that is a table: what counts as known of an object that a hand holds."""

from collections.abc import Collection

import pytest
from kit.minds import TableBelief, TableGeometry, Thing

from skolem.reasoner.planning.situation import Situation, hand_named, quantity_named
from skolem.reasoner.terms import Term, parse_term
from skolem.traces.errors import InternalError
from skolem.traces.messages import Activity, Hand, TypeIs


def holds(fluent: str, hand: Hand | None) -> bool:
    """Return whether a fluent holds of `can`, whose place is known to 3 cm and whose heading is not."""
    return situation(hand).holds(parse_term(fluent))


def situation(hand: Hand | None, fruitless_here: Collection[Term] = ()) -> Situation:
    """Return a situation with one can, in a hand or not."""
    belief = TableBelief({"can": Thing({"soda": 0.75, "bottle": 0.25}, hand=hand)})
    meanings = {"soda": TypeIs(type="soda")}
    return Situation(belief, TableGeometry(), lambda *_: 0.5, lambda *_: 0.5, meanings, fruitless_here)


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


def test_what_is_held_is_not_loose_and_no_hand_that_holds_is_empty() -> None:
    fluents = ("holding(can)", "held(right,can)", "loose(can)", "empty(right)", "held(left,can)", "empty(left)")
    assert [holds(fluent, "right") for fluent in fluents] == [True, True, False, False, False, True]
    assert [holds(fluent, None) for fluent in fluents] == [False, False, True, True, False, True]


@pytest.mark.parametrize("phi", ["prop(soda,can)", "supposed(soda,can)", "type(can,soda)", "holds((soda,),can)"])
def test_a_property_is_as_probable_however_the_rules_ask_for_it(phi: str) -> None:
    assert situation(None).probability(parse_term(phi)) == 0.75


def test_a_look_that_was_in_vain_here_is_asked_for_from_elsewhere() -> None:
    look, other = parse_term("look(can)"), parse_term("look(other)")
    assert situation(None).activity(look) == Activity("look", "can")
    assert situation(None, [other]).activity(look) == Activity("look", "can")
    assert situation(None, [look]).activity(look) == Activity("look", "can", elsewhere=True)
    assert situation("left").activity(look) is None


def test_the_degree_of_a_gaussian_fluent_grows_up_to_its_bound_on_the_axes_that_have_one() -> None:
    def degree(hsv_sd: float, bounds: str) -> float:
        return colour_or_pose("colour", bounds, Thing({"soda": 1.0}, hsv_sd=hsv_sd))

    assert degree(0.02, "sd(8,8,any)") < degree(0.01, "sd(8,8,any)") < degree(0.008, "sd(8,8,any)")
    assert degree(0.008, "sd(8,8,any)") == degree(0.001, "sd(8,8,any)")
    assert degree(0.02, "any") == degree(0.01, "any") == 0.0


def test_a_pose_has_no_degree_since_other_stances_show_more_of_it() -> None:
    poorly, well = (Thing({"soda": 1.0}, pose_sd=sd) for sd in (0.05, 0.01))
    assert colour_or_pose("pose", "sd(8,8,any)", poorly) == colour_or_pose("pose", "sd(8,8,any)", well) == 0.0


def colour_or_pose(quantity: str, bounds: str, thing: Thing) -> float:
    at = Situation(TableBelief({"o1": thing}), TableGeometry(), lambda *_: 0.0, lambda *_: 0.0, {})
    return at.degree(parse_term(f"bn({quantity}(o1),any,{bounds},any,1)"))


def test_what_no_hand_holds_is_neither_weighed_nor_placed() -> None:
    weigh, place = parse_term("weigh(can)"), parse_term("place(can,table,nothing)")
    assert (situation(None).activity(weigh), situation(None).activity(place)) == (None, None)
    assert situation("left").activity(weigh) == Activity("weigh", "can", "left")
    assert situation("left").activity(place) == Activity("place", "can", "left", "table")


def test_names_of_hands_and_quantities_that_the_rules_get_wrong_are_told() -> None:
    assert (hand_named("left"), quantity_named("weight")) == ("left", "weight")
    with pytest.raises(InternalError, match="the hand 'both'; there are "):
        hand_named("both")
    with pytest.raises(InternalError, match="the quantity 'size'; there are pose, colour, weight"):
        quantity_named("size")
