"""Goal texts: what is read, what is refused, and where a fault is shown."""

import pytest
from hypothesis import given, strategies as st
from kit.descriptions import OBJECTS, RELATIONS, wide_goals, wide_lambdas
from kit.draws import examples

from skolem.reasoner.language.description_parser import KINDS
from skolem.reasoner.language.descriptions import (
    And,
    Atom,
    Count,
    Every,
    Exists,
    Lambda,
    Name,
    Not,
    Or,
    Same,
    Variable,
    Was,
)
from skolem.reasoner.language.expressions import Believed, Den, Goal, Holds, Sentence, Together
from skolem.reasoner.language.parser import parse_goal, parse_lambda, read_goal
from skolem.traces.errors import InputError

GREEN, RED, X = Atom("Green", (Variable("x"),)), Atom("Red", (Variable("x"),)), Variable("x")
SODA = Atom("Soda", (X,))
Y, Z = Variable("y"), Variable("z")


def described(text: str) -> Lambda:
    return parse_lambda(text, RELATIONS, OBJECTS)


@given(wide_goals())
@examples(150)
def test_a_goal_prints_as_text_that_reads_back_equal(goal: Goal) -> None:
    assert parse_goal(str(goal), RELATIONS, OBJECTS) == goal


@given(wide_lambdas())
@examples(150)
def test_a_description_prints_as_text_that_reads_back_equal(description: Lambda) -> None:
    assert described(str(description)) == description


@given(st.text(alphabet="BDenKRDo x.lambdaexists(),&|G01 \n∃λ∧∨¬∀→!=-<", max_size=60))  # noqa: RUF001 - signs are meant
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
    ("text", "body"),
    [
        ("not Green(x) & Red(x)", And(Not(GREEN), RED)),
        ("not (Green(x) & Red(x))", Not(And(GREEN, RED))),
        ("not not Green(x)", Not(Not(GREEN))),
        ("x = sodaE", Same(X, Name("sodaE"))),
        ("Green(x) | x != sodaE", Or(GREEN, Not(Same(X, Name("sodaE"))))),
        ("every y. Soda(y) -> On(y, x)", Every("y", Atom("Soda", (Y,)), Atom("On", (Y, X)))),
        ("every y. exists z. On(y, z) -> x != y", Every("y", Exists("z", Atom("On", (Y, Z))), Not(Same(X, Y)))),
        ("exactly 2 y. On(y, x) & Green(x)", Count("exactly", 2, "y", And(Atom("On", (Y, X)), GREEN))),
        ("at least 0 y. On(y, x)", Count("at least", 0, "y", Atom("On", (Y, X)))),
        ("at most 20 y. On(y, x)", Count("at most", 20, "y", Atom("On", (Y, X)))),
        ("Was(Green(x) | Red(x)) & Soda(x)", And(Was(Or(GREEN, RED)), SODA)),
        ("HeavierThan(x, sodaE)", Atom("HeavierThan", (X, Name("sodaE")))),
    ],
)
def test_negation_counts_every_and_identity_are_read(text: str, body: object) -> None:
    assert described(f"lambda x. {text}").body == body


@pytest.mark.parametrize("kind", ["lambda", "the", "heaviest", "lightest"])
def test_descriptions_have_kinds(kind: str) -> None:
    assert described(f"{kind} x. Green(x)") == Lambda("x", GREEN, next(each for each in KINDS if each == kind))


def test_the_nearest_is_nearest_to_a_named_object() -> None:
    assert described("nearest x to table1. Green(x)") == Lambda("x", GREEN, "nearest", Name("table1"))


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("∃ o. B(Den(λ x. Green(x) ∧ ¬Red(x), o), 0.9)", "exists o. B(Den(lambda x. Green(x) & not Red(x), o), 0.9)"),
        ("∃o. B(Den(λx. Green(x) ∨ x ≠ sodaE, o), .9)", "exists o. B(Den(lambda x. Green(x) | x != sodaE, o), 0.9)"),  # noqa: RUF001
        ("B(∀ x. Soda(x) → On(x, table1), 0.9)", "B(every x. Soda(x) -> On(x, table1), 0.9)"),
        ("B(forall x. Soda(x) -> On(x, table1), 0.9)", "B(every x. Soda(x) -> On(x, table1), 0.9)"),
        ("B(Den(iota x. Green(x), sodaE), 0.9)", "B(Den(the x. Green(x), sodaE), 0.9)"),
    ],
)
def test_signs_of_the_paper_and_other_spellings_mean_the_same(text: str, plain: str) -> None:
    assert str(parse_goal(text, RELATIONS, OBJECTS)) == plain


def test_carets_stand_right_behind_signs_of_several_bytes() -> None:
    text = "∃ o. B(Den(λ x. Green(x) ∧ ¬Gren(x), o), 0.9)"
    with pytest.raises(InputError) as caught:
        parse_goal(text, RELATIONS, OBJECTS)
    [fault] = caught.value.faults
    assert text[fault.column - 1 :].startswith("Gren(x)")
    assert str(fault).splitlines()[2].index("^") == str(fault).splitlines()[1].index("Gren")


def test_a_head_says_which_variables_are_different_objects() -> None:
    goal = parse_goal("exists o. exists distinct p, q. KRD(o) & KRD(p) & KRD(q)", RELATIONS)
    assert (goal.variables, goal.distinct) == (("o", "p", "q"), (("p", "q"),))


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("Green(sodaE)", Atom),
        ("(Green(sodaE))", Atom),
        ("Den(lambda x. not Green(x) | Red(x), o)", Den),
        ("Holds((Green, Red), o)", Holds),
        ("Green(sodaE) & Red(o)", Together),
        ("And(Green(sodaE), Red(sodaE))", Together),
        ("(Den(lambda x. exists y. On(x, y), o) & On(o, table1)) & Red(o)", Together),
        ("Green(sodaE) | Red(sodaE)", Sentence),
        ("not Green(sodaE) & On(sodaE, table1)", Sentence),
        ("On(sodaE, table1) & not Green(sodaE)", Sentence),
        ("sodaE != table1", Sentence),
        ("exactly 2 x. Green(x) & On(x, table1)", Sentence),
        ("every x. Soda(x) -> On(x, table1)", Sentence),
        ("not exists x. HeavierThan(x, 400)", Sentence),
        ("Was(On(sodaE, table1))", Sentence),
    ],
)
def test_what_is_believed_is_of_one_kind(text: str, kind: type) -> None:
    goal = parse_goal(f"exists o. KRD(o) & B({text}, 0.9)", RELATIONS, OBJECTS)
    found = goal.conjuncts[1]
    assert isinstance(found, Believed)
    assert type(found.phi) is kind


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("B(Den(lambda x. !Green(x), sodaE), 0.9)", 17, "negation is written 'not'"),
        ("B(Den(lambda x. Not(Green(x)), sodaE), 0.9)", 17, "negation is written 'not'"),
        ("B(Den(lambda x. -Green(x), sodaE), 0.9)", 17, "negation is written 'not'"),
        ("not B(Green(sodaE), 0.9)", 1, "negation is written 'not', inside of a description or of B(..)"),
        ("forall o. KRD(o)", 1, "'every' stands inside of B(..) or of a description"),
        ("exactly 2 o. KRD(o)", 1, "counts stand inside of B(..)"),
        ("exists 2 o. KRD(o)", 8, "expected a variable, found '2'; counts are written at least 2 x. Can(x)"),
        ("exists the. KRD(the)", 8, "expected a variable, found 'the', a word of the goal language"),
        ("exists o, distinct p, q. KRD(o)", 11, "at the head of a goal, write exists distinct o, p."),
        ("exists o, p. KRD(o) & o != p", 25, "at the head of a goal, write exists distinct o, p."),
        ("B(On(the x. Soda(x), table1), 0.9)", 6, "exists o. B(Den(the x. .., o), p) & B(On(o, ..), p)"),
        ("B(On(sodaE, heaviest x. Soda(x)), 0.9)", 13, "B(Den(heaviest x. .., o), p) & B(On(.., o), p)"),
        ("KRD(the x. Soda(x))", 5, "exists o. B(Den(the x. .., o), p) & KRD(o)"),
        ("B(the x. Soda(x), 0.9)", 3, "'the' begins a description: Den(the x. Can(x), o)"),
        ("B(Den(lambda x. Soda(x), o) & not On(o, t), 0.9)", 31, "'not' cannot stand beside Den(..)"),
        ("B(Den(lambda x. Soda(x) -> Red(x), o), 0.9)", 25, "'->' follows the condition of 'every'; elsewhere write"),
        ("B(Den(lambda x. Soda(x) <-> Red(x), o), 0.9)", 25, "write (A & B) | (not A & not B)"),
        ("B(Den(lambda x. Soda(x) xor Red(x), o), 0.9)", 25, "write (A | B) & not (A & B)"),
        ("B(Den(lambda x. Soda(x) and Red(x), o), 0.9)", 25, "write & for 'and'"),
        ("B(Den(lambda x. exists distinct y, z. Red(y), o), 0.9)", 24, "write x != y inside of a description"),
        ("B(Den(reddest x. Soda(x), o), 0.9)", 7, "superlatives are heaviest, lightest and nearest"),
        ("B(Den(lambda x. Heaviest(x), o), 0.9)", 17, "'heaviest' begins a description: Den(heaviest x. Can(x), o)"),
        ("B(Den(nearest x. Soda(x), o), 0.9)", 16, "expected 'to' and the name of an object"),
        ("B(most x. Soda(x), 0.9)", 3, "'most' is not part of the goal language; state a number: at least 2"),
        ("B(every x. Soda(x), 0.9)", 19, "expected '->' and what holds of every such object"),
        ("B(exactly x. Soda(x), 0.9)", 11, "expected a number, found 'x'"),
        (
            "B(at lest 2 x. Soda(x), 0.9)",
            6,
            "expected 'least' or 'most' after 'at', found 'lest'; did you mean 'least'?",
        ),
        ("B(atleast 2 x. Soda(x), 0.9)", 3, "did you mean 'at least'?"),
        ("B(Den(heavyest x. Soda(x), o), 0.9)", 7, "did you mean 'heaviest'?"),
        ("B(Den(lamda x. Soda(x), o), 0.9)", 7, "did you mean 'lambda'?"),
        ("exsts o. KRD(o)", 1, "did you mean 'exists'?"),
        ("B(den(lambda x. Soda(x), o), 0.9)", 3, "did you mean 'Den'?"),
        ("B(exists a, b, c, d. exists e. Soda(e), 0.9)", 29, "more than 4 quantifiers inside one another"),
        ("B(Den(lambda x. exists a, b, c, d, e. Red(e), o), 0.9)", 36, "more than 4 quantifiers inside one another"),
        ("", 1, "expected B(phi, p), B(phi, mu, Sigma, Delta, p) or KRD(o), found the end"),
        ("B(Green(sodaE), 0.9", 20, "expected ')', found the end"),
        ("B(Green(sodaE) 0.9)", 16, "expected ',' and a probability, found '0.9'"),
        ("B(Green(sodaE), 0.9) B(Red(sodaE), 0.9)", 22, "expected '&' or the end, found 'B'"),
        ("KRD(sodaE) | B(Red(sodaE), 0.9)", 12, "'|' cannot stand between beliefs; it works inside a lambda: B(Den("),
        ("(KRD(sodaE) | KRD(sodaB)) & KRD(o)", 13, "'|' cannot stand between beliefs; it works inside a lambda"),
        ("B(Holds((Green), sodaE) | Red(sodaE), 0.9)", 25, "'|' cannot stand between facts; it works inside a lambda"),
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
        (
            "exists o. B(Green(o) | Red(o), 0.9)",
            19,
            "variable 'o' of the goal cannot stand inside a sentence; describe",
        ),
        (
            "exists o. B(Den(nearest x to o. Red(x), o), 0.9)",
            30,
            "expected the name of an object after 'to', found the v",
        ),
        ("exists distinct o. KRD(o)", 17, "one variable alone is not distinct"),
        ("B(exactly 21 x. Soda(x), 0.9)", 11, "expected a whole number from 0 to 20, found 21"),
        ("B(at most 1.5 x. Soda(x), 0.9)", 11, "expected a whole number from 0 to 20, found 1.5"),
        ("B(exists y. (every z. Red(z) -> Red(y)) & Red(z), 0.9)", 47, "variable 'z' is not bound here"),
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
