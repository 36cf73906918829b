"""The shipped rules: a fluent in, the exact rule instances out, on a belief that is a table."""

import math
import re
from pathlib import Path

import pytest
from kit.minds import TableBelief, TableGeometry, Thing
from kit.places import RULES

from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.goals import read_mutexes
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.offers import RuleOffers
from skolem.reasoner.planning.patterns import Mutexes
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.situation import Situation
from skolem.reasoner.rulebook.book import RULE_FILES, Rulebook
from skolem.reasoner.terms import nll, parse_term

NINE = nll(0.9)
GOAL = "exists o. B(Den(lambda x. Soda(x) & Green(x) & Heavy(x), o), 0.9) & B(On(o, table1), 0.9)"


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return Rulebook.load(Queries)


def things() -> dict[str, Thing]:
    return {
        "table1": Thing({"table": 1.0}),
        "o2": Thing({"soda": 0.80, "bottle": 0.20}, on="table1", hsv=(0.35, 0.8, 0.8), hsv_sd=0.03),
        "o3": Thing({"soda": 0.87, "bottle": 0.13}, on="table1", hsv=(0.63, 0.8, 0.8), hsv_sd=0.03),
    }


def offers(rulebook: Rulebook, believed: dict[str, Thing]) -> RuleOffers:
    belief = TableBelief(believed)
    goal = parse_goal(GOAL, rulebook.vocabulary.words(), frozenset(believed))
    denotations = Denotations(goal, rulebook)
    situation = Situation(
        belief,
        TableGeometry(),
        lambda e, o: denotations.probability(e, o, belief),
        lambda e, r: denotations.probability_of_new(e, r, belief),
        rulebook.vocabulary.meanings,
    )
    return RuleOffers(rulebook, situation, Queries(situation, denotations.alternatives), Mutexes([]))


def only(rulebook: Rulebook, fluent: str, believed: dict[str, Thing] | None = None) -> Instance:
    (instance,) = offers(rulebook, believed or things()).offers(parse_term(fluent))
    return instance


def texts(instance: Instance) -> tuple[set[str], set[tuple[str, int]]]:
    return set(map(str, instance.results)), {(str(f), level) for f, level in instance.preconditions}


def test_examine_obj_is_the_rule_of_the_paper(rulebook: Rulebook) -> None:
    """Precond: Holds(Props, Obj), Den(expr, Obj) >= P_p; result: Den(expr, Obj) >= P_r, KRD(Obj); cost -ln P_p."""
    instance = only(rulebook, f"b(den(e1,o2),{NINE})")
    results, preconditions = texts(instance)
    p_p = 0.80 * _normal(0.1) * (1 - _cdf((math.log(0.4) - math.log(0.3)) / 0.6))
    assert instance.price == pytest.approx(nll(p_p), rel=0.02)
    assert results == {f"b(den(e1,o2),{NINE})", "krd(o2)"}
    holds = sorted((f, at) for f, at in preconditions if f.startswith("b(holds"))
    ((den, at_once),) = [(f, at) for f, at in preconditions if f.startswith("b(den")]
    (rest, _), (unsure, level) = holds
    assert re.fullmatch(r"b\(holds\(\(green,\),o2\),\d+\)", rest)
    assert re.fullmatch(r"b\(holds\(\(heavy,soda\),o2\),\d+\)", unsure)
    assert level == 1
    assert den == f"b(den(e1,o2),{instance.price + nll(0.5)})"
    assert at_once == 0
    assert instance.executes is None


def test_props_for_asks_only_what_is_below_its_share(rulebook: Rulebook) -> None:
    believed = things()
    believed["o2"].types = {"soda": 0.99, "bottle": 0.01}
    instance = only(rulebook, f"b(den(e1,o2),{NINE})", believed)
    assert str(instance.step) == f"examine(e1,(heavy,),o2,{NINE})"


def test_holds_is_split_evenly_and_rounded_towards_certainty(rulebook: Rulebook) -> None:
    instance = only(rulebook, "b(holds((heavy,soda),o2),70241)")
    assert texts(instance)[1] == {("b(supposed(heavy,o2),35119)", 0), ("b(supposed(soda,o2),35119)", 0)}
    assert instance.price == 0
    assert instance.immediate


@pytest.mark.parametrize(
    ("fluent", "quantity"),
    [
        ("b(supposed(green,o3),105361)", r"bn\(colour\(o3\),v\(.*\),sd\(.*\),tol\(.*\),693147\)"),
        ("b(supposed(heavy,o3),105361)", r"bn\(weight\(o3\),v\(.*\),sd\(.*\),tol\(.*\),693147\)"),
        ("b(supposed(soda,o3),35120)", r"b\(type\(o3,soda\),35120\)"),
    ],
)
def test_a_property_follows_from_its_quantity(rulebook: Rulebook, fluent: str, quantity: str) -> None:
    _, preconditions = texts(only(rulebook, fluent))
    assert [f for f, _ in preconditions if re.fullmatch(quantity, f)]


def test_a_supposed_property_is_paid_for_once(rulebook: Rulebook) -> None:
    supposed = only(rulebook, "b(supposed(heavy,o2),105361)")
    stated = only(rulebook, "b(prop(heavy,o2),105361)")
    assert stated.price - supposed.price == nll(1 - _cdf((math.log(0.4) - math.log(0.3)) / 0.6))


def test_look_shows_colour_pose_and_type_and_needs_the_object_loose_and_in_view(rulebook: Rulebook) -> None:
    for fluent in (
        "bn(colour(o2),any,sd(20,50,50),any,1)",
        "bn(pose(o2),any,sd(8,8,any),any,1)",
        "b(type(o2,soda),35120)",
    ):
        instance = only(rulebook, fluent)
        assert str(instance.executes) == "look(o2)"
        assert {("krd(o2)", 0), ("loose(o2)", 0), ("at(look(o2))", 1)} <= texts(instance)[1]
        assert fluent in texts(instance)[0]


def test_a_look_that_cannot_do_it_alone_needs_the_belief_that_makes_it_enough(rulebook: Rulebook) -> None:
    _, preconditions = texts(only(rulebook, "bn(pose(o2),any,sd(4,4,any),any,1)"))
    assert ("bn(pose(o2),any,sd(6,6,any),any,1)", 0) in preconditions


def test_pick_needs_a_coarse_pose_first_and_a_tight_one_where_it_is_grasped(rulebook: Rulebook) -> None:
    right = next(i for i in offers(rulebook, things()).offers(parse_term("holding(o2)")) if "right" in str(i.step))
    assert texts(right)[1] == {
        ("krd(o2)", 0),
        ("empty(left)", 1),
        ("empty(right)", 1),
        ("bn(pose(o2),any,sd(50,50,any),any,223144)", 1),
        ("clear(pick(right,o2))", 2),
        ("bn(pose(o2),any,sd(8,8,any),any,223144)", 3),
        ("bn(pose(table1),any,sd(20,20,40),any,223144)", 3),
        ("at(pick(right,o2))", 3),
    }
    assert {str(d) for d in right.destroys} == {
        "empty(right)",
        "loose(o2)",
        "aside(o2,any)",
        "b(on(o2,any),any)",
    }


def test_what_stands_on_the_floor_is_picked_without_a_support(rulebook: Rulebook) -> None:
    believed = things()
    believed["o2"].on = None
    for instance in offers(rulebook, believed).offers(parse_term("holding(o2)")):
        assert not [f for f, _ in texts(instance)[1] if "table1" in f]


def test_the_arm_goes_over_a_support_only_when_it_is_localised(rulebook: Rulebook) -> None:
    _, preconditions = texts(only(rulebook, "b(on(o2,table1),105361)"))
    assert {("bn(pose(table1),any,sd(20,20,40),any,223144)", 2), ("at(place(o2,table1,nothing))", 2)} <= preconditions


def test_a_look_at_a_thing_shows_its_support_too_and_both_must_be_detected(rulebook: Rulebook) -> None:
    table = "bn(pose(table1),any,sd(20,20,40),any,223144)"
    by_step = {str(i.step): i for i in offers(rulebook, things()).offers(parse_term(table))}
    assert sorted(by_step) == ["look(o2)", "look(o3)", "look(table1)"]
    assert all(texts(instance)[0] == {table} for instance in by_step.values())
    both = by_step["look(o2)"].merged(only(rulebook, "bn(pose(o2),any,sd(8,8,any),any,1)"))
    assert both.price == 2 * nll(0.95)
    assert both.concrete == 1


def test_a_support_can_be_looked_at_from_where_things_are_placed_on_it_and_no_other_one(rulebook: Rulebook) -> None:
    mutexes, placing = read_mutexes(rulebook), parse_term("at(place(o2,table1,nothing))")
    assert not mutexes.exclude(parse_term("at(look(table1))"), placing)
    assert mutexes.exclude(parse_term("at(look(table2))"), placing)
    assert mutexes.exclude(placing, parse_term("at(look(o2))"))
    arriving = only(rulebook, "at(place(o2,table1,nothing))")
    assert texts(arriving)[0] == {"at(place(o2,table1,nothing))", "at(look(table1))"}


def test_weighing_is_for_the_right_hand_alone(rulebook: Rulebook) -> None:
    assert ("held(right,o2)", 1) in texts(only(rulebook, "bn(weight(o2),any,sd(100),any,1)"))[1]


def test_what_no_hand_can_hold_is_not_placed(rulebook: Rulebook) -> None:
    assert only(rulebook, "b(on(table1,table1),105361)").rejected == ("not_graspable",)


def test_placing_a_placeholder_stays_abstract(rulebook: Rulebook) -> None:
    instance = only(rulebook, "b(on(sk(var(o)),table1),105361)")
    assert instance.on_placeholder
    assert ("krd(sk(var(o)))", 0) in texts(instance)[1]


def test_every_step_that_is_carried_out_on_an_object_needs_its_rigid_designator_at_level_0(rulebook: Rulebook) -> None:
    fluents = [
        "bn(colour(o2),any,sd(20,50,50),any,1)",
        "bn(weight(o2),any,sd(100),any,1)",
        "holding(o2)",
        "b(on(o2,table1),105361)",
    ]
    table = offers(rulebook, things())
    physical = [i for f in fluents for i in table.offers(parse_term(f)) if i.executes is not None]
    assert {str(i.executes).partition("(")[0] for i in physical} == {"look", "weigh", "pick", "place"}
    assert all(("krd(o2)", 0) in texts(i)[1] for i in physical)


def test_an_existential_goal_may_be_about_each_plausible_anchor_or_one_not_met_yet(rulebook: Rulebook) -> None:
    facts = [parse_term("posed(b(den(e1,var(o)),105361))"), parse_term("open(var(o))")]
    assert [str(t) for _, t in offers(rulebook, things()).ask(facts)["instance"]] == ["o2", "sk(var(o))"]


def test_a_user_adds_a_colour_a_type_and_a_weight_word_by_a_rule_file_alone(tmp_path: Path) -> None:
    mine = tmp_path / "mine.lp"
    mine.write_text(
        "colour(turquoise, 165, 195, 40, 100, 20, 100).\n"
        "type(mug). cylinder(mug, 80, 80, 95). graspable(mug).\n"
        "weight(featherlight, 0, 50).\n"
    )
    extended = Rulebook.load(Queries, [mine])
    believed = things() | {"o5": Thing({"mug": 0.7}, hsv=(0.5, 0.8, 0.8), hsv_sd=0.4)}
    for fluent, needs in [
        ("b(supposed(turquoise,o5),105361)", "bn(colour(o5)"),
        ("b(supposed(mug,o5),105361)", "b(type(o5,mug)"),
        ("b(supposed(featherlight,o5),105361)", "bn(weight(o5)"),
    ]:
        _, preconditions = texts(only(extended, fluent, believed))
        assert any(f.startswith(needs) for f, _ in preconditions)
    assert {"Turquoise", "Mug", "Featherlight"} <= extended.vocabulary.words().keys()


def test_the_table_of_contents_names_every_rule_file() -> None:
    folder = RULES
    assert {path.stem for path in folder.glob("*.lp")} == set(RULE_FILES)


@pytest.mark.parametrize("name", RULE_FILES)
def test_a_rule_file_says_what_it_is_for_and_stays_short(name: str) -> None:
    text = (RULES / f"{name}.lp").read_text()
    assert text.startswith("%# ")
    assert "Output:" in text.partition("\n\n")[0] or "Output:" in text[:600]
    rules = re.sub(r"%\*.*?\*%", "", text, flags=re.DOTALL)
    statements = [line for line in rules.splitlines() if line.strip() and not line.startswith("%")]
    assert len(statements) <= (120 if name == "vocabulary" else 80)  # a dictionary grows with its words


def _cdf(x: float) -> float:
    return 0.5 * (1 + math.erf(x / math.sqrt(2)))


def _normal(half_width_of_green: float) -> float:
    return 2 * _cdf(half_width_of_green / 0.03) - 1
