"""D5: the force-torque sensor at the right wrist gives indirect observations of the held object's weight."""

import math

import pytest
from kit.papers import Handler, at_five_percent, can
from kit.runs import Stage, over, thing_in, with_physics
from kit.tabletop import can as true_can, pick_at

from skolem.traces.messages import Joints7, Pick, Weigh
from skolem.traces.messages.arm import CARRY

pytestmark = pytest.mark.physics

SLACK_NEWTON = 0.02
CAN = (0.6, -0.2, 0.68, 0.0)


def lifted(stage: Stage, carry: tuple[Joints7, ...]) -> Pick:
    """Pick the can of the stage."""
    pick = pick_at(stage.world.robot_state(), CAN).model_copy(update={"carry": carry})
    assert stage.do(pick)[0].status == "done"
    return pick


@pytest.mark.parametrize("carry", [(), (CARRY["right"],)], ids=["lifted", "carried"])
def test_the_force_is_the_objects_weight_in_whatever_pose_the_arm_is(carry: tuple[Joints7, ...]) -> None:
    """ "The right wrist has a (very noisy) 6-axis force-torque sensor": the pull of the hand is taken off."""
    with Stage([true_can()]) as stage:
        empty = stage.do(Weigh(hand="right"))[1].wrench
        lifted(stage, carry)
        full = stage.do(Weigh(hand="right"))[1].wrench
    assert empty is not None
    assert full is not None
    assert empty.force_newton == pytest.approx((0.0, 0.0, 0.0), abs=SLACK_NEWTON)
    assert full.force_newton == pytest.approx((0.0, 0.0, -9.81 * 0.35), abs=SLACK_NEWTON)


def test_the_left_wrist_has_no_sensor_and_the_robot_never_asks_it() -> None:
    """ "The right wrist has a ... force-torque sensor." """
    with Stage([true_can()]) as stage:
        result, observation = stage.do(Weigh(hand="left"))
    assert (result.status, observation.wrench) == ("failed", None)
    runs = [with_physics("sim2_heavy_soda"), with_physics("real1_oil"), *over("real1_oil", range(4))]
    hands = [act.command.hand for run in runs for act in run.actions if isinstance(act.command, Weigh)]
    assert len(hands) >= 10
    assert set(hands) == {"right"}


def test_a_reading_is_an_indirect_observation_that_several_make_certain() -> None:
    """ "Indirect observations of the weight of the object the robot is holding." """
    robot = Handler(at_five_percent([can()], wrist_sd_newton=0.4, wrist_drift_newton=0.05))
    before = robot.belief.snapshot(0).objects["can1"].log_weight[1]
    robot.pick("can1")
    variances = [before]
    for _ in range(3):
        robot.weigh(0.5)
        variances.append(robot.belief.snapshot(0).objects["can1"].log_weight[1])
    assert variances == sorted(variances, reverse=True)
    assert math.exp(robot.belief.snapshot(0).objects["can1"].log_weight[0]) == pytest.approx(0.5, rel=0.1)


def test_what_was_weighed_in_a_whole_run_is_believed_to_weigh_what_it_weighs() -> None:
    """ "Force-torque measurements from the wrist for weight"; over seeds: `skolem sweep`, docs/results.md."""
    run = with_physics("sim2_heavy_soda")
    for anchor in run.named("Weigh"):
        mean, variance = run.beliefs[-1].objects[anchor].log_weight
        assert abs(mean - math.log(thing_in(run.truths[-1], anchor).kg)) < 3.0 * math.sqrt(variance)
