"""E5: what is held is placed before another object is picked with that hand."""

import pytest
from kit.minds import TableBelief, Thing
from kit.papers import planned, posed, rehearsed, steps_of
from kit.runs import over, with_physics

from skolem.reasoner.planning.instances import title
from skolem.traces.messages import Pick, Place

GOAL = "B(On(o4, desk), 0.9)"


def holding_o2() -> TableBelief:
    """A belief in which the right hand holds o2 and o4 stands on a shelf, its pose well known."""
    return TableBelief(
        {
            "desk": Thing({"table": 1.0}, pose_sd=0.005),
            "shelf": Thing({"table": 1.0}, pose_sd=0.005),
            "o2": Thing({"soda": 1.0}, hand="right"),
            "o4": Thing({"soda": 1.0}, on="shelf", pose_sd=0.004),
        }
    )


def test_a_plan_to_hold_another_object_begins_with_placing_the_one_in_the_hand() -> None:
    """ "It has to execute a place action because it is still holding _o2_"."""
    found = steps_of(planned(posed(GOAL, holding_o2()), "held(right,o4)", level=1))
    names = [title(step.instance.operation) for step in found]
    assert names[0].startswith("Place(o2")
    assert names[-1] == "Pick(o4)"


def test_with_an_empty_hand_nothing_is_placed() -> None:
    """ "... because it is still holding _o2_": and only then."""
    belief = holding_o2()
    belief.things["o2"].hand, belief.things["o2"].on = None, "shelf"
    found = steps_of(planned(posed(GOAL, belief), "held(right,o4)", level=1))
    assert not any(title(step.instance.operation).startswith("Place") for step in found)


def test_in_the_example_the_light_can_is_placed_before_the_other_is_picked() -> None:
    """ "A plan is made to pick it up to observe its weight"."""
    _, operators = rehearsed()
    placed = next(i for i, row in enumerate(operators) if row.startswith("Place(o2"))
    assert operators.index("Weigh(o2)") < placed < operators.index("Pick(_o4_)")


def assert_hands_never_overfilled(actions: list[tuple[str, object]]) -> None:
    held: dict[str, str] = {}
    for name, command in actions:
        if isinstance(command, Pick):
            assert command.hand not in held, (name, held)
            held[command.hand] = name
        elif isinstance(command, Place):
            assert held.pop(command.hand) == name


def test_no_hand_is_closed_on_a_second_object_over_seeds() -> None:
    """ "It has to execute a place action because it is still holding"; over more seeds: `skolem sweep`."""
    for run in over("sim2_heavy_soda", range(4)):
        done = zip(run.actions, run.results, strict=True)
        assert_hands_never_overfilled([(act.args[0], act.command) for act, result in done if result.status == "done"])


@pytest.mark.physics
def test_no_hand_is_closed_on_a_second_object_with_the_physics() -> None:
    """ "It has to execute a place action because it is still holding _o2_"."""
    run = with_physics("illustrative")
    done = zip(run.actions, run.results, strict=True)
    assert_hands_never_overfilled([(act.args[0], act.command) for act, result in done if result.status == "done"])
    assert run.where("Place(o2") < run.where(f"Pick({run.end.anchor}")
