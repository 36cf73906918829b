"""G6: flexibility: noise leads to a variety of action sequences that succeed.

How many there are over 50 and 500 seeds of each scenario is counted by `skolem sweep` (docs/results.md).
"""

import pytest
from kit.runs import distinct_successes, over

SEEDS = {"real1_oil": 12, "real2_green": 6, "sim1_green": 6, "sim2_heavy_soda": 6, "sim3_unknown": 8}


@pytest.mark.parametrize("name", SEEDS)
def test_the_same_goal_is_achieved_in_different_ways(name: str) -> None:
    """ "We observed a variety of successful execution sequences"."""
    assert len(distinct_successes(over(name, range(SEEDS[name])))) >= 2


def test_the_oil_bottles_are_looked_at_more_than_once_and_in_different_order() -> None:
    """ "With multiple look operations", "which highlights the flexibility enabled by integrating"."""
    runs = over("real1_oil", range(SEEDS["real1_oil"]))
    assert all(len(run.named("LookAt")) >= 2 for run in runs)
    assert len(distinct_successes(runs)) >= 3
