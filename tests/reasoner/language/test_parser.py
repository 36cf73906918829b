"""Goal texts: what is read, what is refused, and where a fault is shown."""

import pytest
from hypothesis import given, strategies as st
from kit.descriptions import OBJECTS, RELATIONS, goals, lambdas
from kit.draws import examples

from skolem.reasoner.language.descriptions import And, Atom, Exists, Lambda, Name, Or, Variable
from skolem.reasoner.language.expressions import Believed, Den, Goal
from skolem.reasoner.language.parser import parse_goal, parse_lambda, read_goal
from skolem.traces.errors import InputError

GREEN, RED, X = Atom("Green", (Variable("x"),)), Atom("Red", (Variable("x"),)), Variable("x")
SODA = Atom("Soda", (X,))


def described(text: str) -> Lambda:
    return parse_lambda(text, RELATIONS, OBJECTS)


@given(goals())
@examples(60)
def test_a_goal_prints_as_text_that_reads_back_equal(goal: Goal) -> None:
    assert parse_goal(str(goal), RELATIONS, OBJECTS) == goal


@given(lambdas(numbers=True))
@examples(60)
def test_a_description_prints_as_text_that_reads_back_equal(description: Lambda) -> None:
    assert described(str(description)) == description


@given(st.text(alphabet="BDenKRDo x.lambdaexists(),&|G01 \n", max_size=60))
def test_no_text_breaks_the_parser(text: str) -> None:
    for offset, message in read_goal(text, RELATIONS, OBJECTS)[1]:
        assert 0 <= offset <= len(text)
        assert message


def test_the_goal_of_the_first_simulation() -> None:
    text = "exists o. B(Den(lambda x. Green(x), o), 0.9) & B(In(o, table1), 0.9)"
    expected = Goal(
        ("o",),
        (
            Believed(Den(Lambda("x", GREEN), Variable("o")), 0.9),
            Believed(Atom("In", (Variable("o"), Name("table1"))), 0.9),
        ),
    )
    assert parse_goal(text, RELATIONS, OBJECTS) == expected


@pytest.mark.parametrize(
    ("text", "body"),
    [
        ("Green(x) & Red(x) | Soda(x)", Or(And(GREEN, RED), SODA)),
        ("Green(x) | Red(x) & Soda(x)", Or(GREEN, And(RED, SODA))),
        ("Green(x) & (Red(x) | Soda(x))", And(GREEN, Or(RED, SODA))),
        ("And(Green(x), Or(Red(x), Soda(x)))", And(GREEN, Or(RED, SODA))),
        ("And(Green(x), Red(x), Soda(x))", And(And(GREEN, RED), SODA)),
        ("exists y. Green(x) & Red(x)", Exists("y", And(GREEN, RED))),
        ("Exists(y, Green(x)) & Red(x)", And(Exists("y", GREEN), RED)),
        ("exists y, z. Green(x)", Exists("y", Exists("z", GREEN))),
    ],
)
def test_connectives_bind_as_documented(text: str, body: object) -> None:
    assert described(f"lambda x. {text}").body == body


def test_a_binder_that_reuses_a_name_is_renamed_apart() -> None:
    found = described("lambda x. Green(x) & exists x. (Red(x) & exists x. Soda(x))")
    assert str(found) == "lambda x. Green(x) & (exists x_2. Red(x_2) & (exists x_3. Soda(x_3)))"


def test_a_new_name_is_not_one_that_the_text_uses() -> None:
    names = [*OBJECTS, "x_2"]
    found = parse_lambda("lambda x. exists x. On(x, x_2)", RELATIONS, names)
    assert found.body == Exists("x_3", Atom("On", (Variable("x_3"), Name("x_2"))))


def test_the_variable_of_a_goal_and_of_its_description_are_kept_apart() -> None:
    goal = parse_goal("exists o. B(Den(lambda o. Green(o), o), 0.9)", RELATIONS, OBJECTS)
    assert str(goal) == "exists o. B(Den(lambda o_2. Green(o_2), o), 0.9)"


def test_a_variable_bound_in_another_branch_is_not_bound_here() -> None:
    with pytest.raises(InputError) as caught:
        described("lambda x. (exists y. Red(y)) & Green(y)")
    assert [(f.column, f.message) for f in caught.value.faults] == [(38, "variable 'y' is not bound here")]


def test_without_a_list_of_objects_every_name_is_accepted() -> None:
    assert parse_lambda("lambda x. On(x, desk)", RELATIONS).body == Atom("On", (X, Name("desk")))


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("B(Den(lambda x. !Green(x), sodaE), 0.9)", 17, "negation is not part of the goal language"),
        ("B(Den(lambda x. not Green(x), sodaE), 0.9)", 17, "negation is not part of the goal language"),
        ("B(Den(lambda x. Not(Green(x)), sodaE), 0.9)", 17, "negation is not part of the goal language"),
        ("B(Den(the x. Green(x), sodaE), 0.9)", 7, "definite descriptions are not supported"),
        ("forall o. KRD(o)", 1, "only existential variables"),
        ("", 1, "expected B(phi, p), B(phi, mu, Sigma, Delta, p) or KRD(o), found the end"),
        ("B(Green(sodaE), 0.9", 20, "expected ')', found the end"),
        ("B(Green(sodaE) 0.9)", 16, "expected ',' and a probability, found '0.9'"),
        ("B(Green(sodaE), 0.9) B(Red(sodaE), 0.9)", 22, "expected '&' or the end, found 'B'"),
        ("KRD(sodaE) | B(Red(sodaE), 0.9)", 12, "'|' cannot stand between beliefs; it works inside a lambda: B(Den("),
        ("(KRD(sodaE) | KRD(sodaB)) & KRD(o)", 13, "'|' cannot stand between beliefs; it works inside a lambda"),
        ("B(Green(sodaE) | Red(sodaE), 0.9)", 16, "'|' cannot stand between facts; it works inside a lambda"),
        ("B(green(sodaE), 0.9)", 3, "expected a fact such as Den(lambda x. Green(x), o)"),
        ("B(Green(sodaE), p)", 17, "expected a number, found 'p'"),
        ("B(Green(sodaE), 0.9) ; KRD(sodaE)", 22, "unexpected ';'"),
        ("B(Pose(sodaE), 0.9)", 19, "expected ',' and Sigma of B(phi, mu, Sigma, Delta, p), found ')'"),
        ("B(Holds(Green, sodaE), 0.9)", 9, "expected '(' and properties: Holds((Green, Can), o)"),
        ("exists any. KRD(any)", 8, "expected a variable"),
        ("(" * 200, 101, "more than 100 parts"),
        ("KRD(o) & " * 2000, 1, "a goal of 18000 characters; at most 10000 are read"),
    ],
)
def test_a_sentence_that_cannot_be_read_stops_with_what_was_expected(text: str, column: int, message: str) -> None:
    offset, found = read_goal(text, RELATIONS)[1][-1]
    assert offset == column - 1
    assert message in found


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("B(Gren(sodaE), 0.9)", 3, "no relation 'Gren'; did you mean 'Green'?"),
        ("B(On(sodaE), 0.9)", 3, "On takes 2 arguments, not 1"),
        ("B(Green(sodaE, table1), 0.9)", 3, "Green takes 1 argument, not 2"),
        ("B(Green(sodaB), 0.9)", 9, "'sodaB' is neither a bound variable nor a known object; did you mean 'sodaE'?"),
        ("B(Green(sodaE), 1)", 17, "expected a probability between 0 and 1, both excluded, found 1"),
        ("B(Green(sodaE), 0)", 17, "expected a probability between 0 and 1, both excluded, found 0"),
        ("B(On(sodaE, 400), 0.9)", 13, "expected an object, found the number 400"),
        ("B(Den(lambda x. Green(4), sodaE), 0.9)", 23, "expected an object, found the number 4"),
        ("exists o, o. KRD(o)", 11, "variable 'o' is bound twice"),
        ("exists o, q. KRD(o)", 11, "variable 'q' is never used"),
        ("exists o. B(Den(lambda x. On(x, o), o), 0.9)", 33, "variable 'o' of the goal cannot stand inside"),
        ("B(Holds((Green, Gren), sodaE), 0.9)", 17, "no relation 'Gren'; did you mean 'Green'?"),
        ("B(Color(sodaE), any, (0.1, 0.1), (1, 1, 1), 0.9)", 22, "of a colour has 3 components, not 2"),
        ("B(Weight(sodaE), any, 0, 1, 0.9)", 23, "Sigma, as standard deviations, has components from 0.001"),
        ("B(Weight(sodaE), 1e9999, 1, 1, 0.9)", 18, "1e9999 is too large a number"),
    ],
)
def test_what_a_sentence_says_is_checked_too(text: str, column: int, message: str) -> None:
    offset, found = read_goal(text, RELATIONS, OBJECTS)[1][0]
    assert offset == column - 1
    assert message in found


def test_every_fault_is_reported_at_once_with_line_and_caret() -> None:
    text = "exists o. B(Den(lambda x. Gren(x), o), 1.2)\n  & B(On(o, table7), 0.9)"
    with pytest.raises(InputError) as caught:
        parse_goal(text, RELATIONS, ["table1"])
    assert str(caught.value) == "\n".join(
        [
            "goal:1:27: no relation 'Gren'; did you mean 'Green'?",
            "    exists o. B(Den(lambda x. Gren(x), o), 1.2)",
            "                              ^",
            "goal:1:40: expected a probability between 0 and 1, both excluded, found 1.2",
            "    exists o. B(Den(lambda x. Gren(x), o), 1.2)",
            "                                           ^",
            "goal:2:13: 'table7' is neither a bound variable nor a known object; did you mean 'table1'?",
            "    & B(On(o, table7), 0.9)",
            "              ^",
        ]
    )
