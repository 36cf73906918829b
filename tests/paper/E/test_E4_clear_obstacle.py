"""E4: the robot moves an obstacle out of the way."""

import pytest
from kit.papers import rehearsed
from kit.runs import with_physics


def test_what_stands_in_the_way_is_named_and_put_where_it_is_not_in_the_way_again() -> None:
    """ "It moves the box, _o1_, out of the way so that it can finally move"."""
    play, operators = rehearsed()
    placed = next(i for i, row in enumerate(operators) if row.startswith("Place(o1"))
    assert operators.index("Pick(o1)") < placed < operators.index("Pick(o2)")
    goals = [step.subgoal for turn in play.turns for plan in turn.plans for layer in plan.layers for step in layer]
    assert any("aside(o1,pick(right,o2))" in fluents for fluents in goals)
    assert any(
        query.startswith("approach place(") and "o1" in query and "pick(" in query for query in play.geometry.asked
    )


@pytest.mark.physics
def test_with_the_physics_the_obstacle_is_gone_from_the_swept_volume_before_the_pick() -> None:
    """ "It moves the box, _o1_, out of the way": into the other hand, or onto a place aside."""
    run = with_physics("illustrative")
    pick = run.where("Pick(o2)")
    asked = [question for question in run.questions if question.query == "blockers pick(right, o2)"]
    assert asked[0].blockers == ("o1",)
    assert [question.blockers for question in asked if question.step == pick][-1] == ()
    assert run.where("Pick(o1)") < pick
    assert run.results[pick].status == "done"
