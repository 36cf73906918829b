"""F7: the sequence of the paper's first figure, where the first bottle picked is the light one."""

import pytest
from kit.runs import Run, over, with_physics

SEEDS = range(12)


def bottle_in_hand(run: Run, pick: int) -> str:
    """Return which true bottle a pick took: what the robot calls oilL may be the one on the right."""
    return next(thing.id for thing in run.truths[pick + 1].objects if thing.in_hand is not None)


def assert_figure(run: Run) -> None:
    """Assert: pick one bottle, feel that it is light, replan, pick the other, place it on the right table."""
    first, other = run.named("Pick")[:2]
    rows = [f"Pick({first})", f"Weigh({first})", f"Place({first}", f"Pick({other})", f"Weigh({other})"]
    where = [run.where(row) for row in [*rows, f"Place({other}, table1)"]]
    assert where == sorted(where)
    assert bottle_in_hand(run, where[3]) == "oilR"
    assert [popped.step for popped in run.given_up() if where[1] < popped.step <= where[2]]
    assert run.operators[-1] == f"Place({other}, table1)"


def test_a_light_bottle_is_felt_and_the_other_one_taken() -> None:
    """ "The robot picks up one bottle, feels that it is light, picks up the other one"; all seeds: docs/results.md."""
    light_first = [run for run in over("real1_oil", SEEDS) if bottle_in_hand(run, run.where("Pick")) == "oilL"]
    assert len(light_first) >= len(SEEDS) / 2
    for run in light_first:
        assert_figure(run)


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "... and places it on the correct table, requiring re-planning and sensing"."""
    run = with_physics("real1_oil")
    assert bottle_in_hand(run, run.where("Pick")) == "oilL"
    assert_figure(run)
