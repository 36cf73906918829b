import math
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from skolem.sim.planner import motion
from skolem.sim.planner.motion import Floats, Problem

START, GOAL = np.array([-1.0, 0.0]), np.array([1.0, 0.0])


def around_a_wall(point: Floats) -> bool:
    """A wall at x = 0 that is open above y = 0.8."""
    return bool(abs(point[0]) > 0.1 or point[1] > 0.8)


def flat(valid: Callable[[Floats], bool] = around_a_wall, budget: int = 6000) -> Problem:
    return Problem(np.array([-2.0, -2.0]), np.array([2.0, 2.0]), (False, False), valid, budget=budget)


def test_a_path_leads_around_the_wall() -> None:
    path = motion.plan(flat(), START, GOAL, seed=1)
    assert path is not None
    assert np.array_equal(path[0], START)
    assert np.array_equal(path[-1], GOAL)
    fine = [a + (b - a) * s for a, b in pairwise(path) for s in np.linspace(0.0, 1.0, 200)]
    assert all(around_a_wall(point) for point in fine)


def test_the_same_seed_gives_the_same_path_whatever_was_planned_before() -> None:
    first = motion.plan(flat(), START, GOAL, seed=7)
    motion.plan(flat(), GOAL, np.array([-1.5, -1.5]), seed=3)
    again = motion.plan(flat(), START, GOAL, seed=7)
    other = motion.plan(flat(), START, GOAL, seed=8)
    assert first is not None
    assert again is not None
    assert other is not None
    assert first.tobytes() == again.tobytes() != other.tobytes()


def test_another_process_plans_the_same_path() -> None:
    code = (
        "import numpy as np, hashlib\nfrom skolem.sim.planner import motion\n"
        "free = lambda q: abs(q[0]) > 0.1 or q[1] > 0.8\n"
        "problem = motion.Problem(np.array([-2.0, -2.0]), np.array([2.0, 2.0]), (False, False), free)\n"
        "path = motion.plan(problem, np.array([-1.0, 0.0]), np.array([1.0, 0.0]), 7)\n"
        "print(path.tobytes().hex())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    path = motion.plan(flat(), START, GOAL, seed=7)
    assert path is not None
    assert done.stdout.split()[-1] == path.tobytes().hex()


def test_a_free_straight_line_needs_no_planner() -> None:
    path = motion.plan(flat(lambda point: True), START, GOAL, seed=1)
    assert path is not None
    assert path.tolist() == [START.tolist(), GOAL.tolist()]


def test_a_start_or_goal_in_collision_has_no_path() -> None:
    inside = np.array([0.0, 0.0])
    assert motion.plan(flat(), inside, GOAL, seed=1) is None
    assert motion.plan(flat(), START, inside, seed=1) is None


def test_an_impossible_problem_ends_when_its_budget_is_spent() -> None:
    checks = 0

    def two_rooms(point: Floats) -> bool:
        nonlocal checks
        checks += 1
        return bool(abs(point[0]) > 0.1)

    assert motion.plan(flat(two_rooms, budget=500), START, GOAL, seed=1) is None
    assert 500 < checks < 700


def test_an_endless_joint_takes_the_shorter_turn() -> None:
    problem = Problem(np.array([-math.pi]), np.array([math.pi]), (True,), lambda point: True)
    path = motion.plan(problem, np.array([3.0]), np.array([-3.0]), seed=1)
    assert path is not None
    assert path[-1, 0] == pytest.approx(2.0 * math.pi - 3.0)


def test_seeds_differ_by_version_and_purpose_and_suit_ompl() -> None:
    seeds = {motion.seed_of(0, version, stream) for version in range(20) for stream in range(5)}
    assert len(seeds) == 100
    assert all(0 < seed <= 2**31 for seed in seeds)
    assert motion.seed_of(0, 1, 2) == motion.seed_of(0, 1, 2)
