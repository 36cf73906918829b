"""What one's own belief need not say: `PlainBelief` answers as if everything were known."""

import inspect

import numpy as np
import pytest
from kit.minds import TableGeometry
from kit.plays import LIMITS

from skolem.reasoner import Agent, BeliefQueries, PlainBelief, load_rules, parse_goal
from skolem.traces.messages import Hand, Meaning, Quantity, TypeIs

QUANTITIES: tuple[Quantity, ...] = ("pose", "colour", "weight")
ON_TABLE1 = "exists o. B(Den(lambda x. Soda(x), o), 0.9) & B(In(o, table1), 0.9)"


def questions() -> set[str]:
    owners = [owner for owner in BeliefQueries.__mro__ if owner.__module__ == BeliefQueries.__module__]
    return {name for owner in owners for name in vars(owner) if not name.startswith("_")}


class Cans(PlainBelief):
    """One's own belief: two tables and a can, which a hand may hold."""

    def __init__(self) -> None:
        self.on: str | None = "table2"
        self.changes = 0

    @property
    def version(self) -> int:
        return self.changes

    def anchors(self) -> tuple[str, ...]:
        return ("table1", "table2", "can")

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        return float(isinstance(meaning, TypeIs) and meaning.type == ("soda" if anchor == "can" else "table"))

    def support(self, anchor: str) -> str | None:
        return self.on if anchor == "can" else None

    def graspable(self, anchor: str) -> bool:
        return anchor == "can"

    def held(self, hand: Hand) -> str | None:
        return "can" if self.on is None and hand == "right" else None


def test_every_question_that_the_reasoner_may_ask_is_answered() -> None:
    assert questions() == {name for name in vars(PlainBelief) if not name.startswith("_")}
    assert len(questions()) == 19
    for name in questions() - {"version"}:
        asked, answered = (inspect.signature(getattr(owner, name)) for owner in (BeliefQueries, PlainBelief))
        assert list(asked.parameters) == list(answered.parameters)


def test_a_plain_belief_is_certain_and_knows_no_object() -> None:
    plain: BeliefQueries = PlainBelief()
    assert (plain.version, plain.anchors(), plain.regions()) == (0, (), ())
    assert (plain.prob_exists("can"), plain.graspable("can"), plain.support("can")) == (0.0, False, None)
    assert plain.prob_property("can", TypeIs(type="soda")) == plain.prob_property_of_new(TypeIs(type="soda")) == 0.0
    assert (plain.prob_on("can", "table1"), plain.prob_near("can", "table1", 9.0)) == (0.0, 0.0)
    assert plain.prob_near("can", "can", 0.0) == 1.0
    assert (plain.held("right"), plain.held("left")) == (None, None)
    assert (plain.prob_contents("above"), plain.prob_exists_in("above", 1.0)) == (1.0, 0.0)
    assert plain.prob_detected("can") == plain.prob_type_right() == 1.0
    assert plain.prob_favourable("can", TypeIs(type="soda"), 0.9) == 1.0
    with pytest.raises(KeyError, match="above"):
        plain.region_support("above")


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_values_are_known_without_variance_and_in_the_shape_of_their_quantity(quantity: Quantity) -> None:
    n = 1 if quantity == "weight" else 3
    known = Cans().gaussian(quantity, "can")
    assert (known.mean.shape, known.covariance.shape, known.probability) == ((n,), (n, n), 1.0)
    assert not known.covariance.any()
    assert not np.any(Cans().observation_covariance(quantity, "can"))


def test_existence_and_lying_on_something_follow_from_what_is_overridden() -> None:
    cans = Cans()
    assert (cans.prob_exists("can"), cans.prob_exists("ghost")) == (1.0, 0.0)
    assert (cans.prob_on("can", "table2"), cans.prob_on("can", "table1")) == (1.0, 0.0)


def test_an_agent_achieves_its_goal_with_ones_own_belief_in_place_of_the_estimator() -> None:
    rules, belief, geometry = load_rules(), Cans(), TableGeometry()
    goal = parse_goal(ON_TABLE1, rules.vocabulary.words(), belief.anchors())
    agent = Agent(goal, rules, belief, geometry, LIMITS)
    done: list[str] = []
    while (turn := agent.decide(len(done))).action is not None:
        done.append(turn.action.op)
        kind = turn.action.op.partition("(")[0]
        if kind == "Move":
            geometry.drive(geometry.asked[-1].removeprefix("approach "))
        elif kind in ("Pick", "Place"):
            belief.on = "table1" if kind == "Place" else None
        belief.changes += 1
    assert turn.end is not None
    assert (turn.end.status, turn.end.anchor) == ("goal_achieved", "can")
    assert [op.partition("(")[0] for op in done] == ["Move", "Pick", "Move", "Place"]
