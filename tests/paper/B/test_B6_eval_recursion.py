"""B6: eval, by recursion on the expression, on real beliefs; against worlds counted one by one."""

import itertools
import math
from collections.abc import Iterator, Mapping

import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.papers import denotes, shipped
from kit.searches import table_prior

from skolem.estimation.belief import Belief
from skolem.reasoner.language.descriptions import And, Atom, Exists, Expression, Name, Or, Variable, constant_of
from skolem.reasoner.language.parser import parse_lambda
from skolem.traces.messages import HsvBelief, PriorObject

Fact = tuple[str, ...]  # a relation and its anchors, or ("exists", anchor)


def believed(
    anchor: str, soda: float, hue: float, y: float, on: str = "table1", kind: str | None = None
) -> PriorObject:
    """Return a thing of uncertain type, colour and place (half on its table at y = .467), or a kind on the floor."""
    return PriorObject(
        anchor=anchor,
        type={kind: 1.0} if kind else {"soda": soda, "bottle": 1.0 - soda},
        world_T_object=(1.1, y, 0.0 if kind else 0.7, 0.0),
        sd_xy_m=0.05,
        sd_theta_rad=1.0,
        support=None if kind else on,
        colour=HsvBelief(mean=(hue, 0.8, 0.8), variance=(0.01, 0.01, 0.01)),
    )


@st.composite
def beliefs(draw: st.DrawFn) -> Belief:
    """A belief in a table and two things that may stand on it."""
    share = st.floats(0.05, 0.95)
    things = [believed(a, draw(share), draw(share), draw(st.floats(0.42, 0.5))) for a in ("a", "b")]
    return Belief(table_prior(objects=things, regions=()))


def probability(fact: Fact, belief: Belief) -> float:
    """Return b(R(c1, .., cn)), and P(exists)."""
    match fact:
        case ("exists", anchor):
            return belief.prob_exists(anchor)
        case ("on", anchor, support):
            return belief.prob_on(anchor, support)
        case (word, anchor):
            return belief.prob_property(anchor, shipped().vocabulary.meanings[word])
    raise AssertionError(fact)


def facts(expression: Expression, bound: Mapping[str, str], anchors: tuple[str, ...]) -> Iterator[Fact]:
    """Yield every ground fact that the truth of an expression turns on."""
    match expression:
        case And(left, right) | Or(left, right):
            yield from facts(left, bound, anchors)
            yield from facts(right, bound, anchors)
        case Exists(variable, body):
            for anchor in anchors:
                yield ("exists", anchor)
                yield from facts(body, {**bound, variable: anchor}, anchors)
        case Atom():
            yield ground(expression, bound)


def ground(atom: Atom, bound: Mapping[str, str]) -> Fact:
    """Return an atom with anchors in place of variables."""
    names = (bound[a.name] if isinstance(a, Variable) else a.name for a in atom.args if isinstance(a, Variable | Name))
    return (constant_of(atom.word), *names)


def true_in(world: frozenset[Fact], expression: Expression, bound: Mapping[str, str], anchors: tuple[str, ...]) -> bool:
    """Return the plain truth of an expression in one world."""
    match expression:
        case And(left, right):
            return true_in(world, left, bound, anchors) and true_in(world, right, bound, anchors)
        case Or(left, right):
            return true_in(world, left, bound, anchors) or true_in(world, right, bound, anchors)
        case Exists(variable, body):
            return any(
                ("exists", a) in world and true_in(world, body, {**bound, variable: a}, anchors) for a in anchors
            )
        case Atom():
            return ground(expression, bound) in world
    raise AssertionError(f"{expression} is not of the paper's language")


def counted(text: str, anchor: str, belief: Belief) -> float:
    """Return P(the description is true of the anchor, which exists), summed over every combination of facts."""
    description = parse_lambda(text, shipped().vocabulary.words())
    anchors, bound = belief.anchors(), {description.variable: anchor}
    chances = {
        f: probability(f, belief) for f in sorted({("exists", anchor), *facts(description.body, bound, anchors)})
    }
    sure = frozenset(f for f, p in chances.items() if p == 1.0)
    open_facts = [f for f, p in chances.items() if 0.0 < p < 1.0]
    total = 0.0
    for choice in itertools.product((False, True), repeat=len(open_facts)):
        world = sure | {f for f, is_true in zip(open_facts, choice, strict=True) if is_true}
        if ("exists", anchor) in world and true_in(world, description.body, bound, anchors):
            total += math.prod(
                chances[f] if is_true else 1.0 - chances[f] for f, is_true in zip(open_facts, choice, strict=True)
            )
    return total


@pytest.mark.parametrize(
    "text",
    [
        "lambda x. Green(x)",
        "lambda x. Soda(x) & Green(x)",
        "lambda x. Soda(x) | Green(x)",
        "lambda x. Heavy(x) & (Soda(x) | Green(x))",
        "lambda x. Soda(x) & exists y. (On(x, y) & Table(y))",
    ],
)
@given(belief=beliefs())
@examples(8)
def test_eval_is_the_probability_where_no_fact_occurs_twice(text: str, belief: Belief) -> None:
    """ "eval(And(e1, e2), b) = eval(e1, b) eval(e2, b)", and likewise for Or and Exists."""
    values = denotes(text, belief)
    for anchor in ("a", "b"):
        assert values[anchor] == pytest.approx(counted(text, anchor, belief), abs=1e-9)


def test_tables_by_hand() -> None:
    """ "eval(e1, b) + eval(e2, b) - eval(e1, b) eval(e2, b)." """
    belief = Belief(table_prior(objects=[believed("a", 0.8, 0.35, 0.0), believed("b", 0.4, 0.63, 0.0)], regions=()))
    soda, exist = {"a": 0.8, "b": 0.4}, 0.99
    green = {a: belief.prob_property(a, shipped().vocabulary.meanings["green"]) for a in belief.anchors()}
    either = {a: soda[a] + green[a] - soda[a] * green[a] for a in soda}
    some = 1.0 - math.prod(1.0 - exist * p for p in green.values())  # the table has a colour too
    for text, expected in (
        ("lambda x. Soda(x)", soda),
        ("lambda x. Soda(x) & Green(x)", {a: soda[a] * green[a] for a in soda}),
        ("lambda x. Soda(x) | Green(x)", either),
        ("lambda x. Soda(x) & (exists y. Green(y))", {a: soda[a] * some for a in soda}),
    ):
        values = denotes(text, belief)
        assert [values[a] for a in soda] == pytest.approx([exist * expected[a] for a in soda], abs=1e-6)


def test_a_relation_inside_a_quantifier_ranges_over_the_universe() -> None:
    """ "Where U is the universe of objects": on something red, whichever that is."""
    things = [
        believed("red_table", 0.0, 0.0, -2.0, kind="table"),
        believed("blue_table", 0.0, 0.63, 2.0, kind="table"),
        believed("a", 1.0, 0.35, -2.0, on="red_table"),
        believed("b", 1.0, 0.35, 2.0, on="blue_table"),
    ]
    belief = Belief(table_prior(objects=things, regions=()))
    values = denotes("lambda x. Soda(x) & exists y. (On(x, y) & Red(y))", belief)
    red = belief.prob_property("red_table", shipped().vocabulary.meanings["red"])
    assert values["a"] == pytest.approx(0.99 * 0.99 * belief.prob_on("a", "red_table") * red, abs=1e-6)
    assert values["b"] < 2e-3 < 0.3 < values["a"]


def test_a_property_that_is_said_twice_counts_twice() -> None:
    """ "Making strong independence assumptions": kept as printed, also where it double counts."""
    belief = Belief(table_prior(objects=[believed("a", 0.8, 0.35, 0.0)], regions=()))
    assert denotes("lambda x. Soda(x) & Soda(x)", belief)["a"] == pytest.approx(0.99 * 0.64)
