"""How near a plan is to the best one, in words."""

import pytest

from skolem.tools.words.optimality import optimality, optimality_of_all


@pytest.mark.parametrize(
    ("within", "words"),
    [
        (1.0, "optimal"),
        (1.04, "within 1.04 of the best"),
        (1.1, "within 1.10 of the best"),
        (1.000001, "within 1.01 of the best"),
        (None, "no bound is known"),
    ],
)
def test_a_bound_is_told_and_never_a_better_one(within: float | None, words: str) -> None:
    assert optimality(within) == words


@pytest.mark.parametrize(
    ("within", "words"),
    [
        ([1.0, 1.25, 1.0, 1.5, None], "2 optimal, 2 within 1.50 of the best, 1 of which no bound is known"),
        ([1.0], "1 optimal"),
        ([], "none found"),
    ],
)
def test_all_plans_of_a_run_are_summed_up_by_the_worst_bound(within: list[float | None], words: str) -> None:
    assert optimality_of_all(within) == words
