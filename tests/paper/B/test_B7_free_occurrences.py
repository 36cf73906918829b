"""B7: a substitution replaces free occurrences only."""

import pytest
from kit.papers import Handler, at_five_percent, can, denotes, posed, seen_as, shipped

from skolem.reasoner.language.parser import parse_lambda

LEFT, RIGHT = (1.0, 0.2, 0.7, 0.0), (1.0, -0.2, 0.7, 0.0)
RED_RGB = (0.64, 0.08, 0.08)


def one_green_one_red() -> Handler:
    """A red soda on the left, a green bottle on the right."""
    robot = Handler(at_five_percent([can("red_soda", 0.99, LEFT), can("green_bottle", 0.01, RIGHT)]))
    robot.see(seen_as(LEFT, rgb=RED_RGB), seen_as(RIGHT, kind="bottle"))
    return robot


def test_a_variable_that_is_bound_again_is_another_variable() -> None:
    """ "The application of a substitution replaces all free occurrences of each variable." """
    belief = one_green_one_red().belief
    values = denotes("lambda x. Soda(x) & exists x. Green(x)", belief)
    assert values["red_soda"] > 0.9  # a soda, and something is green: not itself
    assert values["green_bottle"] < 0.1
    assert denotes("lambda x. Soda(x) & Green(x)", belief)["red_soda"] < 0.1


def test_renaming_the_inner_variable_changes_nothing() -> None:
    """ "All free occurrences": bound ones can be called as one likes."""
    belief = one_green_one_red().belief
    same = [denotes(f"lambda x. Soda(x) & exists {v}. Green({v})", belief) for v in ("x", "y")]
    assert same[0] == same[1]
    words = shipped().vocabulary.words()
    assert str(parse_lambda("lambda x. Soda(x) & exists x. Green(x)", words)) == (
        "lambda x. Soda(x) & (exists x_2. Green(x_2))"
    )


def test_after_the_inner_scope_the_outer_variable_is_meant_again() -> None:
    """ "Free occurrences": the scope of the inner binder ends where its expression ends."""
    belief = one_green_one_red().belief
    values = denotes("lambda x. (exists x. Green(x)) & Red(x)", belief)
    assert (values["red_soda"] > 0.9, values["green_bottle"] < 0.1) == (True, True)


def test_the_variable_of_the_goal_is_not_captured_by_the_description() -> None:
    """ "sigma(expr) stands for the expression that results from applying substitution sigma." """
    goal = "exists x. B(Den(lambda x. Soda(x) & exists y. (Green(y)), x), 0.9) & B(On(x, table1), 0.9)"
    achieved = posed(goal, one_green_one_red().belief).achieved()
    assert achieved is not None
    assert any("den(e1,red_soda)" in str(fluent) for fluent in achieved)


@pytest.mark.parametrize("text", ["lambda x. exists x. Green(x)", "lambda x. exists y. Green(y)"])
def test_a_description_that_does_not_mention_its_variable_holds_of_everything_or_nothing(text: str) -> None:
    """ "Exists(X, expr): the disjunction over o of {X : o}(expr)." """
    values = denotes(text, one_green_one_red().belief)
    assert max(values.values()) == pytest.approx(min(values.values()), abs=0.02)
