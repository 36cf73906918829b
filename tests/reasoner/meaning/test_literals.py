"""Literals: the sets of properties that make a description true or false, against all assignments of truth."""

from itertools import product

from hypothesis import given, strategies as st
from kit.papers import shipped

from skolem.reasoner.language.descriptions import And, Atom, Expression, Lambda, Not, Or, Variable
from skolem.reasoner.language.parser import parse_lambda
from skolem.reasoner.meaning.literals import MOST_ALTERNATIVES, Literals
from skolem.traces.messages import WeightInterval

NAMES = ("soda", "green", "heavy", "red")  # heavy has one complement, as it is bounded on one side
ATOMS = [Atom(name.capitalize(), (Variable("x"),)) for name in NAMES]


def bodies() -> st.SearchStrategy[Expression]:
    def grown(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
        return st.one_of(st.builds(And, inner, inner), st.builds(Or, inner, inner), st.builds(Not, inner))

    return st.recursive(st.sampled_from(ATOMS), grown, max_leaves=5)


def truth(expression: Expression, having: frozenset[str]) -> bool:
    match expression:
        case And(left, right):
            return truth(left, having) and truth(right, having)
        case Or(left, right):
            return truth(left, having) or truth(right, having)
        case Not(body):
            return not truth(body, having)
        case Atom(word, _):
            return word.lower() in having
    raise AssertionError(expression)


def said(words: tuple[str, ...], having: frozenset[str]) -> bool:
    """Return whether an object with some properties has all that a set names, complements too."""
    return all((word.removeprefix("not__") in having) != word.startswith("not__") for word in words)


@given(bodies())
def test_the_sets_are_true_exactly_where_the_description_is(body: Expression) -> None:
    literals, description = Literals(shipped().vocabulary), Lambda("x", body)
    true, false = literals.true(description), literals.false(description)
    assert len(true) < MOST_ALTERNATIVES
    for values in product((False, True), repeat=len(NAMES)):
        having = frozenset(name for name, value in zip(NAMES, values, strict=True) if value)
        assert any(said(words, having) for words in true) == truth(body, having)
        assert any(said(words, having) for words in false) != truth(body, having)
    assert set().union(*map(set, true + false)) <= set(literals.meanings)


@given(bodies())
def test_no_set_holds_another_and_the_smallest_come_first(body: Expression) -> None:
    sets = Literals(shipped().vocabulary).true(Lambda("x", body))
    assert not [(a, b) for a in sets for b in sets if set(a) < set(b)]
    assert [len(each) for each in sets] == sorted(map(len, sets))


def described(text: str) -> Lambda:
    return parse_lambda(text, shipped().vocabulary.words(), ("table1",))


def test_what_no_look_at_the_object_shows_counts_as_settled() -> None:
    literals = Literals(shipped().vocabulary)
    related = described("lambda x. Green(x) & On(x, table1) & x != table1 & exactly 2 y. Near(x, y)")
    assert literals.true(related) == (("green",),)
    assert literals.true(described("lambda x. On(x, table1)")) == ()


def test_a_number_lies_on_either_side_of_what_is_compared() -> None:
    literals = Literals(shipped().vocabulary)
    assert literals.false(described("lambda x. HeavierThan(x, 400)")) == (("not__heavier_than_400",),)
    assert literals.meanings["not__heavier_than_400"] == WeightInterval(at_least_kg=0.0, below_kg=0.4)
