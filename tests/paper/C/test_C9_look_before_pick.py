"""C9: what is poorly localised is looked at before its picking is planned."""

import math
from functools import cache

import pytest
from kit.papers import (
    EXAMPLE_GOAL,
    GREEN_TO_TABLE1,
    STANDS,
    Handler,
    at_five_percent,
    can,
    example,
    holds,
    planned,
    posed,
    seen_as,
    shipped,
    steps_of,
    three_sodas,
)
from kit.plays import GREEN, Play
from kit.runs import Run, over, with_physics

NEAR_M, SEEN_M = 0.05, 0.02  # how well a place must be known to drive there; how well it is once seen, in the world


@cache
def vague() -> tuple[Play, dict[str, int]]:
    """Return a finished play about a soda known to be green, to 10 cm, and at which action each question came first."""
    things = three_sodas()
    things["sodaC"].hsv, things["sodaC"].hsv_sd, things["sodaC"].pose_sd = (GREEN, 0.9, 0.8), 0.01, 0.1
    play, first = Play(shipped(), GREEN_TO_TABLE1, things), dict[str, int]()
    for turn in play.turns_to_the_end():
        for question in play.geometry.asked:
            first.setdefault(question, len(play.turns) if turn.action is None else turn.action.step)
    return play, first


def test_the_first_action_on_an_object_known_to_10_cm_is_a_look() -> None:
    """ "A robot cannot attempt to pick up an object unless its belief about the location has low variance." """
    play, _ = vague()
    operators = [t.action.op for t in play.turns if t.action is not None and not t.action.op.startswith("Move")]
    assert operators[0] == "LookAt(sodaC)"
    assert operators.index("LookAt(sodaC)") < operators.index("Pick(sodaC)")


def test_no_grasp_is_computed_before_that_look() -> None:
    """ "It is impossible to plan in detail for how to pick it up." """
    play, first = vague()
    looked = next(t.action.step for t in play.turns if t.action is not None and t.action.op == "LookAt(sodaC)")
    grasps = [step for question, step in first.items() if "pick(" in question]
    assert grasps
    assert min(grasps) > looked


def test_the_demand_on_the_pose_comes_with_the_level() -> None:
    """ "Which will depend on the object's pose, what other objects might surround it": postponed until it is known."""
    things = example().belief
    things.things["o2"].pose_sd = 0.1
    steps = steps_of(planned(posed(EXAMPLE_GOAL, things), "holding(o2)", level=1))
    assert [str(step.instance.step) for step in steps][-2:] == ["look(o2)", "pick(left,o2)"]


def test_a_look_makes_a_real_belief_good_enough_to_grasp() -> None:
    """ "Look at _o2_ to localize its pose, and then pick it up." """
    robot = Handler(at_five_percent([can(sd_m=0.1)]))
    near, tight = (f"bn(pose(can1),any,sd({mm},{mm},any),any,223144)" for mm in (50, 8))
    assert not holds(near, robot.belief)
    robot.see(seen_as(STANDS))
    assert holds(tight, robot.belief)


def sd_m(run: Run, step: int, name: str) -> float:
    """Return how well the place of an object was known before an action."""
    return math.sqrt(run.beliefs[step].objects[name].covariance[0])


def assert_looked_at_first(run: Run) -> None:
    """Assert that the bottles, told of to 10 cm, are seen before anything of their picking is computed."""
    picked = list(dict.fromkeys(run.named("Pick")))
    assert picked
    assert run.operators[0].startswith(("LookAt(", "Move(look("))
    for name in picked:
        asked = [sd_m(run, question.step, name) for question in run.asked("pick", name)]
        assert sd_m(run, 0, name) == pytest.approx(0.1)
        assert sum(sd >= NEAR_M for sd in asked) == 0
        assert len(asked) >= 1
        assert sd_m(run, run.where(f"Pick({name})"), name) < SEEN_M


def test_over_seeds_what_is_known_to_10_cm_is_looked_at_before_its_picking_is_planned() -> None:
    """ "It is impossible to plan in detail for how to pick it up", counted in the recorded questions."""
    for run in over("real1_oil", range(4)):
        assert_looked_at_first(run)


@pytest.mark.physics
def test_with_the_physics_too() -> None:
    """ "A robot cannot attempt to pick up an object unless its belief about the location has low variance." """
    assert_looked_at_first(with_physics("real1_oil"))
