"""B5: descriptions are indefinite: several, one or no object may satisfy them."""

import pytest
from kit.papers import Handler, at_five_percent, can, denotes, posed, seen_as

GREEN_RGB, RED_RGB = (0.08, 0.64, 0.08), (0.64, 0.08, 0.08)
LEFT, RIGHT = (1.0, 0.2, 0.7, 0.0), (1.0, -0.2, 0.7, 0.0)
GOAL = "exists o. B(Den(lambda x. Green(x), o), 0.9)"


@pytest.mark.parametrize(
    ("left", "right", "fitting"),
    [(GREEN_RGB, GREEN_RGB, ["a", "b"]), (RED_RGB, GREEN_RGB, ["b"]), (RED_RGB, RED_RGB, [])],
    ids=["two", "one", "none"],
)
def test_two_one_or_no_object_may_be_denoted(
    left: tuple[float, float, float], right: tuple[float, float, float], fitting: list[str]
) -> None:
    """ "One might be true simultaneously for many different values of obj, or none at all." """
    robot = Handler(at_five_percent([can("a", 1.0, LEFT), can("b", 1.0, RIGHT)]))
    robot.see(seen_as(LEFT, rgb=left), seen_as(RIGHT, rgb=right))
    assert [name for name, p in denotes("lambda x. Green(x)", robot.belief).items() if p >= 0.9] == fitting
    assert (posed(GOAL, robot.belief).achieved() is not None) is bool(fitting)


def test_legal_expressions_are_conjunctions_disjunctions_and_existential_quantification() -> None:
    """ "Legal expressions include conjunctions, disjunctions, and existential quantification." """
    robot = Handler(at_five_percent([can("a", 1.0, LEFT), can("b", 1.0, RIGHT)]))
    robot.see(seen_as(LEFT, rgb=GREEN_RGB), seen_as(RIGHT, rgb=RED_RGB))
    likely = {
        "lambda x. Soda(x) & Red(x)": ["b"],
        "lambda x. Red(x) | Green(x)": ["a", "b"],
        "lambda x. exists y. (On(x, y) & Table(y))": ["a", "b"],
        "lambda x. exists y. (On(y, x) & Green(y))": ["table1"],
        "lambda x. Table(x) & Green(x)": [],
    }
    for text, expected in likely.items():
        assert sorted(name for name, p in denotes(text, robot.belief).items() if p >= 0.9) == expected
