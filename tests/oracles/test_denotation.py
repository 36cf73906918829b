"""Denotation against two oracles: recursion on the parsed text's meaning, and worlds counted one by one.

Descriptions are written as text with the few variable names that shadow one another; the parser renames binders apart.
"""

import itertools
import math
from collections.abc import Iterator, Mapping
from functools import cache

import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.relation_tables import BOOK, ROUNDING, WORDS, Table

from skolem.reasoner.language.parser import parse_lambda
from skolem.reasoner.planning.denotation import evaluate, evaluate_at
from skolem.reasoner.worlds.circuits import compile_description

ANCHORS = ("a", "b", "c")
PROPERTIES = ("Green", "Soda", "Heavy")
PAIRS = {"On": "on", "Near": "near"}
Fact = tuple[str, ...]

# An expression as nested tuples: ("and" | "or", left, right), ("exists", variable, body), (word, argument, ..).
Tree = tuple[object, ...]


@st.composite
def trees(draw: st.DrawFn, scope: tuple[str, ...], depth: int) -> Tree:
    """An expression over x and y alone, so that inner binders shadow outer ones."""
    kind = draw(st.sampled_from(["atom", "and", "or", "exists"] if depth else ["atom"]))
    if kind in ("and", "or"):
        return kind, draw(trees(scope, depth - 1)), draw(trees(scope, depth - 1))
    if kind == "exists":
        variable = draw(st.sampled_from(["x", "y"]))
        return kind, variable, draw(trees((*scope, variable), depth - 1))
    argument = st.sampled_from([*sorted(set(scope)), *ANCHORS])
    if draw(st.booleans()):
        return draw(st.sampled_from(sorted(PAIRS))), draw(argument), draw(argument)
    return draw(st.sampled_from(PROPERTIES)), draw(argument)


def text(tree: Tree) -> str:
    match tree:
        case ("and" | "or" as kind, tuple(left), tuple(right)):
            return f"({text(left)} {'&' if kind == 'and' else '|'} {text(right)})"
        case ("exists", variable, tuple(body)):
            return f"(exists {variable}. {text(body)})"
        case (word, *arguments):
            return f"{word}({', '.join(map(str, arguments))})"
    raise AssertionError(tree)


@st.composite
def beliefs(draw: st.DrawFn, anchors: tuple[str, ...] = ANCHORS) -> Table:
    share = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 1.0, 1e-9]))
    keys: list[Fact] = [(word.lower(), a) for word in PROPERTIES for a in anchors]
    keys += [(name, a, b) for name in PAIRS.values() for a in anchors for b in anchors]
    return Table(anchors, {key: draw(share) for key in keys}, {a: draw(share) for a in anchors})


def probability(belief: Table, fact: Fact) -> float:
    if not set(fact[1:]) <= set(belief.anchors()):
        return 0.0
    match fact:
        case ("exists", anchor):
            return belief.prob_exists(anchor)
        case ("on", a, b):
            return belief.prob_on(a, b)
        case ("near", a, b):
            return belief.prob_near(a, b, 0.3)
    return belief.prob_property(fact[1], BOOK.vocabulary.meanings[fact[0]])


def value(tree: Tree, bound: Mapping[str, str], belief: Table) -> float:
    """The paper's eval, directly: an inner binder hides an outer one of the same name."""
    match tree:
        case ("and", tuple(left), tuple(right)):
            return value(left, bound, belief) * value(right, bound, belief)
        case ("or", tuple(left), tuple(right)):
            p, q = value(left, bound, belief), value(right, bound, belief)
            return p + q - p * q
        case ("exists", str(variable), tuple(body)):
            some = (belief.prob_exists(a) * value(body, {**bound, variable: a}, belief) for a in belief.anchors())
            return 1.0 - math.prod(1.0 - p for p in some)
    return probability(belief, fact_of(tree, bound))


def fact_of(tree: Tree, bound: Mapping[str, str]) -> Fact:
    word, *arguments = map(str, tree)
    return (PAIRS.get(word, word.lower()), *(bound.get(argument, argument) for argument in arguments))


@given(trees(("x",), 4), beliefs())
@examples(120)
def test_the_circuit_agrees_with_recursion_under_nesting_shadowing_and_relations(tree: Tree, belief: Table) -> None:
    circuit = compile_description(parse_lambda(f"lambda x. {text(tree)}", WORDS), BOOK)
    found = evaluate(circuit, belief, BOOK.vocabulary)
    for anchor in belief.anchors():
        expected = belief.prob_exists(anchor) * value(tree, {"x": anchor}, belief)
        assert found[anchor] == pytest.approx(expected, abs=ROUNDING)
        assert evaluate_at(anchor, circuit, belief, BOOK.vocabulary) == pytest.approx(expected, abs=ROUNDING)


# ---------------------------------------------------------------- worlds


def facts(tree: Tree, bound: Mapping[str, str], anchors: tuple[str, ...]) -> Iterator[Fact]:
    """Yield every fact that the truth of an expression turns on, once for each time it is asked."""
    match tree:
        case ("and" | "or", tuple(left), tuple(right)):
            yield from facts(left, bound, anchors)
            yield from facts(right, bound, anchors)
        case ("exists", str(variable), tuple(body)):
            for anchor in anchors:
                yield ("exists", anchor)
                yield from facts(body, {**bound, variable: anchor}, anchors)
        case _:
            yield fact_of(tree, bound)


def true_in(world: frozenset[Fact], tree: Tree, bound: Mapping[str, str], anchors: tuple[str, ...]) -> bool:
    match tree:
        case ("and", tuple(left), tuple(right)):
            return true_in(world, left, bound, anchors) and true_in(world, right, bound, anchors)
        case ("or", tuple(left), tuple(right)):
            return true_in(world, left, bound, anchors) or true_in(world, right, bound, anchors)
        case ("exists", str(variable), tuple(body)):
            inside = ((a, {**bound, variable: a}) for a in anchors)
            return any(("exists", a) in world and true_in(world, body, deeper, anchors) for a, deeper in inside)
    return fact_of(tree, bound) in world


def counted(tree: Tree, anchor: str, belief: Table) -> float:
    """Return the probability of the worlds in which the description is true of the anchor, facts independent."""
    anchors = belief.anchors()
    asked = sorted({("exists", anchor), *facts(tree, {"x": anchor}, anchors)})
    chances = {fact: probability(belief, fact) for fact in asked}
    total = 0.0
    for choice in itertools.product((False, True), repeat=len(asked)):
        world = frozenset(fact for fact, is_true in zip(asked, choice, strict=True) if is_true)
        if ("exists", anchor) in world and true_in(world, tree, {"x": anchor}, anchors):
            total += math.prod(
                chances[fact] if is_true else 1.0 - chances[fact] for fact, is_true in zip(asked, choice, strict=True)
            )
    return total


def says_nothing_twice(tree: Tree, anchor: str) -> bool:
    """Return whether no fact is asked twice: then the paper's eval and the product of independent facts are one."""
    asked = [("exists", anchor), *facts(tree, {"x": anchor}, ("a", "b"))]
    return len(asked) == len(set(asked)) <= 10


@cache
def unrepeated() -> tuple[Tree, ...]:
    """Return expressions in which every fact occurs once, whichever of two anchors is meant."""
    atoms: list[Tree] = [(word, "x") for word in PROPERTIES] + [("On", "x", "b"), ("Near", "a", "x")]
    joined: list[Tree] = [(k, p, q) for k in ("and", "or") for p, q in itertools.permutations(atoms, 2)]
    joined += [("and", p, ("or", q, r)) for p, q, r in itertools.permutations(atoms[:4], 3)]
    return tuple(tree for tree in (*atoms, *joined) if all(says_nothing_twice(tree, a) for a in ("a", "b")))


@given(st.sampled_from(unrepeated()), beliefs(("a", "b")))
@examples(80)
def test_the_circuit_is_the_probability_of_the_worlds_where_it_is_true(tree: Tree, belief: Table) -> None:
    circuit = compile_description(parse_lambda(f"lambda x. {text(tree)}", WORDS), BOOK)
    for anchor, found in evaluate(circuit, belief, BOOK.vocabulary).items():
        assert found == pytest.approx(counted(tree, anchor, belief), abs=ROUNDING)


@given(beliefs(("a", "b")), st.sampled_from(PROPERTIES), st.sampled_from(PROPERTIES))
@examples(40)
def test_a_quantifier_is_the_probability_that_some_object_of_the_world_fits(
    belief: Table, word: str, other: str
) -> None:
    """The described object surely exists here: its existence would otherwise be asked by lambda and by exists."""
    sure = Table(("a", "b"), belief._relations, {"a": 1.0, "b": 1.0})
    tree: Tree = ("and", (word, "x"), ("exists", "y", ("and", ("On", "x", "y"), ("Near", "y", "y"))))
    if other != word:
        tree = ("or", (other, "x"), tree)
    circuit = compile_description(parse_lambda(f"lambda x. {text(tree)}", WORDS), BOOK)
    for anchor, found in evaluate(circuit, sure, BOOK.vocabulary).items():
        assert found == pytest.approx(counted(tree, anchor, sure), abs=ROUNDING)
