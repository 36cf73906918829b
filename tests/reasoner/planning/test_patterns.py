"""What fluents entail and exclude."""

from pathlib import Path

import pytest

from skolem.reasoner.planning.goals import read_mutexes
from skolem.reasoner.planning.patterns import Mutexes, entails, mentions
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import parse_term


@pytest.mark.parametrize(
    ("fluent", "wanted", "expected"),
    [
        ("krd(o1)", "krd(o1)", True),
        ("krd(o1)", "krd(o2)", False),
        ("b(on(o1,desk),51293)", "b(on(o1,desk),105361)", True),
        ("b(on(o1,desk),105361)", "b(on(o1,desk),51293)", False),
        ("b(on(o1,desk),51293)", "b(on(o1,table),105361)", False),
        ("bn(pose(o),any,sd(5,5,any),any,10)", "bn(pose(o),any,sd(8,8,any),any,20)", True),
        ("bn(pose(o),any,sd(5,9,any),any,10)", "bn(pose(o),any,sd(8,8,any),any,20)", False),
        ("bn(pose(o),any,sd(5,5,any),any,10)", "bn(pose(o),any,sd(8,8,100),any,20)", False),
        ("bn(colour(o),v(1,2,3),sd(5,5,5),tol(9,9,9),10)", "bn(colour(o),any,sd(8,8,8),any,20)", True),
        ("bn(colour(o),any,sd(5,5,5),any,10)", "bn(colour(o),v(1,2,3),sd(8,8,8),tol(9,9,9),20)", False),
    ],
)
def test_a_stronger_belief_entails_a_weaker_one_and_nothing_else(fluent: str, wanted: str, expected: bool) -> None:
    assert entails(parse_term(fluent), parse_term(wanted)) is expected


MUTEXES = Mutexes(
    [
        (parse_term("holding(same(o))"), parse_term("b(on(same(o),any),any)")),
        (parse_term("at(look(same(o)))"), parse_term("at(pick(any,other(o)))")),
    ]
)


@pytest.mark.parametrize(
    ("fluent", "other", "expected"),
    [
        ("holding(o1)", "b(on(o1,desk),51293)", True),
        ("b(on(o1,desk),51293)", "holding(o1)", True),
        ("holding(o1)", "b(on(o2,desk),51293)", False),
        ("at(look(o1))", "at(pick(right,o1))", False),
        ("at(look(o1))", "at(pick(right,o2))", True),
        ("at(pick(left,o2))", "at(look(o1))", True),
    ],
)
def test_exclusion_binds_same_and_other_across_the_pair(fluent: str, other: str, expected: bool) -> None:
    assert MUTEXES.exclude(parse_term(fluent), parse_term(other)) is expected


def test_a_placeholder_is_found_at_any_depth() -> None:
    assert mentions(parse_term("b(den(e1,sk(var(o))),105361)"), "sk")
    assert not mentions(parse_term("b(den(e1,o2),105361)"), "sk")


def test_exclusions_are_read_from_every_file_that_states_some(tmp_path: Path) -> None:
    own = tmp_path / "own.lp"
    own.write_text("left(left).\nmutex(holding(same(o)), empty(H)) :- left(H).\n", encoding="utf-8")
    mutexes = read_mutexes(Rulebook.load(Queries, [own]))
    shipped = read_mutexes(Rulebook.load(Queries))
    pair = (parse_term("holding(o1)"), parse_term("empty(left)"))
    assert (mutexes.exclude(*pair), shipped.exclude(*pair)) == (True, False)


def test_pairs_that_were_asked_for_can_be_forgotten() -> None:
    pair = (parse_term("holding(o1)"), parse_term("b(on(o1,desk),105361)"))
    assert MUTEXES.exclude(*pair)
    MUTEXES.forget()
    assert MUTEXES.exclude(*pair)


def test_constants_and_whole_fluents_may_exclude_each_other() -> None:
    mutexes = Mutexes(
        [
            (parse_term("day"), parse_term("night")),
            (parse_term("same(f)"), parse_term("broken(same(f))")),
        ]
    )
    assert mutexes.exclude(parse_term("night"), parse_term("day"))
    assert not mutexes.exclude(parse_term("night"), parse_term("dusk"))
    assert mutexes.exclude(parse_term("lit(lamp)"), parse_term("broken(lit(lamp))"))
    assert not mutexes.exclude(parse_term("lit(lamp)"), parse_term("broken(lit(fire))"))
