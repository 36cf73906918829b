"""Steps refused in a belief: the reasons, what they add up to, and how they are told."""

import pytest

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.refusals import IMPOSSIBLE, IN_VAIN, NOT_FOUND, SPENT, UNLIKELY, Refusals, weakest
from skolem.reasoner.terms import parse_term


def step(name: str) -> Instance:
    return Instance(parse_term(name), parse_term(name), frozenset(), frozenset())


@pytest.mark.parametrize(
    ("met", "shown"),
    [
        ((), IMPOSSIBLE),
        ((IMPOSSIBLE,), IMPOSSIBLE),
        ((IMPOSSIBLE, UNLIKELY), UNLIKELY),
        ((IMPOSSIBLE, IN_VAIN), IN_VAIN),
        ((UNLIKELY, SPENT), NOT_FOUND),
        ((IMPOSSIBLE, NOT_FOUND), NOT_FOUND),
    ],
)
def test_a_search_is_shown_impossible_only_if_all_that_it_left_out_was(met: tuple[str, ...], shown: str) -> None:
    assert weakest(met) == shown


def test_a_step_is_refused_at_its_level_alone_and_higher_limits_give_it_another_chance() -> None:
    refusals = Refusals()
    refusals.note(step("pick(a)"), 1, NOT_FOUND)
    refusals.note(step("pick(b)"), 1, SPENT, 12)
    assert [refusals.reason(step("pick(a)"), level) for level in (0, 1)] == ["", NOT_FOUND]
    refusals.forget_limits()
    assert refusals.reason(step("pick(a)"), 1) == ""
    assert refusals.reason(step("pick(b)"), 1) == SPENT
    refusals.clear()
    assert refusals.reason(step("pick(b)"), 1) == ""


def test_each_reason_is_told_once_with_what_was_refused_for_it() -> None:
    refusals = Refusals()
    refusals.note(step("pick(b)"), 1, IMPOSSIBLE)
    refusals.note(step("pick(a)"), 2, IMPOSSIBLE)
    refusals.note(step("move(c)"), 0, SPENT, 12)
    assert refusals.told() == f"; {IMPOSSIBLE}: Pick(a), Pick(b); {SPENT}: Move(c) (tried 12 stances)"
