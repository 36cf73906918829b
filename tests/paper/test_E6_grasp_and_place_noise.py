"""E6: grasping and placing are noisy, and the robot knows it."""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from papers import Handler, at_five_percent, can
from runs import Run, over
from tabletop import EXACT, TABLE_M, TYPES, near_table
from tabletop import can as true_can

from skolem.sim.poses import compose4, inverse4
from skolem.sim.symbolic import SymbolicWorld
from skolem.sim.symbolic_arm import CARRY, reach
from skolem.traces.messages import Action, Pick, Place, Pose4

SEEDS = 200
GRASP_M, PLACE_M = 0.006, 0.003
TOOL: Pose4 = (0.6, -0.2, TABLE_M + 0.07, 0.0)
IN_HAND: Pose4 = (0.0, 0.0, -0.07, 0.0)


def handled(seed: int, **noise: float) -> tuple[Pose4, Pose4]:
    """Pick the can and put it back; return tool_T_object in the hand, and where it stands afterwards."""
    world = SymbolicWorld(TYPES, near_table(true_can()), (0.0, 0.0, 0.0), 0.2, EXACT.model_copy(update=noise), seed)
    joints = reach("right", 0.2, TOOL)
    assert joints is not None
    path, carry = (joints,), (CARRY["right"],)
    pick = Pick(hand="right", approach=path, reach=path, lift=path, carry=path, tool_T_object=IN_HAND)
    place = Place(hand="right", approach=path, lower=path, retreat=path, carry=carry)
    world.execute(Action(step=0, op="test", args=(), command=pick))
    held = world.state(1).objects[-1].world_T_object
    world.execute(Action(step=1, op="test", args=(), command=place))
    return compose4(inverse4(TOOL), held), world.state(2).objects[-1].world_T_object


def sds(poses: list[Pose4]) -> NDArray[np.float64]:
    """Return the scatter of places, metres."""
    return np.asarray(np.std(np.array(poses)[:, :2], axis=0))


def test_grasps_and_places_scatter_with_the_sd_that_the_scenario_states() -> None:
    """ "Due to noise in detections and nondeterminism": an object moves when fingers close on it and when they open."""
    in_hand = [handled(seed, grasp_sd_m=GRASP_M)[0] for seed in range(SEEDS)]
    assert sds(in_hand) == pytest.approx(np.full(2, GRASP_M), rel=0.2)
    placed = [handled(seed, place_sd_m=PLACE_M)[1] for seed in range(SEEDS)]
    assert sds(placed) == pytest.approx(np.full(2, PLACE_M), rel=0.2)
    both = [handled(seed, grasp_sd_m=GRASP_M, place_sd_m=PLACE_M)[1] for seed in range(SEEDS)]
    assert sds(both) == pytest.approx(np.full(2, math.hypot(GRASP_M, PLACE_M)), rel=0.2)


def variances(grasp_sd_m: float = 0.0, place_sd_m: float = 0.0) -> tuple[float, float]:
    """Return the believed variance along x while a well-known can is held and after it was placed, square metres."""
    robot = Handler(at_five_percent([can(sd_m=0.001)], grasp_sd_m=grasp_sd_m, place_sd_m=place_sd_m))
    robot.pick("can1")
    held = robot.belief.snapshot(0).objects["can1"].covariance[0]
    robot.place("can1", "table1", (0.8, 0.2, 0.0))
    return held, robot.belief.snapshot(0).objects["can1"].covariance[0]


def test_after_a_place_the_pose_is_as_uncertain_as_grasp_and_place_together() -> None:
    """ "_o1_ ... (10, 10), med": what was put somewhere is known less well than what was looked at."""
    exact, grasped = variances(), variances(grasp_sd_m=GRASP_M)
    assert grasped[0] - exact[0] == pytest.approx(GRASP_M**2, rel=0.2)
    placed = variances(grasp_sd_m=GRASP_M, place_sd_m=PLACE_M)[1]
    assert placed - grasped[1] == pytest.approx(PLACE_M**2, rel=0.05)
    assert placed > 0.95 * (GRASP_M**2 + PLACE_M**2)


def test_over_seeds_no_two_places_of_whole_runs_are_the_same() -> None:
    """ "We repeated the experiment multiple times": how far off each place is, is measured by `skolem sweep`."""
    ends = sorted(_where_it_stands(run) for run in over("sim1_green", range(4)) if run.achieved)
    assert len(ends) == 4
    assert all(math.dist(a, b) > 1e-4 for a, b in pairwise(ends))


def _where_it_stands(run: Run) -> tuple[float, ...]:
    """Return where the object of a successful run truly stands."""
    witness = next(thing for thing in run.truths[-1].objects if thing.id == run.verdict.witness)
    return witness.world_T_object[:2]
