"""Collision-free paths by OMPL's RRT-Connect, reproducible.

A path is a function of (problem, seed) alone: OMPL's generators are reseeded before each plan, and every OMPL object of
a plan is made after that. Work is bounded by counting validity checks, never by a clock. A free straight segment needs
no planner. The result None, no path within the budget, is no error.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob, geometric as og, util as ou

Floats = NDArray[np.float64]

SHORTCUT_STEPS, SHORTCUT_EMPTY_STEPS = 60, 30


@dataclass(frozen=True, slots=True)
class Problem:
    """A motion planning problem.

    Attributes:
        lower: Lower bounds, shape (n,), rad or m.
        upper: Upper bounds, shape (n,).
        wraps: Which coordinates are angles without limits, shape (n,); their bounds are ignored.
        valid: Returns whether a configuration, shape (n,), is free of collision.
        resolution: Largest step between two configurations checked on an edge.
        stride: Longest edge that the trees grow, in rad or m.
        budget: Validity checks after which the planner gives up.
    """

    lower: Floats
    upper: Floats
    wraps: tuple[bool, ...]
    valid: Callable[[Floats], bool]
    resolution: float = 0.05
    stride: float = 0.6
    budget: int = 6000


def seed_of(seed: int, version: int, *stream: int) -> int:
    """Return an OMPL seed (31 bits, not 0) from the run's seed, the belief's version and the stream."""
    return int(np.random.SeedSequence([seed, version, *stream]).generate_state(1)[0] & 0x7FFFFFFF) + 1


def plan(problem: Problem, start: Floats, goal: Floats, seed: int) -> Floats | None:
    """Return a path from start to goal, shape (k, n), both ends included; None if none was found within the budget.

    Angles without limits take the shorter turn and run on from `start` without jumps.
    """
    goal = _shortest_turn(problem.wraps, start, goal)
    if not problem.valid(goal) or not problem.valid(start):
        return None
    if straight_is_free(problem, start, goal):
        return np.array([start, goal])
    return _rrt_connect(problem, start, goal, seed)


def straight_is_free(problem: Problem, start: Floats, goal: Floats) -> bool:
    """Return whether the segment between two free configurations is free at the problem's resolution."""
    count = max(1, math.ceil(float(np.linalg.norm(goal - start)) / problem.resolution))
    return all(problem.valid(start + (goal - start) * k / count) for k in _bisecting(count))


def _bisecting(count: int) -> list[int]:
    """Return 1..count-1, coarse first, so that a collision in the middle is found early."""
    out: list[int] = []
    gaps = [(0, count)]
    while gaps:
        wider: list[tuple[int, int]] = []
        for low, high in gaps:
            if high - low > 1:
                middle = (low + high) // 2
                out.append(middle)
                wider += [(low, middle), (middle, high)]
        gaps = wider
    return out


def _shortest_turn(wraps: tuple[bool, ...], start: Floats, goal: Floats) -> Floats:
    """Return the goal with its unlimited angles turned to within pi of the start's."""
    turned = start + (goal - start + math.pi) % (2.0 * math.pi) - math.pi
    return np.where(wraps, turned, goal)


def _rrt_connect(problem: Problem, start: Floats, goal: Floats, seed: int) -> Floats | None:
    """Return a shortcut path by RRT-Connect; every OMPL object is made here, after the reseed."""
    ou.setLogLevel(ou.LOG_NONE)  # OMPL reports a second reseed as an error, but carries it out
    ou.RNG.setSeed(seed)
    used = 0

    def check(state: Any) -> bool:
        nonlocal used
        used += 1
        return bool(problem.valid(np.array([state[i] for i in range(len(start))])))

    setup = og.SimpleSetup(_space(problem, start, goal))
    setup.setStateValidityChecker(check)
    setup.setStartAndGoalStates(_state(setup, start), _state(setup, goal))
    planner = og.RRTConnect(setup.getSpaceInformation())
    planner.setRange(problem.stride)
    setup.setPlanner(planner)
    status = setup.solve(ob.PlannerTerminationCondition(lambda: used > problem.budget))
    if not str(status).startswith("Exact"):
        return None
    path = setup.getSolutionPath()
    og.PathSimplifier(setup.getSpaceInformation()).reduceVertices(path, SHORTCUT_STEPS, SHORTCUT_EMPTY_STEPS)
    return np.array([[path.getState(k)[i] for i in range(len(start))] for k in range(path.getStateCount())])


def _space(problem: Problem, start: Floats, goal: Floats) -> Any:
    """Return a real vector space; an unlimited angle ranges over one turn around the middle of start and goal."""
    middle = (start + goal) / 2.0
    lower = np.minimum.reduce([np.where(problem.wraps, middle - math.pi, problem.lower), start, goal])
    upper = np.maximum.reduce([np.where(problem.wraps, middle + math.pi, problem.upper), start, goal])
    bounds = ob.RealVectorBounds(len(start))
    for i in range(len(start)):
        bounds.setLow(i, float(lower[i]))
        bounds.setHigh(i, float(upper[i]))
    space = ob.RealVectorStateSpace(len(start))
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(problem.resolution / space.getMaximumExtent())
    return space


def _state(setup: Any, values: Floats) -> Any:
    """Return an OMPL state with these values."""
    state = setup.getStateSpace().allocState()
    for i, value in enumerate(values):
        state[i] = float(value)
    return state
