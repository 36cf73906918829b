"""Goals beyond those of the scenarios: pursued, refused with a reason, or given up honestly; never an error."""

from pathlib import Path

import pytest
from recordings import recorded

from skolem.tools.session import prepare
from skolem.traces.errors import InputError
from skolem.traces.messages import Action, RunEnd
from skolem.traces.reader import Trace

GREEN = Path(__file__).parent.parent / "scenarios" / "sim1_green.yaml"


def ended(goal: str, *overrides: str) -> tuple[RunEnd, int]:
    """Return how a run without physics ends, and after how many actions."""
    trace = Trace(recorded("sim1_green", 0, "symbolic", (f"goal={goal}", *overrides)))
    (end,) = trace.of(RunEnd)
    return end, len(list(trace.of(Action)))


def test_what_a_thing_is_to_be_put_on_may_be_described_too() -> None:
    described = "B(Den(lambda x. Red(x), o), 0.9) & B(On(o, p), 0.9) & B(Den(lambda x. Table(x), p), 0.9)"
    end, _ = ended(f"exists o, p. {described}")
    assert end.status == "goal_achieved"


def test_of_alternatives_the_one_that_is_known_to_hold_is_pursued() -> None:
    end, actions = ended("exists o. B(Den(lambda x. Light(x) & (Green(x) | Red(x)), o), 0.9)")
    assert end.status == "goal_achieved"
    assert actions <= 10  # a look and a weighing, with the drives; not every thing in the room


def test_of_more_certainty_than_any_sensor_gives_the_robot_says_that_it_is_out_of_reach() -> None:
    end, _ = ended("exists o. B(Den(lambda x. Green(x) & Soda(x), o), 0.999999)")
    assert end.status == "goal_unachievable"


def test_a_quantity_that_is_not_known_well_enough_counts_against_the_goal() -> None:
    end, _ = ended("B(Weight(sodaE), any, 0.01, 1, 0.9)")
    assert (end.status, end.anchor, end.goal_probability) == ("goal_unachievable", "sodaE", 0.0)


def test_only_a_search_that_stopped_at_its_limit_is_said_to_have() -> None:
    end, _ = ended("exists o. B(Den(lambda x. Purple(x), o), 0.9)", "limits.expansions=4")
    assert end.status == "goal_unachievable"
    assert "stopped after" not in end.reason


@pytest.mark.parametrize(
    ("conjunct", "said"),
    [
        ("B(Near(sodaE, sodaB), 0.9)", "Near is told of described objects only"),
        ("B(HeavierThan(sodaE, 100), 0.9)", "expected an object, found the number 100"),
        ("B(Den(lambda x. Near(x, 5), sodaE), 0.9)", "Near is between objects, found the number 5"),
        ("B(Den(lambda x. HeavierThan(x, sodaB), sodaE), 0.9)", "compares with a number, found sodaB"),
        ("B(Den(lambda x. HeavierThan(5, 100), sodaE), 0.9)", "HeavierThan is of an object first"),
        ("B(Den(lambda x. HeavierThan(x, 3000000), sodaE), 0.9)", "3000000 is too large a number"),
    ],
)
def test_a_relation_that_nothing_can_tell_is_refused(conjunct: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        prepare(GREEN, [f"goal={conjunct}"], world="symbolic")
