"""Possible worlds: the evaluator against worlds counted one by one, and the laws of probability."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.possible_worlds import (
    PROPERTIES,
    VOCABULARY,
    Arrangement,
    Known,
    Likely,
    Open,
    beliefs,
    enumerated,
    expressions,
    renamed,
    true_in,
)
from kit.relation_tables import BOOK, ROUNDING

from skolem.reasoner.language.descriptions import (
    And,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Lambda,
    Name,
    Not,
    Or,
    Same,
    Variable,
    Was,
)
from skolem.reasoner.language.expressions import Sentence
from skolem.reasoner.terms import compound
from skolem.reasoner.worlds.circuits import compile_description, compile_sentence
from skolem.reasoner.worlds.evaluator import Evaluator, Interval
from skolem.reasoner.worlds.sampling import RARE
from skolem.traces.messages import Strangers


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
    """Russell's reading, at the start; summed over all objects it is the chance that exactly one fits."""
    table = evaluator(Lambda("x", body, "the")).table("e", belief)
    for anchor in belief.anchors():
        expected = sum(
            p
            for p, world in belief.worlds
            if [one for one in world.looks if true_in(Was(body), {"x": one}, world)] == [anchor]
        )
        assert exact(table[anchor]) == pytest.approx(expected, abs=ROUNDING)
    one = said(Was(Count("exactly", 1, "x", body)), belief)
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


@examples(30)
@given(beliefs(strangers=True), expressions(("x",)))
def test_what_is_not_known_of_strangers_is_bounded_on_both_sides(belief: Open, body: Expression) -> None:
    """Whichever strangers are near whom, all of them or none, the probability is between the bounds."""
    anchor = belief.anchors()[0]
    found = evaluator(Lambda("x", body)).table("e", belief)[anchor]
    for near in (False, True):
        share = 0.0
        for p, world in belief.worlds:
            unmet = [one for one in world.looks if one not in belief.likely]
            pairs = {(one, other) for one in unmet for other in world.looks} if near else set()
            then = world.before or world
            closer = replace(world, near=world.near | pairs, before=replace(then, near=then.near | pairs))
            share += p if anchor in world.looks and true_in(body, {"x": anchor}, closer) else 0.0
        assert found.low - ROUNDING <= share <= found.high + ROUNDING


@examples(30)
@given(beliefs(), expressions(("x",), 2))
def test_an_impossible_object_changes_nothing(belief: Open, body: Expression) -> None:
    more = Open(
        {**belief.likely, "e": next(iter(belief.likely.values()))}, {**belief.exists, "e": 0.0}, belief.arrangements
    )
    before, after = (evaluator(Lambda("x", body)).table("e", each) for each in (belief, more))
    for anchor in belief.anchors():
        assert exact(after[anchor]) == pytest.approx(exact(before[anchor]), abs=ROUNDING)


@examples(30)
@given(beliefs(strangers=True), st.sampled_from(PROPERTIES), st.floats(0.0, 5.0))
def test_searching_more_never_makes_the_only_one_less_likely(belief: Open, word: str, expected: float) -> None:
    """Fewer strangers: "the" and "every" are no less likely, and "at least" is no more likely."""
    fits = Atom(word, (Variable("x"),))
    region = belief.regions_[0]
    more = Open(
        belief.likely,
        belief.exists,
        belief.arrangements,
        [region.model_copy(update={"expected": region.expected + expected}), *belief.regions_[1:]],
        belief.new,
    )
    the = evaluator(Lambda("x", fits, "the"))
    few, many = the.table("e", belief), the.table("e", more)
    assert all(exact(many[one]) <= exact(few[one]) + ROUNDING for one in belief.anchors())
    every = Every("x", fits, Atom("On", (Variable("x"), Name("a"))))
    assert said(every, more) <= said(every, belief) + ROUNDING
    two = Count("at least", 2, "x", fits)
    assert said(two, more) >= said(two, belief) - ROUNDING


def test_strangers_without_limit_are_a_poisson_number() -> None:
    """The number of sodas that nobody has met, from none to many, in closed form."""
    soda = Likely({"soda": 0.25, "bottle": 0.75}, {(0.6, 0.8, 0.8): 1.0}, {0.35: 1.0})
    table1 = Likely({"table": 1.0}, {(0.6, 0.8, 0.8): 1.0}, {9.0: 1.0})
    regions = [Strangers(support="a", expected=6.0, overlooked=0.0)] * 2
    belief = Open({"a": table1}, {"a": 1.0}, [Arrangement(128, frozenset(), frozenset())], regions, soda)
    fits = Atom("Soda", (Variable("x"),))
    for n in range(8):
        expected = math.exp(-3.0) * 3.0**n / math.factorial(n)
        assert said(Count("exactly", n, "x", fits), belief) == pytest.approx(expected, abs=ROUNDING)


def test_a_formula_that_is_too_large_is_answered_by_bounds_with_a_reason() -> None:
    names = [f"o{i}" for i in range(24)]
    likely = Likely({"soda": 0.5, "bottle": 0.5}, {(0.6, 0.8, 0.8): 1.0}, {0.35: 1.0})
    apart = frozenset((a, b) for i, a in enumerate(names) for b in names[i + 1 :])
    sometimes = [Arrangement(64, frozenset(), apart), Arrangement(64, frozenset(), frozenset())]
    belief = Known(dict.fromkeys(names, likely), dict.fromkeys(names, 0.5), sometimes)
    pair = Exists("x", Exists("y", And(Atom("Near", (Variable("x"), Variable("y"))), Atom("Soda", (Variable("y"),)))))
    found = evaluator(pair).sentence("e", belief)
    assert (found.low, found.high) == (0.0, 1.0)
    assert found.reason is not None


def test_one_stranger_is_another_than_the_next_whichever_is_named_first() -> None:
    """Each has another beside it if there are two, known or not."""
    soda = Likely({"soda": 1.0}, {(0.6, 0.8, 0.8): 1.0}, {0.35: 1.0})
    regions = [Strangers(support="a", expected=0.5, overlooked=0.0)]
    belief = Open({"a": soda}, {"a": 0.5}, [Arrangement(128, frozenset(), frozenset())], regions, soda)
    accompanied = Exists("y", Not(Same(Variable("x"), Variable("y"))))
    other = And(Not(Same(Variable("z"), Variable("x"))), renamed(accompanied, {"x": "z"}))
    none = math.exp(-0.5)
    two = 0.5 * (1.0 - none) + 0.5 * (1.0 - 1.5 * none)
    assert said(Exists("x", And(accompanied, Exists("z", other))), belief) == pytest.approx(two, abs=ROUNDING)


def test_what_was_so_stays_so_while_things_are_moved() -> None:
    likely = Likely({"soda": 1.0}, {(0.6, 0.8, 0.8): 1.0}, {0.35: 1.0})
    there = Arrangement(128, frozenset({("a", "b")}), frozenset())
    moved = Arrangement(128, frozenset(), frozenset(), there)
    belief = Open({"a": likely, "b": likely}, {"a": 1.0, "b": 1.0}, [moved])
    on = Atom("On", (Name("a"), Name("b")))
    assert [said(each, belief) for each in (on, Was(on), Not(Was(on)), Was(Not(on)))] == [0.0, 1.0, 0.0, 0.0]


def test_statements_are_evaluated_in_one_world() -> None:
    likely = Likely({"soda": 0.5, "bottle": 0.5}, {(0.6, 0.8, 0.8): 1.0}, {0.35: 1.0})
    belief = Open({"a": likely}, {"a": 0.5}, [Arrangement(128, frozenset(), frozenset())])
    one = evaluator(Lambda("x", Atom("Soda", (Variable("x"),))))
    den, blue = compound("den", "e", "a"), compound("prop", "blue", "a")
    assert exact(one.together((den, blue), belief)) == pytest.approx(0.25)
    assert exact(one.together((den, compound("prop", "bottle", "a")), belief)) == 0.0
    both = compound("holds", compound("", "soda", "blue"), "a")
    assert exact(one.together((both,), belief)) == pytest.approx(0.25)
    assert exact(one.together((den, compound("prop", "blue", "nobody")), belief)) == 0.0
