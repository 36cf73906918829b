"""Possible worlds: the evaluator against worlds counted one by one, and the laws of probability."""

import pytest
from hypothesis import given
from kit.draws import examples
from kit.possible_worlds import VOCABULARY, Open, beliefs, enumerated, expressions, renamed, true_in
from kit.relation_tables import BOOK, ROUNDING

from skolem.reasoner.language.descriptions import (
    And,
    Count,
    Every,
    Exists,
    Expression,
    Lambda,
    Not,
    Or,
    Same,
    Variable,
)
from skolem.reasoner.language.expressions import Sentence
from skolem.reasoner.worlds.circuits import compile_description, compile_sentence
from skolem.reasoner.worlds.evaluator import Evaluator, Interval
from skolem.reasoner.worlds.sampling import RARE


def exact(found: Interval) -> float:
    """Return the estimate; points that fall evenly into the arrangements make it exact."""
    half = RARE / found.points if found.points else 0.0
    return found.low + half if found.low > 0.0 else found.high - half


def evaluator(found: Lambda | Expression) -> Evaluator:
    circuit = compile_description(found, BOOK) if isinstance(found, Lambda) else compile_sentence(Sentence(found), BOOK)
    return Evaluator({"e": circuit}, VOCABULARY, "a goal")


def said(expression: Expression, belief: Open) -> float:
    return exact(evaluator(expression).sentence("e", belief))


@examples(100)
@given(beliefs(), expressions(("x",)))
def test_descriptions_mean_the_worlds_in_which_they_are_true(belief: Open, body: Expression) -> None:
    table = evaluator(Lambda("x", body)).table("e", belief)
    for anchor in belief.anchors():
        assert exact(table[anchor]) == pytest.approx(enumerated(body, {"x": anchor}, belief), abs=ROUNDING)


@examples(30)
@given(beliefs(strangers=True), expressions(("x",), near=False))
def test_strangers_count_in_every_quantifier(belief: Open, body: Expression) -> None:
    table = evaluator(Lambda("x", body)).table("e", belief)
    for anchor in belief.anchors()[:1]:
        assert exact(table[anchor]) == pytest.approx(enumerated(body, {"x": anchor}, belief), abs=ROUNDING)


@examples(40)
@given(beliefs(), expressions(("x",), 2))
def test_the_denotes_what_alone_fits(belief: Open, body: Expression) -> None:
    """Russell's reading; summed over all objects it is the chance that exactly one fits."""
    table = evaluator(Lambda("x", body, "the")).table("e", belief)
    for anchor in belief.anchors():
        expected = sum(
            p
            for p, world in belief.worlds
            if [one for one in world.looks if true_in(body, {"x": one}, world)] == [anchor]
        )
        assert exact(table[anchor]) == pytest.approx(expected, abs=ROUNDING)
    one = said(Count("exactly", 1, "x", body), belief)
    assert sum(map(exact, table.values())) == pytest.approx(one, abs=ROUNDING)


@examples(15)
@given(beliefs(strangers=True), expressions((), 2, near=False), expressions((), 2, near=False))
def test_the_laws_of_probability_hold(belief: Open, f: Expression, g: Expression) -> None:
    def near(p: float) -> object:
        return pytest.approx(p, abs=ROUNDING)

    p, q = said(f, belief), said(g, belief)
    assert said(Not(f), belief) == near(1.0 - p)
    assert said(And(f, f), belief) == said(Or(f, f), belief) == near(p)
    assert said(Not(And(f, g)), belief) == near(said(Or(Not(f), Not(g)), belief))
    assert said(Or(f, g), belief) == near(p + q - said(And(f, g), belief))
    assert said(Or(f, And(Not(f), g)), belief) == near(p + said(And(Not(f), g), belief))


@examples(15)
@given(beliefs(strangers=True), expressions(("x",), 2, near=False), expressions(("x",), 2, near=False))
def test_the_laws_of_quantifiers_hold(belief: Open, f: Expression, g: Expression) -> None:
    def near(p: float) -> object:
        return pytest.approx(p, abs=ROUNDING)

    numbers = [said(Count("exactly", n, "x", f), belief) for n in range(3)]
    assert sum(numbers) + said(Count("at least", 3, "x", f), belief) == near(1.0)
    assert said(Count("at most", 1, "x", f), belief) == near(numbers[0] + numbers[1])
    assert said(Count("at least", 1, "x", f), belief) == said(Exists("x", f), belief) == near(1.0 - numbers[0])
    assert said(Every("x", f, g), belief) == near(said(Not(Exists("x", And(f, Not(g)))), belief))
    others = Exists("x", And(f, Exists("z", And(Not(Same(Variable("z"), Variable("x"))), renamed(f, {"x": "z"})))))
    assert said(others, belief) == near(1.0 - numbers[0] - numbers[1])
