"""Goals and scenarios beyond those that ship: pursued, refused with a reason, given up honestly; never an error."""

import re

import pytest
from kit.places import SCENARIOS
from kit.recordings import recorded

from skolem.sim.scenario.scenario import prior_of
from skolem.tools.loop.setup import prepare
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Observation, RobotState, RunEnd, Verdict
from skolem.traces.messages.arm import CARRY

MODEL = (  # of the noise, as in the scenarios
    "{depth: {sd_scale: 1.0}, extrinsics: {sd_m: 0.003, sd_rad: 0.004}, "
    "detection: {found: 0.9, false_per_look: 0.1, type_right: 0.95}, colour: {gain: 0.83, sd_rgb: 0.03}, "
    "odometry: {sd_m: 0.005, sd_per_m: 0.02, sd_rad: 0.01, sd_per_rad: 0.02}, "
    "wrist: {sd_newton: 0.40, drift_newton: 0.05}, grasp: {sd_m: 0.006, sd_rad: 0.05}, "
    "place: {sd_m: 0.003, sd_rad: 0.03}}"
)
WAS = "exists o. B(Den({}, o), 0.9) & B(On(o, table1), 0.9)"
GREEN = SCENARIOS / "sim1_green.yaml"


def ended(goal: str, *overrides: str) -> tuple[RunEnd, int]:
    """Return how a run without physics ends, and after how many actions."""
    trace = Trace(recorded("sim1_green", 0, "symbolic", (f"goal={goal}", *overrides)))
    (end,) = trace.of(RunEnd)
    return end, len(list(trace.of(Action)))


def test_what_a_thing_is_to_be_put_on_may_be_described_too() -> None:
    described = "B(Den(lambda x. Red(x), o), 0.9) & B(On(o, p), 0.9) & B(Den(lambda x. Table(x), p), 0.9)"
    end, _ = ended(f"exists o, p. {described}")
    assert end.status == "goal_achieved"


@pytest.mark.parametrize(
    "described", ["lambda x. Soda(x) & Was(On(x, table2))", "the x. Soda(x) & On(x, table2)"], ids=["was", "the"]
)
def test_what_stood_elsewhere_is_meant_while_it_is_moved(described: str) -> None:
    """The soda of table2 is still the one that was there when it stands on table1, beside another."""
    trace = Trace(recorded("sim1_green", 0, "symbolic", (f"goal={WAS.format(described)}",)))
    (end,), (judged,) = trace.of(RunEnd), trace.of(Verdict)
    assert (end.status, judged.true) == ("goal_achieved", True)
    assert judged.witness == end.anchor


def test_of_alternatives_the_one_that_is_known_to_hold_is_pursued() -> None:
    end, actions = ended("exists o. B(Den(lambda x. Light(x) & (Green(x) | Red(x)), o), 0.9)")
    assert end.status == "goal_achieved"
    assert actions <= 10  # a look and a weighing, with the drives; not every thing in the room


def test_of_alternatives_one_that_is_refuted_is_left_for_another() -> None:
    """The red thing on table1 is not green, which a look shows; it is heavy, which a weighing does."""
    heavy = "exists o. B(Den(lambda x. Green(x) | Heavy(x), o), 0.9) & B(In(o, table1), 0.9)"
    trace = Trace(recorded("sim1_green", 0, "symbolic", (f"goal={heavy}", "world.3.kg=0.8")))
    (end,) = trace.of(RunEnd)
    assert (end.status, end.anchor) == ("goal_achieved", "sodaE")
    assert len(list(trace.of(Action))) < 12


def test_a_property_that_a_look_refutes_is_not_looked_for_again() -> None:
    end, actions = ended("B(Green(sodaE), 0.9)")
    assert (end.status, actions) == ("goal_unachievable", 2)


def test_steps_that_are_too_unlikely_are_not_called_impossible() -> None:
    end, _ = ended("exists o. B(Den(lambda x. Green(x), o), 0.9)", "limits.min_plan_probability=0.12")
    assert end.status == "goal_unachievable"
    assert "; too unlikely in detail: ExamineObj(e1, sodaB), " in end.reason
    assert "impossible" not in end.reason


def test_what_is_heavier_than_a_number_is_found_out_by_weighing() -> None:
    goal = "goal=exists o. B(Den(lambda x. Soda(x) & HeavierThan(x, 450), o), 0.9)"
    trace = Trace(recorded("sim2_heavy_soda", 0, "symbolic", (goal,)))
    (end,) = trace.of(RunEnd)
    assert (end.status, end.anchor) == ("goal_achieved", "sodaC")
    assert [action.args[0] for action in trace.of(Action) if action.command.kind == "weigh"] == [
        "sodaE",
        "sodaB",
        "sodaC",
    ]
    assert min(end.conjuncts["heavier_than_450"], end.conjuncts["soda"]) > 0.9


def test_more_certainty_than_one_reading_gives_takes_more_readings() -> None:
    def weighings(p: float) -> int:
        trace = Trace(recorded("sim1_green", 0, "symbolic", (f"goal=B(Light(sodaC), {p})",)))
        (end,) = trace.of(RunEnd)
        assert end.status == "goal_achieved"
        return sum(action.command.kind == "weigh" for action in trace.of(Action))

    assert weighings(0.9) < weighings(0.999999)


@pytest.mark.parametrize(
    "conjunct",
    ["B(Den(lambda x. Green(x), sodaE), 0.995)", "B(In(sodaE, table1), 0.995)", "B(Weight(sodaE), any, 0.5, 1, 0.995)"],
)
def test_more_certainty_than_that_anything_exists_is_refused_before_the_run(conjunct: str) -> None:
    """What stands on the table already would be taken off it and put back, for a belief that no look gives."""
    with pytest.raises(InputError, match=r"is ever believed to exist with more than 0.99, .* ask for at most 0.99"):
        prepare(GREEN, [f"goal={conjunct}"])


def test_a_quantity_that_is_not_known_well_enough_counts_against_the_goal() -> None:
    end, _ = ended("B(Weight(sodaE), any, 0.01, 1, 0.9)")
    assert (end.status, end.anchor, end.goal_probability) == ("goal_unachievable", "sodaE", 0.0)


def test_searches_that_stopped_at_their_limit_are_said_to_have_although_a_later_one_did_not() -> None:
    trace = Trace(recorded("behind", 0, "symbolic", ("limits.expansions=1",)))
    (end,) = trace.of(RunEnd)
    assert end.status == "goal_unachievable"
    assert re.search(r"; stopped after \d+ expansions \(\d times limits.expansions\)", end.reason)


def test_only_a_search_that_stopped_at_its_limit_is_said_to_have() -> None:
    end, _ = ended("exists o. B(Den(lambda x. Purple(x), o), 0.9)", "limits.expansions=4")
    assert end.status == "goal_unachievable"
    assert "stopped after" not in end.reason


@pytest.mark.parametrize(
    ("conjunct", "said"),
    [
        ("B(Near(sodaE, sodaB), 0.9)", "Near is for descriptions only"),
        ("B(HeavierThan(sodaE, 100), 0.9)", "expected an object, found the number 100"),
        ("B(Den(lambda x. Near(x, 5), sodaE), 0.9)", "Near is between objects, found the number 5"),
        ("B(Den(lambda x. Near(x, x), sodaE), 0.9)", "Near is never true of an object and itself"),
        ("B(Den(lambda x. HeavierThan(5, 100), sodaE), 0.9)", "HeavierThan is of an object first"),
        ("B(Den(lambda x. HeavierThan(x, 3000000), sodaE), 0.9)", "3000000 is too large a number"),
    ],
)
def test_a_relation_that_nothing_can_tell_is_refused(conjunct: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        prepare(GREEN, [f"goal={conjunct}"], world="symbolic")


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ("B(Den(lambda x. Can(x) & Soda(x), sodaE), 0.9)", r"Can\(sodaE\) and Soda\(sodaE\) exclude each other"),
        (
            "exists o. B(Den(lambda x. On(x, table2), o), 0.9) & B(On(o, table1), 0.9)",
            r"both can never be believed, since .* say Was\(On\(o, table2\)\)",
        ),
    ],
)
def test_a_goal_that_no_world_satisfies_is_refused_before_the_run(goal: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        prepare(GREEN, [f"goal={goal}"], world="symbolic")


# ---------------------------------------------------------------- odd scenarios


def test_a_detector_that_is_believed_to_find_nothing_is_no_error() -> None:
    model = MODEL.replace("found: 0.9", "found: 0.0")
    end, _ = ended("exists o. B(Den(lambda x. Green(x), o), 0.9)", f"model={model}")
    assert end.status in ("goal_achieved", "goal_unachievable", "limit_reached")


def test_what_the_camera_is_believed_to_err_by_is_all_that_a_detection_knows_of_it() -> None:
    spreads = []
    for sd in ("0.003", "0.03"):
        trace = Trace(recorded("sim1_green", 0, "symbolic", (f"model={MODEL}", f"noise.extrinsics.sd_m={sd}")))
        seen = next(seen for seen in trace.of(Observation) if seen.detections)
        spreads.append(seen.detections[0].covariance[0] ** 0.5)
    assert spreads[0] == pytest.approx(spreads[1], abs=0.002)


def test_what_a_thing_stands_on_does_not_depend_on_the_order_in_which_they_are_told() -> None:
    rows = "{id: sodaC, type: {soda: 1.0}, like: world}, {id: table3, type: {table: 1.0}, like: world}"
    setup = prepare(GREEN, [f"belief.objects=[{rows}]", "goal=KRD(sodaC)"], world="symbolic")
    prior = prior_of(setup.scenario, setup.types, 0, RobotState(right_arm=CARRY["right"], left_arm=CARRY["left"]))
    assert [item.support for item in prior.objects] == ["table3", None]


def test_the_name_of_the_robots_own_place_is_refused() -> None:
    rows = "{id: base, type: {soda: 1.0}, at: [1.0, 0.0, 0.0]}"
    with pytest.raises(InputError, match="'base' is the robot's own"):
        prepare(GREEN, [f"belief.objects=[{rows}]"], world="symbolic")
