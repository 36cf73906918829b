"""Goals about relations: both objects are looked at, and only what was shown to be so is believed."""

import pytest
from kit.recordings import recorded

from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, RunEnd

NEAR = "exists o. B(Den(lambda x. Can(x) & exists y. (Carton(y) & Near(x, y)), o), 0.85)"
BESIDE = "exists o. B(Den(lambda x. Can(x) & exists y. (Bottle(y) & Near(x, y)), o), 0.85)"
LADEN = "exists t. B(Den(lambda x. Table(x) & exists y. (On(y, x) & Carton(y)), t), 0.85)"


def ended(goal: str) -> tuple[RunEnd, list[str]]:
    trace = Trace(recorded("illustrative", 0, "symbolic", (f"goal={goal}",)))
    (end,) = trace.of(RunEnd)
    return end, [action.op for action in trace.of(Action)]


@pytest.mark.parametrize(("goal", "anchor"), [(NEAR, "o2"), (LADEN, "table")])
def test_a_thing_that_is_meant_by_its_relation_to_another_is_found_by_looking(goal: str, anchor: str) -> None:
    end, actions = ended(goal)
    assert (end.status, end.anchor) == ("goal_achieved", anchor)
    assert len(actions) <= 4
    assert not any(op.startswith(("Pick", "Place")) for op in actions)


def test_what_no_look_shows_is_given_up_and_not_called_impossible() -> None:
    end, actions = ended(BESIDE)
    assert end.status == "goal_unachievable"
    assert actions
    assert "found impossible" not in end.reason
