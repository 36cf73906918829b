import math

import numpy as np
import pytest

from skolem.estimation.arm import base_T_tool, flattened, upright
from skolem.traces.messages import RobotState

STRETCHED = (0.0,) * 7


def test_hands_of_stretched_arms_are_where_the_model_puts_them() -> None:
    robot = RobotState(right_arm=STRETCHED, left_arm=STRETCHED)
    right, left = base_T_tool(robot, "right"), base_T_tool(robot, "left")
    assert right[:3, 3] == pytest.approx((0.951, -0.188, 0.790675))
    assert left[:3, 3] == pytest.approx((0.951, 0.188, 0.790675))
    assert right[:3, :3] == pytest.approx(np.eye(3))


def test_torso_lifts_both_hands() -> None:
    low, high = (RobotState(torso=t, right_arm=STRETCHED, left_arm=STRETCHED) for t in (0.0, 0.3))
    for hand in ("right", "left"):
        assert base_T_tool(high, hand)[2, 3] - base_T_tool(low, hand)[2, 3] == pytest.approx(0.3)


def test_bent_elbow_folds_the_forearm_about_the_level_axis() -> None:
    bent = RobotState(right_arm=(0.0, 0.0, 0.0, -math.pi / 2, 0.0, 0.0, 0.0), left_arm=STRETCHED)
    assert base_T_tool(bent, "right")[:3, 3] == pytest.approx((0.45, -0.188, 0.790675 + 0.501))


def test_pan_turns_the_arm_about_the_shoulder() -> None:
    panned = RobotState(right_arm=STRETCHED, left_arm=(math.pi / 2, *STRETCHED[1:]))
    assert flattened(base_T_tool(panned, "left")) == pytest.approx((-0.05, 0.188 + 1.001, math.pi / 2))


def test_flattened_undoes_upright() -> None:
    assert flattened(upright(0.1, 0.2, 0.3, -0.7)) == pytest.approx((0.1, 0.2, -0.7))
