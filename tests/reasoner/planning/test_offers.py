"""What asking the rules costs, in counts: clingo calls and ground atoms, never milliseconds."""

import math

import pytest
from kit.minds import Region, TableBelief, Thing
from kit.papers import EXAMPLE_GOAL, example, posed, shipped

from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.offers import RuleOffers
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.terms import parse_term

FLUENTS = tuple(
    parse_term(text)
    for text in (
        *(f"b(den(e1,o{k}),105361)" for k in range(1, 9)),
        *(f"b(on(o{k},desk),105361)" for k in range(1, 5)),
        *(f"bn(colour(o{k}),v(350,800,800),sd(20,20,20),tol(90,190,190),693147)" for k in range(1, 4)),
        "holding(o1)",
    )
)


def among(objects: int) -> PosedGoal:
    """Return the example's goal posed of so many things, of which eight may be meant."""
    things = {name: Thing({"table": 1.0}, pose_sd=0.005) for name in ("desk", "side")}
    for k in range(objects):
        soda = 0.8 if k < 8 else 0.0
        types = {"soda": soda, "bottle": 1.0 - soda}
        things[f"o{k + 1}"] = Thing(types, on="side", hsv=(0.35, 0.8, 0.8), hsv_sd=0.04, ln_kg=(math.log(0.4), 0.6))
    return posed(EXAMPLE_GOAL, TableBelief(things, {"_reg1_": Region("side")}))


def test_sixteen_open_fluents_are_one_call() -> None:
    at = among(8)
    before = at.offers.calls
    at.offers.prepare(FLUENTS)
    at.offers.prepare(FLUENTS)
    assert at.offers.calls == before + 1
    assert all(at.offers.offers(fluent) for fluent in FLUENTS)
    assert at.offers.calls == before + 1


def test_what_cannot_be_lifted_is_not_weighed() -> None:
    at, refused = among(1), {}
    for name in ("o1", "desk"):
        (weighing,) = at.offers.offers(parse_term(f"bn(weight({name}),v(any),sd(100),any,693147)"))
        refused[name] = tuple(map(str, weighing.rejected))
    assert refused == {"o1": (), "desk": ("not_graspable",)}


@pytest.mark.parametrize("objects", [50, 500, 5000])
def test_what_is_ground_does_not_grow_with_what_is_known(objects: int) -> None:
    few, many = among(8), among(objects)
    for at in (few, many):
        at.offers.prepare(FLUENTS)
    assert few.offers.ground_atoms == many.offers.ground_atoms <= 600


def test_the_example_takes_few_calls_and_few_expansions_to_its_first_action() -> None:
    turn = example().agent.decide(0)
    assert turn.action is not None
    assert sum(decision.clingo_calls for decision in turn.decisions) <= 15
    assert sum(decision.expansions for decision in turn.decisions) <= 30


def test_every_object_that_may_be_meant_is_considered_however_many_there_are() -> None:
    things = {"desk": Thing({"table": 1.0}, pose_sd=0.005)}
    for k in range(20):
        things[f"o{k}"] = Thing({"soda": 0.5 + k / 50, "bottle": 0.5 - k / 50}, hsv=(0.35, 0.8, 0.8), hsv_sd=0.04)
    at = posed(EXAMPLE_GOAL, TableBelief(things))
    assert len(at.instantiations) == 21  # one of them about an object nobody has met


def test_a_query_is_asked_once_in_a_belief() -> None:
    play = example()
    at = posed(EXAMPLE_GOAL, play.belief, geometry=play.geometry)
    play.geometry.asked.clear()
    fluent = parse_term("clear(pick(right,o2))")
    at.offers.prepare([fluent, parse_term("clear(pick(left,o2))")])
    assert [str(i.step) for i in at.offers.offers(fluent)] == ["remove(pick(right,o2))"]
    assert sorted(play.geometry.asked) == ["blockers pick(left, o2)", "blockers pick(right, o2)"]


def test_only_rules_that_can_fire_are_loaded() -> None:
    book = shipped()
    small = book.solve([parse_term("goal(at(look(o1)))")], None, ["move", "pick", "place", "regress"])
    assert small.atoms["candidate"] == [(parse_term("move(look(o1))"),)]
    assert small.ground_atoms <= 12


def test_costs_are_counted_from_nothing() -> None:
    at = among(8)
    fresh = RuleOffers(shipped(), at.situation, Queries(at.situation, {}), at.offers.mutexes)
    assert (fresh.calls, fresh.ground_atoms) == (0, 0)
    fresh.offers(parse_term("holding(o1)"))
    assert fresh.calls == 1 < fresh.ground_atoms
