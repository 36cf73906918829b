"""G5, E4: objects behind one another: what stands before the one that is meant is taken out of its way."""

import pytest
from kit.runs import Run, over, thing_in, with_physics

SEEDS = range(6)


def assert_cleared_in_order(run: Run) -> None:
    """Assert that the two before the hidden soda were taken away from the front on, and that it alone was brought."""
    assert run.verdict.witness == "third"
    assert run.verdict.true
    assert run.where("Pick(first)") < run.where("Pick(second)") < run.where("Pick(third)")
    assert [thing.id for thing in run.truths[-1].objects if thing.on == "table1"] == ["third"]
    asked = [question.blockers or () for question in run.asked("pick", "third")]
    assert any("second" in blockers for blockers in asked)


def test_a_row_is_cleared_from_the_front_until_the_last_can_be_grasped() -> None:
    """ "In the presence of substantial occlusion", and "it moves the box, _o1_, out of the way"."""
    for run in over("behind", SEEDS):
        assert_cleared_in_order(run)
        assert thing_in(run.truths[0], "third").on == "front"


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "... and on a real physical robot, in the presence of substantial occlusion and sensing error"."""
    assert_cleared_in_order(with_physics("behind"))
