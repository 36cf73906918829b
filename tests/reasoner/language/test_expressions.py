"""Goals as fluents: one term per conjunct, in the order of their text."""

import pytest
from hypothesis import given
from kit.descriptions import OBJECTS, RELATIONS, goals
from kit.draws import examples

from skolem.reasoner.language.descriptions import constant_of, word_of
from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.terms import parse_term


def fluents(text: str) -> list[str]:
    return [str(fluent) for fluent in parse_goal(text, RELATIONS, OBJECTS).fluents]


def test_a_description_an_existential_variable_and_a_support() -> None:
    goal = parse_goal("exists o. B(Den(lambda x. Green(x), o), 0.9) & B(On(o, table1), 0.9) & KRD(o)", RELATIONS)
    assert [str(f) for f in goal.fluents] == ["b(den(e1,var(o)),105361)", "b(on(var(o),table1),105361)", "krd(var(o))"]
    assert {name: str(found) for name, found in goal.expressions.items()} == {"e1": "lambda x. Green(x)"}
    assert goal.variables == ("o",)


def test_an_anchor_stands_for_itself() -> None:
    assert fluents("B(Den(lambda x. Green(x), sodaE), 0.9) & KRD(_o1_)") == ["b(den(e1,sodaE),105361)", "krd(_o1_)"]


def test_equal_descriptions_share_a_constant() -> None:
    goal = parse_goal(
        "B(Den(lambda x. Red(x), sodaE), 0.9) & B(Den(lambda x. Green(x), sodaE), 0.8)"
        " & B(Den(lambda x. Red(x), table1), 0.5)",
        RELATIONS,
    )
    assert list(goal.expressions) == ["e1", "e2"]
    assert [str(f) for f in goal.fluents] == [
        "b(den(e1,sodaE),105361)",
        "b(den(e1,table1),693147)",
        "b(den(e2,sodaE),223144)",
    ]


@pytest.mark.parametrize(
    ("text", "fluent"),
    [
        ("B(Green(sodaE), 0.9)", "b(prop(green,sodaE),105361)"),
        ("B(In(sodaE, table1), 0.5)", "b(on(sodaE,table1),693147)"),
        ("B(Holds((Green, Soda), sodaE), 0.9)", "b(holds((green,soda),sodaE),105361)"),
        ("B(Holds((Green), sodaE), 0.9)", "b(holds((green,),sodaE),105361)"),
        ("B(HeavierThan(sodaE, table1), 0.9)", "b(heavier_than(sodaE,table1),105361)"),
        (
            "B(Pose(sodaE), any, (0.01, 0.01, 0.05), (0.1, 0.1, 0.1), 0.9)",
            "bn(pose(sodaE),any,sd(10,10,50),tol(100,100,100),105361)",
        ),
        ("B(Weight(sodaE), -1.2, 0.2, 0.1, 0.9)", "bn(weight(sodaE),v(-1200),sd(200),tol(100),105361)"),
        (
            "B(Color(sodaE), (0.33, 0.7, 0.6), (0.1, 0.1, 0.1), (0.05, 0.2, 0.2), 0.9)",
            "bn(colour(sodaE),v(330,700,600),sd(100,100,100),tol(50,200,200),105361)",
        ),
    ],
)
def test_each_kind_of_belief_has_its_fluent(text: str, fluent: str) -> None:
    assert fluents(text) == [fluent]


@given(goals())
@examples(40)
def test_fluents_are_terms_that_clingo_reads_in_a_fixed_order(goal: Goal) -> None:
    texts = [str(fluent) for fluent in goal.fluents]
    assert [parse_term(text) for text in texts] == list(goal.fluents)
    assert texts == sorted(set(texts))


@pytest.mark.parametrize(("word", "constant"), [("Green", "green"), ("SodaBox", "soda_box"), ("Type2", "type2")])
def test_words_and_constants_correspond(word: str, constant: str) -> None:
    assert constant_of(word) == constant
    assert word_of(constant) == word
