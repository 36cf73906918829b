"""Denotation: tables by hand, and the circuit against a direct recursion over the expression."""

from collections.abc import Mapping

import pytest
from hypothesis import given, strategies as st
from kit.descriptions import OBJECTS, PROPERTIES, lambdas
from kit.draws import examples
from kit.relation_tables import BOOK, ROUNDING, WORDS, Table

from skolem.reasoner.language.descriptions import And, Atom, Exists, Expression, Lambda, Name, Or, Variable, constant_of
from skolem.reasoner.language.expressions import Believed, Den, Goal
from skolem.reasoner.language.parser import parse_lambda
from skolem.reasoner.planning.denotation import evaluate
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.terms import compound
from skolem.reasoner.worlds.circuits import compile_description, expression_term
from skolem.traces.errors import InternalError
from skolem.traces.messages import WeightInterval


def described(text: str) -> Lambda:
    return parse_lambda(text, WORDS)


def denotations_of(text: str) -> Denotations:
    return Denotations(Goal((), (Believed(Den(described(text), Name("a")), 0.9),), evaluation="independent"), BOOK)


def value(text: str, belief: Table) -> dict[str, float]:
    return evaluate(compile_description(described(text), BOOK), belief, BOOK.vocabulary)


def near(expected: Mapping[str, float]) -> object:
    return pytest.approx(expected, abs=ROUNDING)


TWO = Table(
    ["a", "b"],
    {("green", "a"): 0.8, ("green", "b"): 0.1, ("soda", "a"): 0.5, ("soda", "b"): 0.9, ("on", "a", "b"): 0.7},
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("lambda x. Green(x)", {"a": 0.8, "b": 0.1}),
        ("lambda x. Green(x) & Soda(x)", {"a": 0.4, "b": 0.09}),
        ("lambda x. Green(x) | Soda(x)", {"a": 0.9, "b": 0.91}),
        ("lambda x. Green(x) & Green(x)", {"a": 0.64, "b": 0.01}),  # the paper's formula, counted twice
        ("lambda x. On(x, b)", {"a": 0.7, "b": 0.0}),
        ("lambda x. In(x, b)", {"a": 0.7, "b": 0.0}),
        ("lambda x. On(x, x)", {"a": 0.0, "b": 0.0}),
        ("lambda x. On(x, c)", {"a": 0.0, "b": 0.0}),
        ("lambda x. Green(a) & Soda(x)", {"a": 0.4, "b": 0.72}),
        ("lambda x. exists y. Green(y)", {"a": 0.82, "b": 0.82}),
        ("lambda x. exists y. (On(x, y) & Soda(y))", {"a": 0.63, "b": 0.0}),
        ("lambda x. exists y. (On(y, x) & Green(y))", {"a": 0.0, "b": 0.56}),
        ("lambda x. exists y. Green(x)", {"a": 0.96, "b": 0.19}),
        ("lambda x. Soda(x) & exists x. Green(x)", {"a": 0.41, "b": 0.738}),
        ("lambda x. exists y, z. (On(y, z) & Green(y))", {"a": 0.56, "b": 0.56}),
    ],
)
def test_values_worked_out_by_hand(text: str, expected: Mapping[str, float]) -> None:
    assert value(text, TWO) == near(expected)


def test_descriptions_are_indefinite() -> None:
    """Two objects, one object, no object may fit."""
    both = Table(["a", "b"], {("red", "a"): 0.95, ("red", "b"): 0.97})
    assert [sum(p > 0.9 for p in value(f"lambda x. {word}(x)", both).values()) for word in ("Red", "Green")] == [2, 0]


def test_without_objects_nothing_is_denoted() -> None:
    assert value("lambda x. exists y. On(x, y)", Table([], {})) == {}


def test_existence_counts_once_for_each_variable() -> None:
    belief = Table(["a", "b"], {("green", "a"): 0.8, ("soda", "a"): 0.5, ("on", "a", "b"): 1.0}, {"a": 0.9, "b": 0.6})
    assert value("lambda x. Green(x) & Soda(x)", belief) == near({"a": 0.9 * 0.8 * 0.5, "b": 0.0})
    assert value("lambda x. exists y. On(x, y)", belief) == near({"a": 0.9 * 0.6, "b": 0.0})


def recurse(expression: Expression, bound: Mapping[str, str], belief: Table) -> float:
    """The paper's eval, by substitution: the oracle."""
    match expression:
        case And(left, right):
            return recurse(left, bound, belief) * recurse(right, bound, belief)
        case Or(left, right):
            p, q = recurse(left, bound, belief), recurse(right, bound, belief)
            return p + q - p * q
        case Exists(variable, body):
            none = 1.0
            for anchor in belief.anchors():
                none *= 1.0 - belief.prob_exists(anchor) * recurse(body, {**bound, variable: anchor}, belief)
            return 1.0 - none
        case Atom(word, args):
            names = [
                bound[a.name] if isinstance(a, Variable) else a.name for a in args if isinstance(a, Variable | Name)
            ]
            if word in ("On", "In"):
                return belief.prob_on(names[0], names[1])
            return belief.prob_property(names[0], BOOK.vocabulary.meanings[constant_of(word)])
    raise AssertionError(f"{expression} is not of the paper's language")


@st.composite
def beliefs(draw: st.DrawFn) -> Table:
    probabilities = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 1.0, 1e-6, 1.0 - 1e-6]))
    keys: list[tuple[str, ...]] = [(constant_of(word), anchor) for word in PROPERTIES for anchor in OBJECTS]
    keys += [("on", anchor, support) for anchor in OBJECTS for support in OBJECTS]
    values = draw(st.lists(probabilities, min_size=len(keys), max_size=len(keys)))
    exists = {anchor: draw(probabilities) for anchor in OBJECTS}
    return Table(OBJECTS, dict(zip(keys, values, strict=True)), exists)


@given(lambdas(), beliefs())
@examples(60)
def test_the_circuit_agrees_with_direct_recursion(description: Lambda, belief: Table) -> None:
    found = evaluate(compile_description(description, BOOK), belief, BOOK.vocabulary)
    for anchor in belief.anchors():
        expected = belief.prob_exists(anchor) * recurse(description.body, {"x": anchor}, belief)
        assert found[anchor] == pytest.approx(expected, abs=ROUNDING)


# ---------------------------------------------------------------- the axioms' own checks


@pytest.mark.parametrize(
    ("description", "reason"),
    [
        (Lambda("x", Atom("Green", (Variable("z"),))), "unbound(z)"),
        (
            Lambda("x", And(Exists("y", Atom("Red", (Variable("y"),))), Atom("Green", (Variable("y"),)))),
            "unbound(y)",
        ),
        (
            Lambda("x", Exists("x", Atom("Green", (Variable("x"),)))),
            "bound_twice(x)",
        ),
    ],
)
def test_the_axioms_refuse_what_the_parser_never_makes(description: Lambda, reason: str) -> None:
    with pytest.raises(InternalError) as caught:
        compile_description(description, BOOK)
    assert reason in str(caught.value)


def test_an_expression_without_an_axiom_is_named() -> None:
    body = compound("xor", "a", "b")
    facts = [compound("lambda", "e", "x", body), compound("kind", "e", "lambda")]
    answer = BOOK.solve(facts, None, ["denote"])
    assert [str(reason) for _, reason in answer.atoms["bad"]] == ["not_an_expression(xor(a,b))"]


def test_axioms_of_one_conjunction_are_exactly_these() -> None:
    body = expression_term(described("lambda x. Green(x) & On(x, desk)").body)
    facts = [compound("lambda", "e", "x", body), compound("kind", "e", "lambda")]
    answer = BOOK.solve(facts, None, ["denote"])
    green, on = "(var(x),())", "(var(x),(desk,()))"
    assert sorted(f"{e} -> {c}" for e, c in answer.atoms["axiom"]) == [
        f"and(r(green,{green}),r(on,{on})) -> product(r(green,{green}),r(on,{on}))",
        f"r(green,{green}) -> belief(green,{green})",
        f"r(on,{on}) -> belief(on,{on})",
    ]
    assert answer.atoms["props"] == [("e", "green")]


# ---------------------------------------------------------------- properties


def two(*names: str) -> tuple[tuple[str, ...], tuple[tuple[str], ...]]:
    """Return properties each of which is enough."""
    return names, tuple((name,) for name in names)


@pytest.mark.parametrize(
    ("text", "props", "sets"),
    [
        ("lambda x. Green(x)", ("green",), (("green",),)),
        ("lambda x. Soda(x) & Green(x) & Heavy(x)", ("green", "heavy", "soda"), (("green", "heavy", "soda"),)),
        ("lambda x. Green(x) | Red(x)", ("green", "red"), (("green",), ("red",))),
        (
            "lambda x. Soda(x) & (Green(x) | Red(x))",
            ("green", "red", "soda"),
            (("green", "soda"), ("red", "soda")),
        ),
        ("lambda x. Green(x) & (Green(x) | Red(x))", ("green", "red"), (("green",),)),
        ("lambda x. Green(x) & On(x, desk)", ("green",), (("green",),)),
        ("lambda x. Green(x) & exists y. (On(x, y) & Red(y))", ("green",), (("green",),)),
        ("lambda x. On(x, desk)", (), ()),
        (
            "lambda x. Soda(x) & HeavierThan(x, 400)",
            ("heavier_than_400", "soda"),
            (("heavier_than_400", "soda"),),
        ),
        ("lambda x. HeavierThan(x, 0.5) | HeavierThan(x, -3)", *two("heavier_than_0_5", "heavier_than_minus_3")),
        ("lambda x. Soda(x) & exists y. (On(x, y) & HeavierThan(y, 400))", ("soda",), (("soda",),)),
    ],
)
def test_properties_that_a_description_turns_on(
    text: str, props: tuple[str, ...], sets: tuple[tuple[str, ...], ...]
) -> None:
    circuit = compile_description(described(text), BOOK)
    assert circuit.props == props
    assert denotations_of(text).alternatives["e1"] == sets


def test_conjuncts_are_the_parts_of_an_explanation() -> None:
    denotations = denotations_of("lambda x. Green(x) & Soda(x)")
    assert denotations.conjuncts("e1", "a", TWO) == {"green": 0.8, "soda": 0.5}


def test_what_a_description_compares_with_a_number_is_a_property_of_its_own() -> None:
    denotations = denotations_of("lambda x. Soda(x) & HeavierThan(x, 400)")
    assert denotations.meanings["heavier_than_400"] == WeightInterval(at_least_kg=0.4)
    assert denotations.meanings["heavy"] == BOOK.vocabulary.meanings["heavy"]


# ---------------------------------------------------------------- cost


def test_a_description_is_evaluated_once_per_version_of_the_belief() -> None:
    denotations = denotations_of("lambda x. Green(x)")
    first, second = Table(["a"], {("green", "a"): 0.8}), Table(["a"], {("green", "a"): 0.2}, version=1)
    assert [denotations.probability("e1", "a", first) for _ in range(3)] == [0.8] * 3
    assert first.asked == 1
    assert denotations.probability("e1", "a", second) == 0.2
    assert denotations.probability("e1", "unknown", second) == 0.0


def test_only_what_a_description_mentions_is_asked_of_the_belief() -> None:
    anchors = [f"o{index}" for index in range(50)]
    belief = Table(anchors, {})
    value("lambda x. Green(x) & (Green(x) | Soda(x))", belief)
    assert belief.asked == 2 * len(anchors)
