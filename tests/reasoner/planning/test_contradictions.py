"""Goals that no world can satisfy are told of, and no others."""

import pytest
from hypothesis import given
from kit.descriptions import OBJECTS, RELATIONS, wide_goals
from kit.draws import examples
from kit.papers import shipped

from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.planning.contradictions import contradictions

NAMES = ("can1", "table1", "table2")


def found(goal: str) -> list[str]:
    book = shipped().vocabulary
    return contradictions(parse_goal(goal, book.words(), NAMES), book)


def described(body: str, kind: str = "lambda") -> str:
    return f"exists o. B(Den({kind} x. {body}, o), 0.9)"


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ("Can(x) & Soda(x)", "Can(o) and Soda(o) exclude each other"),
        ("Heavy(x) & Light(x)", "Heavy(o) and Light(o) exclude each other"),
        ("Light(x) & HeavierThan(x, 400)", "Light(o) and HeavierThan(o, 400) exclude each other"),
        ("Green(x) & Red(x)", "Green(o) and Red(o) exclude each other"),
        ("Red(x) & Orange(x)", "Red(o) and Orange(o) exclude each other"),
        ("On(x, table1) & In(x, table2)", "On(o, table1) and In(o, table2) exclude each other"),
        ("Was(On(x, table1) & On(x, table2))", "On(o, table1) and On(o, table2) exclude each other"),
        ("x != x", "o != o is never true"),
        ("table1 = table2", "table1 = table2 is never true"),
        ("Green(x) & not Green(x)", "Green(o) and not Green(o) exclude each other"),
        ("not (Green(x) | not Green(x))", "not Green(o) and Green(o) exclude each other"),
        ("(Can(x) | Bottle(x)) & Soda(x)", "Can(o) and Soda(o) exclude each other"),
        ("exists y. Near(x, y) & Can(y) & Soda(y)", "exclude each other"),
        ("at least 2 y. Can(y) & Soda(y)", "exclude each other"),
        ("not at most 1 y. Can(y) & Soda(y)", "exclude each other"),
        ("not (every y. Can(y) -> Can(y))", "exclude each other"),
    ],
)
@pytest.mark.parametrize("kind", ["lambda", "the", "heaviest", "nearest"])
def test_a_description_of_nothing_is_told_of_with_the_parts_that_exclude_each_other(
    body: str, why: str, kind: str
) -> None:
    head = f"{kind} x to can1" if kind == "nearest" else f"{kind} x"
    [fault] = found(f"exists o. B(Den({head}. {body}, o), 0.9)")
    assert "it can never be true, since" in fault
    assert why in fault


@pytest.mark.parametrize(
    "body",
    [
        "Can(x) | Soda(x)",
        "Can(x) & not Soda(x)",
        "Heavy(x) & HeavierThan(x, 300)",
        "Green(x) & Heavy(x) & Can(x)",
        "Was(On(x, table1)) & On(x, table2)",
        "On(x, table1) & not On(x, table2)",
        "Can(x) & (exists y. Soda(y))",
        "every y. Can(y) -> Soda(y)",
        "not exists y. Can(y) & Soda(y)",
        "exactly 0 y. Can(y) & Soda(y)",
        "at most 2 y. Can(y) & Soda(y)",
        "exists y. On(x, y) & On(x, table1)",
        "x != table1",
        "not Red(x) & not Green(x)",
        "not Heavy(x) & not Light(x)",  # false in every world, and not found out
    ],
)
def test_a_description_of_something_is_not(body: str) -> None:
    assert found(described(body)) == []


@pytest.mark.parametrize(
    ("goal", "why"),
    [
        ("B(Den(lambda x. On(x, table1), o), 0.9) & B(On(o, table2), 0.9)", "say Was(On(o, table1))"),
        ("B(Den(lambda x. Can(x), o), 0.9) & B(Soda(o), 0.9)", "Can(o) and Soda(o)"),
        ("B(Holds((Can, Green), o), 0.6) & B(Red(o), 0.6)", "Green(o) and Red(o)"),
        ("B(Den(lambda x. exists y. On(x, y), o) & On(o, table1), 0.6) & B(In(o, table2), 0.6)", "On(o, table1)"),
        (
            "B(not On(can1, table1), 0.9) & B(On(can1, table1), 0.9) & KRD(o)",
            "not On(can1, table1) and On(can1, table1)",
        ),
    ],
)
def test_two_beliefs_that_exclude_each_other_are_told_of(goal: str, why: str) -> None:
    [fault] = found(f"exists o. {goal}")
    assert "both can never be believed, since" in fault
    assert why in fault


@pytest.mark.parametrize(
    "goal",
    [
        "exists o. B(Den(the x. On(x, table1), o), 0.9) & B(On(o, table2), 0.9)",
        "exists o. B(Den(lambda x. Was(On(x, table1)), o), 0.9) & B(On(o, table2), 0.9)",
        "exists o. B(Can(o), 0.5) & B(Soda(o), 0.5)",
        "exists o, p. B(Can(o), 0.9) & B(Soda(p), 0.9)",
        "exists o, p. B(Den(lambda x. exists y. On(y, x) & Can(y), o), 0.9)"
        " & B(Den(lambda x. exists y. On(x, y) & Soda(y), p), 0.9)",
        "B(exists x. Can(x), 0.9) & B(exists x. Soda(x), 0.9)",
    ],
)
def test_beliefs_that_some_world_satisfies_are_not(goal: str) -> None:
    assert found(goal) == []


def test_parts_of_one_belief_exclude_each_other() -> None:
    [fault] = found("exists o. B(Den(lambda x. Can(x), o) & Soda(o), 0.6)")
    assert "it can never be true, since Can(o) and Soda(o) exclude each other" in fault


def test_what_has_too_many_ways_is_not_judged() -> None:
    either = " & ".join(["(Can(x) | Bottle(x))"] * 20)
    assert found(described(f"{either} & Green(x)")) == []


@given(wide_goals())
@examples(60)
def test_any_goal_can_be_judged(goal: object) -> None:
    book = shipped().vocabulary
    read = parse_goal(str(goal), {**RELATIONS, **book.words()}, OBJECTS)
    assert all("never" in fault for fault in contradictions(read, book))
