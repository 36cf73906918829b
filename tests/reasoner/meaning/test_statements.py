"""Statements: a sentence is true in exactly the small worlds in which so many objects fit."""

from itertools import combinations_with_replacement, product

import pytest
from kit.papers import shipped

from skolem.reasoner.language.descriptions import And, Atom, Count, Every, Exists, Expression, Name, Not, Or
from skolem.reasoner.language.expressions import Believed, Sentence
from skolem.reasoner.language.parser import parse_goal
from skolem.reasoner.meaning.statements import Statement, statement

FACTS = ("Can(x)", "Green(x)", "On(x, table1)")
OBJECTS = [frozenset(f for f, v in zip(FACTS, values, strict=True) if v) for values in product((0, 1), repeat=3)]
WORLDS = [world for size in range(4) for world in combinations_with_replacement(OBJECTS, size)]
SENTENCES = (
    "exists x. Can(x) & On(x, table1)",
    "not exists x. Can(x) & On(x, table1)",
    "every x. Can(x) -> On(x, table1)",
    "not every x. Can(x) -> On(x, table1)",
    "every x. On(x, table1) -> not Green(x)",
    "every x. Can(x) & Green(x) -> On(x, table1)",
    *(f"{maybe}{kind} {n} x. {body}"
      for maybe in ("", "not ")
      for kind in ("at least", "at most", "exactly")
      for n in (0, 1, 2)
      for body in ("Can(x) & On(x, table1)", "Green(x)", "On(x, table1)")),
)  # fmt: skip


def read(text: str) -> Expression:
    goal = parse_goal(f"B({text}, 0.9)", shipped().vocabulary.words(), ("table1",))
    (conjunct,) = goal.conjuncts
    assert isinstance(conjunct, Believed)
    assert isinstance(conjunct.phi, Sentence)
    return conjunct.phi.body


def fits(body: Expression, one: frozenset[str]) -> bool:
    match body:
        case And(left, right):
            return fits(left, one) and fits(right, one)
        case Or(left, right):
            return fits(left, one) or fits(right, one)
        case Not(inner):
            return not fits(inner, one)
        case Atom(word, (_, Name(support))):
            return f"{word}(x, {support})" in one
        case Atom(word, _):
            return f"{word}(x)" in one
    raise AssertionError(body)


def true(sentence: Expression, world: tuple[frozenset[str], ...]) -> bool:
    match sentence:
        case Not(body):
            return not true(body, world)
        case Exists(_, body):
            return any(fits(body, one) for one in world)
        case Every(_, condition, body):
            return all(fits(body, one) for one in world if fits(condition, one))
        case Count(kind, number, _, body):
            found = sum(fits(body, one) for one in world)
            return {"at least": found >= number, "at most": found <= number, "exactly": found == number}[kind]
    raise AssertionError(sentence)


def counts(said: Statement, world: tuple[frozenset[str], ...]) -> bool:
    number = sum(fits(said.fitting.body, one) for one in world)
    return said.low <= number and (said.high is None or number <= said.high)


@pytest.mark.parametrize("text", SENTENCES)
def test_a_sentence_is_true_in_the_worlds_in_which_so_many_fit(text: str) -> None:
    sentence = read(text)
    said = statement(sentence)
    if said is None:  # not exactly n: no range of numbers says that. Of "not at least 0" nothing is true
        assert text.startswith(("not exactly", "not at least 0"))
        return
    for world in WORLDS:
        assert counts(said, world) == true(sentence, world)


@pytest.mark.parametrize("text", [s for s in SENTENCES if not s.startswith("not exactly")])
def test_a_description_is_its_kind_on_the_supports_that_are_kept_apart(text: str) -> None:
    said = statement(read(text))
    for one in OBJECTS if said else ():
        assert said is not None
        kind = said.kind is None or fits(said.kind.body, one)
        assert fits(said.fitting.body, one) == (kind and all(f"On(x, {s})" in one for s in said.on))
        assert not (fits(said.fitting.body, one) and any(f"On(x, {s})" in one for s in said.unless_on))


def test_what_is_no_number_of_objects_is_no_statement() -> None:
    assert statement(read("Green(table1) | Red(table1)")) is None
    assert statement(read("not not exists x. Can(x)")) == statement(read("exists x. Can(x)"))
    assert isinstance(statement(read("exists x. Can(x)")), Statement)
