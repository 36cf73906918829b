"""C18 and A4: covariances are those of the new place, also when an object was pushed far."""

import numpy as np
import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, seen_as

from skolem.traces.messages import Pick


@pytest.mark.parametrize("now", [(1.03, 0.02, 0.7, 0.0), (1.01, 0.0, 0.7, 0.0)])
def test_one_look_after_a_failed_pick_tells_the_pose_as_well_as_one_before_it(
    now: tuple[float, float, float, float],
) -> None:
    """ "Look at _o2_ to localize its pose": 2 mm, wherever the failed pick has pushed it."""
    robot = Handler(at_five_percent([can()]))
    robot.see(seen_as(STANDS))
    before = np.sqrt(np.diag(robot.belief.gaussian("pose", "can1").covariance))[:2]
    command = Pick(hand="right", approach=(), reach=(), lift=(), carry=(), tool_T_object=(0.0, 0.0, -0.05, 0.0))
    robot.do(command, ("can1",), base_T_tool=(1.0, 0.0, 0.75, 0.0), gripper_gap_m=0.0, status="failed")
    robot.see(seen_as(now))
    after = np.sqrt(np.diag(robot.belief.gaussian("pose", "can1").covariance))[:2]
    assert after == pytest.approx(before, rel=0.2)
