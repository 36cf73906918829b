"""The goal read against the truth: by the robot's own denotation, with probabilities 0 and 1."""

import pytest
from kit.believed_scenes import belief, believed

from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.protocols import BeliefQueries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.tools.loop.verdict import Truth, meant_by, own_makes_it_true, verdict
from skolem.traces.messages import HsvVolume, TrueObject, TrueState, TypeIs, Verdict, WeightInterval

TABLE = TrueObject(id="table1", type="table", world_T_object=(1.3, 0.0, 0.0, 0.0), hsv=(0.1, 0.5, 0.6), kg=30.0)
GREEN = TrueObject(
    id="sodaC", type="soda", world_T_object=(1.1, 0.2, 0.68, 0.0), hsv=(0.33, 0.9, 0.8), kg=0.35, on="table1"
)
RED = GREEN.model_copy(update={"id": "sodaE", "hsv": (0.99, 0.9, 0.8), "world_T_object": (1.1, -0.2, 0.68, 0.0)})
GOAL = "exists o. B(Den(lambda x. Green(x), o), 0.9) & B(In(o, table1), 0.9)"


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return Rulebook.load(Queries)


def state(*objects: TrueObject) -> TrueState:
    return TrueState(step=3, world_T_base=(0.0, 0.0, 0.0), objects=(TABLE, *objects), sha256="")


def judged(rulebook: Rulebook, goal: str, *objects: TrueObject) -> Verdict:
    vocabulary = rulebook.vocabulary
    return verdict(parse_goal(goal, vocabulary.words()), rulebook, state(*objects), vocabulary.types)


def test_a_green_object_on_the_table_makes_the_goal_true_and_is_named(rulebook: Rulebook) -> None:
    assert judged(rulebook, GOAL, RED, GREEN) == Verdict(true=True, witness="sodaC")


@pytest.mark.parametrize(
    "change",
    [
        {"on": None, "in_hand": "right"},
        {"on": "table2"},
        {"hsv": (0.6, 0.9, 0.8)},
        {"world_T_object": (1.1, 0.59, 0.68, 0.0)},  # half over the edge
    ],
    ids=["in hand", "elsewhere", "blue", "over the edge"],
)
def test_what_is_held_elsewhere_otherwise_coloured_or_overhanging_does_not(
    rulebook: Rulebook, change: dict[str, object]
) -> None:
    assert judged(rulebook, GOAL, RED, GREEN.model_copy(update=change)) == Verdict(true=False)


def test_one_object_must_satisfy_all_of_the_goal(rulebook: Rulebook) -> None:
    away = GREEN.model_copy(update={"on": None, "world_T_object": (0.0, 3.0, 0.0, 0.0)})
    assert not judged(rulebook, GOAL, RED, away).true


def test_descriptions_with_a_nested_exists_are_evaluated_too(rulebook: Rulebook) -> None:
    goal = "exists o. B(Den(lambda x. Soda(x) & exists y. (On(x, y) & Table(y)), o), 0.9)"
    assert judged(rulebook, goal, GREEN) == Verdict(true=True, witness="sodaC")


@pytest.mark.parametrize(
    "goal",
    ["B(Soda(ghost), 0.5)", "B(Green(ghost), 0.9)", "B(On(ghost, table1), 0.9)", "B(Holds((Soda,), ghost), 0.5)"],
)
def test_what_the_robot_was_told_of_but_does_not_exist_makes_no_goal_true(rulebook: Rulebook, goal: str) -> None:
    assert judged(rulebook, goal, GREEN) == Verdict(true=False)


def test_what_does_not_exist_has_no_property_and_stands_nowhere() -> None:
    truth = Truth(state(GREEN), Rulebook.load(Queries).vocabulary.types)
    assert truth.prob_property("ghost", TypeIs(type="soda")) == 0.0
    assert truth.prob_on("ghost", "table1") == truth.prob_on("sodaC", "ghost") == 0.0
    assert truth.prob_near("ghost", "sodaC", 9.0) == truth.prob_near("sodaC", "ghost", 9.0) == 0.0
    assert truth.support("ghost") is None
    assert not truth.graspable("ghost")


def test_truth_answers_every_query_with_certainty() -> None:
    types = Rulebook.load(Queries).vocabulary.types
    truth: BeliefQueries = Truth(state(RED, GREEN.model_copy(update={"on": None, "in_hand": "left"})), types)
    assert truth.anchors() == ("table1", "sodaE", "sodaC")
    assert (truth.prob_exists("sodaE"), truth.prob_exists("ghost")) == (1.0, 0.0)
    assert (truth.held("left"), truth.held("right")) == ("sodaC", None)
    assert (truth.graspable("sodaE"), truth.graspable("table1")) == (True, False)
    assert truth.prob_property("sodaE", TypeIs(type="soda")) == 1.0
    red = HsvVolume(hue=(0.95, 0.05), saturation=(0.4, 1.0), value=(0.2, 1.0))  # wraps
    assert (truth.prob_property("sodaE", red), truth.prob_property("sodaC", red)) == (1.0, 0.0)
    assert truth.prob_property("sodaE", WeightInterval(at_least_kg=0.35)) == 1.0
    assert truth.prob_property("sodaE", WeightInterval(at_least_kg=0.1, below_kg=0.35)) == 0.0
    assert truth.prob_on("sodaE", "table1") == 1.0
    assert truth.gaussian("pose", "sodaE").mean == pytest.approx((1.1, -0.2, 0.0))
    for quantity in ("pose", "colour", "weight"):
        assert not truth.gaussian(quantity, "sodaE").covariance.any()
        assert not truth.observation_covariance(quantity, "sodaE").any()


def test_what_was_said_of_the_start_is_judged_by_the_first_state(rulebook: Rulebook) -> None:
    there = state(RED.model_copy(update={"on": "table2"}), GREEN)
    now, types = state(RED, GREEN), rulebook.vocabulary.types
    goal = "exists o. B(Den({}, o), 0.9)"
    for described, witness in (
        ("lambda x. Soda(x) & not Was(On(x, table1))", "sodaE"),
        ("the x. Soda(x) & On(x, table1)", "sodaC"),
        ("lambda x. Soda(x) & not On(x, table1)", None),
    ):
        read = parse_goal(goal.format(described), rulebook.vocabulary.words(), ["table1"])
        assert verdict(read, rulebook, now, types, there).witness == witness


@pytest.mark.parametrize(
    ("described", "witness"),
    [
        ("heaviest x. Soda(x)", "sodaC"),
        ("lightest x. Soda(x)", "sodaE"),
        ("nearest x to table1. Soda(x)", "sodaE"),
        ("lambda x. Soda(x) & not exists y. (Soda(y) & HeavierThan(y, x))", "sodaC"),
    ],
)
def test_the_truth_knows_what_is_heaviest_lightest_and_nearest(
    rulebook: Rulebook, described: str, witness: str
) -> None:
    lighter = RED.model_copy(update={"kg": 0.2, "world_T_object": (1.2, -0.1, 0.68, 0.0)})
    goal = f"exists o. B(Den({described}, o), 0.9)"
    read = parse_goal(goal, rulebook.vocabulary.words(), ["table1"])
    found = verdict(read, rulebook, state(lighter, GREEN), rulebook.vocabulary.types)
    assert found == Verdict(true=True, witness=witness)


# ---------------------------------------------------------------- whose goal it is

OWN_NAME = believed("soda", (1.12, 0.19, 0.68, 0.0))  # near the green one, under a name of the robot's own


def own(rulebook: Rulebook, anchor: str | None, *objects: TrueObject, goal: str = GOAL) -> bool:
    vocabulary, told = rulebook.vocabulary, belief({"_o1_": OWN_NAME})
    read = parse_goal(goal, vocabulary.words())
    return own_makes_it_true(read, rulebook, state(*objects), vocabulary.types, told, anchor)


def test_a_goal_that_another_object_makes_true_is_not_the_robots_own(rulebook: Rulebook) -> None:
    assert own(rulebook, "sodaC", RED, GREEN)
    assert not own(rulebook, "sodaE", RED, GREEN)
    assert not own(rulebook, None, RED, GREEN)
    assert not own(rulebook, "ghost", RED, GREEN)


def test_each_of_several_objects_that_make_a_goal_true_may_be_the_robots_own(rulebook: Rulebook) -> None:
    second = GREEN.model_copy(update={"id": "sodaX", "world_T_object": (1.1, -0.3, 0.68, 0.0)})
    assert judged(rulebook, GOAL, GREEN, second).witness == "sodaC"
    assert own(rulebook, "sodaX", GREEN, second)


def test_a_name_of_the_robots_own_means_the_nearest_thing_that_can_be_lifted(rulebook: Rulebook) -> None:
    told, types = belief({"_o1_": OWN_NAME}), rulebook.vocabulary.types
    assert meant_by("_o1_", told, state(RED, GREEN), types) == "sodaC"
    assert meant_by("_o1_", told, state(RED), types) == "sodaE"
    assert meant_by("_o1_", told, state(), types) is None
    assert own(rulebook, "_o1_", RED, GREEN)


def test_a_goal_without_variables_is_the_robots_own_if_it_is_true(rulebook: Rulebook) -> None:
    named = "B(On(sodaC, table1), 0.9)"
    assert own(rulebook, None, GREEN, goal=named)
    assert not own(rulebook, None, GREEN.model_copy(update={"on": "table2"}), goal=named)
