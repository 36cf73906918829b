"""Events of what joints say of an action: how far a drive is trusted."""

import math

import pytest
from kit.beliefs import EXACT, STRETCHED

from skolem.estimation.acting import events_of
from skolem.estimation.config import EstimatorConfig
from skolem.estimation.events import Moved
from skolem.traces.messages import Action, ActionResult, MoveBase, Pose2, RobotState

WHEELS = EXACT.model_copy(
    update={"odometry_sd_m": 0.01, "odometry_sd_per_m": 0.1, "odometry_sd_rad": 0.02, "odometry_sd_per_rad": 0.2}
)


def driven(start_T_end: Pose2) -> Moved:
    """Return the event of a drive that the wheels report as commanded."""
    action = Action(step=0, op="drive", args=(), command=MoveBase(start_T_waypoint=(start_T_end,)))
    robot = RobotState(right_arm=STRETCHED, left_arm=STRETCHED)
    result = ActionResult(step=0, status="done", robot=robot, odometry=start_T_end)
    [_, moved] = events_of(action, result, {}, WHEELS, EstimatorConfig())
    assert isinstance(moved, Moved)
    return moved


@pytest.mark.parametrize("turn", [0.5, -0.5])
def test_turn_to_either_side_is_as_uncertain_as_it_is_wide(turn: float) -> None:
    moved = driven((0.0, 0.0, turn))
    assert moved.sd_rad == pytest.approx(0.02 + 0.2 * 0.5)
    assert moved.sd_m == pytest.approx(0.01)


@pytest.mark.parametrize("way", [(3.0, 4.0), (-3.0, 4.0), (3.0, -4.0)])
def test_drive_in_any_direction_is_as_uncertain_as_it_is_long(way: tuple[float, float]) -> None:
    moved = driven((*way, 0.0))
    assert moved.sd_m == pytest.approx(0.01 + 0.1 * math.hypot(*way))
    assert moved.sd_rad == pytest.approx(0.02)
