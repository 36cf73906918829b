"""E6: grasping and placing are noisy, and the robot knows it.

The symbolic world draws how far things slip. With physics nothing is drawn: fingers push and things fall as they do,
and the test is whether that stays within what the robot believes of it.
"""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from kit.papers import Handler, at_five_percent, can
from kit.runs import Run, over, thing_in, with_physics
from kit.tabletop import EXACT, TABLE_M, TYPES, can as true_can, near_table
from numpy.typing import NDArray
from scipy.stats import chi2

from skolem.estimation import arm
from skolem.sim.symbolic.arm import reach
from skolem.sim.symbolic.world import SymbolicWorld
from skolem.traces.messages import Action, ActionResult, Hand, Pick, Place, Pose4, TrueState
from skolem.traces.messages.arm import CARRY
from skolem.traces.messages.poses import compose4, inverse4, raised

SEEDS = 200
GRASP_M, PLACE_M = 0.006, 0.003  # as every scenario states
ONCE_IN_A_THOUSAND = 0.999
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


@pytest.mark.physics
def test_with_physics_things_slip_no_further_than_the_robot_believes() -> None:
    """ "Due to noise in detections and nondeterminism": what contacts do is covered by the sds of grasp and place."""
    grasped: list[float] = []
    placed: list[float] = []
    for name in ("illustrative", "sim2_heavy_soda", "real1_oil"):
        for kind, slip in _slips(with_physics(name)):
            among, sd = (grasped, GRASP_M) if kind == "pick" else (placed, PLACE_M)
            among.append((slip[0] ** 2 + slip[1] ** 2) / sd**2)
    assert min(len(grasped), len(placed)) >= 6
    for squares in (grasped, placed):
        assert sum(squares) < chi2.ppf(ONCE_IN_A_THOUSAND, 2 * len(squares))


def _slips(run: Run) -> Iterator[tuple[str, Pose4]]:
    """Yield how far off things were in their own frames, as planned once fingers closed, as held once they opened."""
    held: dict[Hand, tuple[str, Pose4]] = {}
    for i, (action, result) in enumerate(zip(run.actions, run.results, strict=True)):
        command, before, after = action.command, run.truths[i], run.truths[i + 1]
        if result.status != "done" or not isinstance(command, Pick | Place) or result.base_T_tool is None:
            continue
        if isinstance(command, Pick):
            thing = next(thing for thing in after.objects if thing.in_hand == command.hand)
            planned = _carried(after, result, command)
            slip = compose4(inverse4(planned), thing.world_T_object)
            held[command.hand] = (thing.id, compose4(command.tool_T_object, slip))
        else:
            name, tool_T_object = held.pop(command.hand)
            released = compose4(compose4(raised(before.world_T_base), result.base_T_tool), tool_T_object)
            slip = compose4(inverse4(released), thing_in(after, name).world_T_object)
        yield command.kind, slip


def _carried(truth: TrueState, result: ActionResult, pick: Pick) -> Pose4:
    """Return world_T_object as it would be if what a hand has picked were in it as planned."""
    base_T_object = arm.base_T_tool(result.robot, pick.hand) @ arm.upright(*pick.tool_T_object)
    return compose4(raised(truth.world_T_base), raised(arm.flattened(base_T_object), float(base_T_object[2, 3])))
