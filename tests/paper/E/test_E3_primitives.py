"""E3: the robot moves its base and arms, picks, places, looks and weighs; each is checked by the truth of one run."""

import math

import pytest
from kit.runs import Run, thing_in, with_physics

from skolem.traces.messages import LookAt, MoveBase, Pick, Place, Weigh

pytestmark = pytest.mark.physics

DRIFT_M = 0.15  # of a drive of two metres: four times what the wheels are stated to slip


@pytest.fixture(scope="module")
def run() -> Run:
    """The run of the second simulation, which has every primitive."""
    return with_physics("sim2_heavy_soda")


def done(run: Run, kind: type) -> list[int]:
    """Return the numbers of the actions of one kind that were done, at least one."""
    pairs = enumerate(zip(run.actions, run.results, strict=True))
    found = [i for i, (act, result) in pairs if isinstance(act.command, kind) and result.status == "done"]
    assert found
    return found


def test_driving_moves_the_base_to_where_it_was_told_but_for_the_slip(run: Run) -> None:
    """ "A mobile manipulation robot that can move its base"."""
    for i in done(run, MoveBase):
        command = run.actions[i].command
        assert isinstance(command, MoveBase)
        x, y, theta = run.truths[i].world_T_base
        ahead, left, _ = command.start_T_waypoint[-1]
        told = (
            x + math.cos(theta) * ahead - math.sin(theta) * left,
            y + math.sin(theta) * ahead + math.cos(theta) * left,
        )
        assert math.dist(run.truths[i + 1].world_T_base[:2], told) < DRIFT_M


def test_picking_takes_the_object_into_the_hand(run: Run) -> None:
    """ "... and arms, pick ... objects"."""
    for i in done(run, Pick):
        name, command = run.actions[i].args[0], run.actions[i].command
        assert isinstance(command, Pick)
        assert thing_in(run.truths[i], name).in_hand is None
        assert thing_in(run.truths[i + 1], name).in_hand == command.hand


def test_placing_puts_it_onto_the_support_that_was_named(run: Run) -> None:
    """ "... place objects"."""
    for i in done(run, Place):
        name, support = run.actions[i].args[:2]
        placed = thing_in(run.truths[i + 1], name)
        assert (placed.in_hand, placed.on) == (None, support)


def test_looking_changes_nothing_and_reports_what_is_there(run: Run) -> None:
    """ "... and look at them": a camera's image and, of the things in it, detections."""
    looks = done(run, LookAt)
    for i in looks:
        assert run.truths[i].objects == run.truths[i + 1].objects
        assert run.observations[i].view is not None
    assert sum(bool(run.observations[i].detections) for i in looks) >= len(looks) / 2


def test_weighing_feels_what_the_object_weighs(run: Run) -> None:
    """ "Force-torque measurements from the wrist for weight": within four times the sensor's stated error."""
    for i in done(run, Weigh):
        wrench = run.observations[i].wrench
        assert wrench is not None
        assert wrench.force_newton[2] == pytest.approx(
            -9.81 * thing_in(run.truths[i], run.actions[i].args[0]).kg, abs=4.0 * math.hypot(0.4, 0.05)
        )
