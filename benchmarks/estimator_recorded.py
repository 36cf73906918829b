"""Errors of the belief along runs in the simulators: from the trace of a whole run, or of a tour of looks."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from skolem.estimation.belief import Belief
from skolem.estimation.se2 import between, flat
from skolem.estimation.se2 import log as tangent
from skolem.sim.pybullet_world import PyBulletWorld
from skolem.sim.scenario import prior, true_bodies
from skolem.sim.symbolic_view import head_towards
from skolem.tools import session
from skolem.tools.live import watcher_for
from skolem.tools.planners import WorldKind
from skolem.tools.stopwatch import Stopwatch
from skolem.traces.messages import (
    Action,
    ActionResult,
    LookAt,
    MoveBase,
    Observation,
    Pose2,
    Prior,
    TrueObject,
    TrueState,
)
from skolem.traces.reader import Trace

Array = NDArray[np.float64]
TOUR_LOOKS, TOP_M = 6, 0.68  # each after a drive; the height looked at
ABOUT = (0.08, 0.08, 0.5)  # m, m, rad: most of a drive
SAME_M = 0.15  # an anchor is of no true object that is farther from where it is believed


@dataclass(frozen=True, slots=True)
class Errors:
    """Squared normalised errors after the looks of one run, and errors of places.

    Attributes:
        base: Over (x, y, theta) in the world, shape (n,).
        relative: Over (x, y) of each thing as seen from the base, shape (m,).
        places_m: Of those places, shape (m,).
    """

    base: Array
    relative: Array
    places_m: Array


def record(scenario: Path, seed: int, world: WorldKind, trace: Path) -> None:
    """Run a scenario and write its trace."""
    setup = session.prepare(scenario, seed=seed, world=world)
    with watcher_for(setup, quiet=True) as watcher:
        session.run(setup, trace, watcher, Stopwatch(), session.Outcome())


def along(trace: Trace) -> Errors:
    """Return the errors of a belief that is fed with the inputs of a trace."""
    told, truth, steps = _read(trace)
    belief = Belief(told)

    def after_looks() -> Iterator[TrueState]:
        for action, result, observation in steps:
            belief.update(action, result, observation)
            if observation.kind == "look":
                yield truth[action.step + 1]

    return _errors(belief, after_looks())


def touring(setup: session.Setup, seed: int) -> Errors:
    """Return the errors of a belief whose robot drives about a little in PyBullet and looks at every table in turn."""
    scenario, robot = setup.scenario, setup.scenario.robot
    start = (robot.base.x, robot.base.y, robot.base.theta)
    bodies, noise = true_bodies(scenario, setup.types), scenario.true_noise.message()
    world = PyBulletWorld(setup.types, bodies, start, robot.torso_m, noise, seed, lambda topic, message: None, False)
    belief = Belief(prior(scenario, setup.types, seed, world.robot_state()))
    draws = Generator(PCG64(SeedSequence([seed])))
    tables = [anchor for anchor in belief.anchors() if not belief.graspable(anchor)]

    def after_looks() -> Iterator[TrueState]:
        for turn in range(TOUR_LOOKS):
            x, y, theta = (float(v) for v in draws.uniform(-1.0, 1.0, 3) * ABOUT)
            _do(world, belief, 2 * turn, MoveBase(start_T_waypoint=((x, y, theta),)))
            bx, by, _ = belief.gaussian("pose", tables[turn % len(tables)]).mean
            head = head_towards(robot.torso_m, np.array([bx, by, TOP_M]))
            if head is not None:
                _do(world, belief, 2 * turn + 1, LookAt(pan=head[0], tilt=head[1]))
                yield world.state(2 * turn + 2)

    try:
        return _errors(belief, after_looks())
    finally:
        world.close()


def _do(world: PyBulletWorld, belief: Belief, step: int, command: MoveBase | LookAt) -> None:
    action = Action(step=step, op=command.kind, args=(), command=command)
    belief.update(action, *world.execute(action))


def _errors(belief: Belief, after_looks: Iterator[TrueState]) -> Errors:
    """Return the errors of a belief whenever there is a truth to compare it with."""
    base, relative, places = [], [], []
    for true in after_looks:
        now = belief.snapshot(true.step)
        base.append(_squared(now.world_T_base, _full(now.base_covariance), true.world_T_base))
        for anchor, item in _pairs(belief, true):
            believed = belief.gaussian("pose", anchor)
            x, y, theta = (float(v) for v in believed.mean)
            seen = between(true.world_T_base, flat(item.world_T_object))
            off = tangent(between((x, y, theta), (seen[0], seen[1], theta)))[:2]
            relative.append(float(off @ np.linalg.solve(believed.covariance[:2, :2], off)))
            places.append(float(np.hypot(*off)))
    return Errors(np.array(base), np.array(relative), np.array(places))


def _read(trace: Trace) -> tuple[Prior, dict[int, TrueState], list[tuple[Action, ActionResult, Observation]]]:
    told = None
    truth: dict[int, TrueState] = {}
    actions: dict[int, Action] = {}
    results: dict[int, ActionResult] = {}
    observations: dict[int, Observation] = {}
    for recorded in trace.messages():
        message = recorded.message
        match message:
            case Prior():
                told = message
            case TrueState():
                truth[message.step] = message
            case Action():
                actions[message.step] = message
            case ActionResult():
                results[message.step] = message
            case Observation():
                observations[message.step] = message
    assert told is not None, "every trace of a run has a prior"
    done = sorted(actions.keys() & results.keys() & observations.keys())
    return told, truth, [(actions[i], results[i], observations[i]) for i in done]


def _pairs(belief: Belief, true: TrueState) -> Iterator[tuple[str, TrueObject]]:
    """Return which listed thing is which true one that is not held: those of a type nearest together, within reason.

    Names do not tell: of two bottles told a hand apart, which was meant by which name is anybody's guess.
    """
    now = belief.snapshot(0)
    loose = [item for item in true.objects if item.in_hand is None]
    for kind in sorted({item.type for item in loose}):
        items = [item for item in loose if item.type == kind]
        listed = [(name, now.objects[name]) for name in belief.anchors() if belief.graspable(name)]
        anchors = [
            (a, o) for a, o in listed if o.in_hand is None and max(sorted(o.type), key=o.type.__getitem__) == kind
        ]
        apart = np.array(
            [[math.dist(o.world_T_object[:2], item.world_T_object[:2]) for item in items] for _, o in anchors]
        )
        rows, columns = linear_sum_assignment(np.minimum(apart.reshape(len(anchors), len(items)), SAME_M))
        yield from ((anchors[i][0], items[j]) for i, j in zip(rows, columns, strict=True) if apart[i, j] < SAME_M)


def _squared(mean: Pose2, covariance: Array, truth: Pose2) -> float:
    off = tangent(between(mean, truth))
    return float(off @ np.linalg.solve(covariance, off))


def _full(upper: tuple[float, ...]) -> Array:
    full = np.zeros((3, 3))
    full[np.triu_indices(3)] = upper
    return full + full.T - np.diag(np.diag(full))
