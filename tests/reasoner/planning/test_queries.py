"""What the rules are told of a belief that is a table."""

import pytest
from kit.minds import TableBelief, TableGeometry, Thing

from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.terms import nll, parse_term
from skolem.traces.messages import Limits, TypeIs

NINE = nll(0.9)
MEANINGS = {name: TypeIs(type=name) for name in ("table", "soda", "cold", "full")}
THINGS = {
    "table1": Thing({"table": 1.0}),
    "table2": Thing({"table": 1.0}),
    "can": Thing({"soda": 0.99, "cold": 0.6, "full": 0.3}, on="table1"),
    "cup": Thing({"soda": 0.1, "cold": 0.99}, on="table1"),
    "lost": Thing({"soda": 0.5}, on="floor"),
}


def queries(*alternatives: tuple[str, ...]) -> Queries:
    """Return the answers for a description that each of some sets of properties is enough for."""
    situation = Situation(TableBelief(THINGS), TableGeometry(), lambda *_: 0.5, lambda *_: 0.5, MEANINGS)
    return Queries(situation, {"e1": alternatives})


@pytest.mark.parametrize(
    ("anchor", "asked"), [("can", "(cold,full)"), ("cup", "(soda,full)"), ("lost", "(soda,cold,full)")]
)
def test_only_the_properties_that_are_not_believed_yet_are_asked_for(anchor: str, asked: str) -> None:
    [props] = queries(("soda", "cold", "full")).props_for("e1", anchor, NINE)
    assert str(props) == asked


def test_a_set_that_is_believed_as_a_whole_is_given_as_a_whole() -> None:
    [props] = queries(("soda",)).props_for("e1", "can", NINE)
    assert str(props) == "(soda,)"


def test_properties_that_belong_to_a_larger_set_too_are_given_with_the_rest_of_their_own() -> None:
    """(full,) alone would be taken for a part of the larger set."""
    small, large = ("soda", "full"), ("soda", "cold", "full")
    found = queries(small, large).props_for("e1", "can", NINE)
    assert [str(props) for props in found] == ["(soda,full)", "(cold,full)"]


def test_a_set_has_an_even_share_of_the_bound_for_each_property() -> None:
    asked = queries(("soda", "cold", "full"))
    props = parse_term("(cold,full)")
    assert asked.portion("e1", props, "can", 90) == 60  # type: ignore[arg-type]


@pytest.mark.parametrize(("least", "found"), [(0.5, list(THINGS)), (0.51, [])])
def test_what_is_less_plausible_than_the_limit_is_left_out_and_named(least: float, found: list[str]) -> None:
    situation = Situation(TableBelief(THINGS), TableGeometry(), lambda *_: 0.5, lambda *_: 0.5, MEANINGS)
    asked = Queries(situation, {}, Limits(min_plausible=least))
    assert asked.plausible("e1") == found
    assert asked.left_out == set(THINGS).difference(found)


def test_an_observation_costs_no_more_than_the_limit_says() -> None:
    situation = Situation(TableBelief(THINGS), TableGeometry(), lambda *_: 0.5, lambda *_: 0.5, MEANINGS)
    costs = [Queries(situation, {}, Limits(min_favourable=p)).favourable("cold", "can", NINE) for p in (0.5, 0.95)]
    assert costs == [nll(0.9), nll(0.95)]


def test_what_stands_on_a_support_is_told_and_nothing_of_what_supports_nothing() -> None:
    asked = queries()
    assert asked.standing_on("table1") == ["can", "cup"]
    assert asked.standing_on("table2") == []
    assert (asked.support_of("can"), asked.support_of("lost"), asked.support_of("table1")) == (["table1"], [], [])
    assert asked.supports() == ["table1", "table2"]
