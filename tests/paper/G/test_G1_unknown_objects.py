"""G1: goals about objects that nobody has told the robot of."""

import pytest
from kit.runs import Run, over, thing_in, with_physics

SEEDS = range(8)


def assert_about_the_unknown(run: Run) -> None:
    """Assert that what achieved the goal was unknown, even that it exists, when the goal was given."""
    assert run.known() == ("table1", "table2", "table3")
    assert all(item.type.get("table") == 1.0 for item in run.beliefs[0].objects.values())
    assert run.end.anchor not in run.beliefs[0].objects
    assert thing_in(run.truths[-1], run.verdict.witness or "").on == "table1"


def test_a_goal_is_achieved_with_zero_objects_known() -> None:
    """ "Neither the human nor the robot is aware of the location, state, or even existence of the ... objects"."""
    achieved = [run for run in over("sim3_unknown", SEEDS) if run.achieved and run.verdict.true]
    assert len(achieved) >= 7  # of eight; 500 seeds: docs/results.md
    for run in achieved:
        assert_about_the_unknown(run)


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "Particular relevant objects are not known to the robot or the human"."""
    run = with_physics("sim3_unknown")
    assert run.verdict.true
    assert_about_the_unknown(run)
