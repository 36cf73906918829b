"""Logs of runs in the simulators with the truth after each look: tours of looks, and whole runs from traces."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from benchmarks.estimator_peers import Estimator
from benchmarks.estimator_scores import errors
from benchmarks.headings import least_turn
from skolem.estimation.belief import Belief
from skolem.estimation.events import Began, Event
from skolem.estimation.se2 import Matrix, between, log as tangent
from skolem.sim.physics.pybullet import PyBulletWorld
from skolem.sim.scenario.scenario import prior_of, true_bodies
from skolem.sim.symbolic.view import head_towards
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import Setup, prepare
from skolem.tools.words.live import watcher_for
from skolem.traces.file.reader import Trace
from skolem.traces.messages import (
    Action,
    ActionResult,
    LookAt,
    MoveBase,
    ObjectType,
    Observation,
    Pose2,
    Prior,
    TrueObject,
    TrueState,
)
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.messages.poses import flat

Array = NDArray[np.float64]
TOUR_LOOKS, TOP_M = 6, 0.68  # looks, each after a drive; height of the tables
ABOUT = (0.08, 0.08, 0.5)  # m, m, rad: largest drive
SAME_M = 0.15  # a true object farther than this from the believed position is not the anchor's


@dataclass(frozen=True, slots=True)
class Moment:
    """The truth after a look.

    Attributes:
        version: Number of events up to the look.
        world_T_base: The true pose of the base.
        things: The true object of each anchor of the prior that is not held.
    """

    version: int
    world_T_base: Pose2
    things: tuple[tuple[str, TrueObject], ...]


@dataclass(frozen=True, slots=True)
class Recording:
    """The events of a belief, and the truth at the moments at which it is judged.

    Attributes:
        events: Events of the belief, in order, associations included; the first is `Began`.
        moments: The truth after each look.
    """

    events: tuple[Event, ...]
    moments: tuple[Moment, ...]


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors of one estimator after the looks of one run.

    Attributes:
        base: The rows of `errors` for the base in the world frame, shape (n, 5).
        places: Errors of the position (x, y) of each graspable object in the base frame, shape (m, 4): squared error in
            m^2, squared normalised error, and squared normalised error along each axis.
        headings: Errors of the visible heading of each box and table in the base frame, shape (k, 2): squared error in
            rad^2, and squared normalised error.
    """

    base: Array
    places: Array
    headings: Array


def record(scenario: Path, seed: int, world: str, trace: Path) -> None:
    """Run a scenario and write its trace."""
    setup = prepare(scenario, seed=seed, world=world)
    with watcher_for(setup, quiet=True) as watcher:
        run(setup, trace, watcher)


def along(trace: Trace) -> Recording:
    """Return the log of a belief that gets the inputs of a trace."""
    prior, truth, steps = _read(trace)
    belief = Belief(prior)
    moments = []
    for action, result, observation in steps:
        belief.update(action, result, observation)
        if observation.kind == "look":
            moments.append(_moment(belief, prior, truth[action.step + 1]))
    return Recording(belief.events, tuple(moments))


def touring(setup: Setup, seed: int) -> Recording:
    """Return the log of a robot that makes short drives in PyBullet and looks at every table in turn."""
    scenario, robot = setup.scenario, setup.scenario.robot
    start = (robot.base.x, robot.base.y, robot.base.theta)
    bodies, noise = true_bodies(scenario, setup.types), scenario.true_noise.message()
    world = PyBulletWorld(setup.types, bodies, start, robot.torso_m, noise, seed, lambda topic, message: None, False)
    prior = prior_of(scenario, setup.types, seed, world.robot_state())
    belief, moments = Belief(prior), []
    draws = Generator(PCG64(SeedSequence([seed])))
    tables = [anchor for anchor in belief.anchors() if not belief.graspable(anchor)]
    try:
        for turn in range(TOUR_LOOKS):
            x, y, theta = (float(v) for v in draws.uniform(-1.0, 1.0, 3) * ABOUT)
            _do(world, belief, 2 * turn, MoveBase(start_T_waypoint=((x, y, theta),)))
            bx, by, _ = belief.gaussian("pose", tables[turn % len(tables)]).mean
            head = head_towards(robot.torso_m, np.array([bx, by, TOP_M]))
            if head is not None:
                _do(world, belief, 2 * turn + 1, LookAt(pan=head[0], tilt=head[1]))
                moments.append(_moment(belief, prior, world.state(2 * turn + 2)))
    finally:
        world.close()
    return Recording(belief.events, tuple(moments))


def judged(make: Callable[[Began], Estimator], recording: Recording, types: dict[str, ObjectType]) -> Errors:
    """Return the errors of an estimator that gets a log.

    Args:
        make: Makes an estimator.
        recording: The log.
        types: Types of the true objects, which determine how far a heading is visible.
    """
    began, *events = recording.events
    assert isinstance(began, Began), "a log starts with what is told"
    estimator, moments = make(began), {moment.version: moment for moment in recording.moments}
    base, places, headings = [], [], []
    for version, event in enumerate(events, start=2):
        estimator.take(event)
        if moment := moments.get(version):
            base.append(errors(*estimator.base(), moment.world_T_base))
            for anchor, thing in moment.things:
                kind, believed = types[thing.type], estimator.relative(anchor)
                seen = between(moment.world_T_base, flat(thing.world_T_object))
                if kind.graspable:
                    places.append(_place_errors(*believed, seen))
                if kind.shape != "cylinder":
                    headings.append(_heading_errors(*believed, seen, kind))
    return Errors(np.array(base), np.array(places).reshape(-1, 4), np.array(headings).reshape(-1, 2))


def _place_errors(mean: Pose2, covariance: Matrix, seen: Pose2) -> tuple[float, ...]:
    """Return the squared error, the squared normalised error, and the one along each axis."""
    off = tangent(between(mean, (seen[0], seen[1], mean[2])))[:2]
    own = covariance[:2, :2]
    axes = np.square(off) / np.diag(own)
    return (float(off @ off), float(off @ np.linalg.solve(own, off)), *(float(v) for v in axes))


def _heading_errors(mean: Pose2, covariance: Matrix, seen: Pose2, kind: ObjectType) -> tuple[float, float]:
    """Return the squared error and the squared normalised error of the visible heading."""
    off = least_turn(seen[2] - mean[2], kind)
    return off**2, off**2 / float(covariance[2, 2])


def _do(world: PyBulletWorld, belief: Belief, step: int, command: MoveBase | LookAt) -> None:
    action = Action(step=step, op=command.kind, args=(), command=command)
    belief.update(action, *world.execute(action))


def _moment(belief: Belief, prior: Prior, true: TrueState) -> Moment:
    names = {item.anchor for item in prior.objects}
    pairs = tuple((anchor, item) for anchor, item in _pairs(belief, true) if anchor in names)
    return Moment(belief.version, true.world_T_base, pairs)


def _read(trace: Trace) -> tuple[Prior, dict[int, TrueState], list[tuple[Action, ActionResult, Observation]]]:
    prior = None
    truth: dict[int, TrueState] = {}
    actions: dict[int, Action] = {}
    results: dict[int, ActionResult] = {}
    observations: dict[int, Observation] = {}
    for recorded in trace.messages():
        message = recorded.message
        match message:
            case Prior():
                prior = message
            case TrueState():
                truth[message.step] = message
            case Action():
                actions[message.step] = message
            case ActionResult():
                results[message.step] = message
            case Observation():
                observations[message.step] = message
    assert prior is not None, "every trace of a run has a prior"
    done = sorted(actions.keys() & results.keys() & observations.keys())
    return prior, truth, [(actions[i], results[i], observations[i]) for i in done]


def _pairs(belief: Belief, true: TrueState) -> Iterator[tuple[str, TrueObject]]:
    """Yield each listed anchor with its true object, held ones left out: the nearest pairs of a type, within `SAME_M`.

    Names do not decide: if the prior has two bottles a hand apart, either may be meant by either name.
    """
    now = belief.snapshot(0)
    loose = [item for item in true.objects if item.in_hand is None]
    for kind in sorted({item.type for item in loose}):
        items = [item for item in loose if item.type == kind]
        listed = [(name, now.objects[name]) for name in belief.anchors()]
        anchors = [(a, o) for a, o in listed if o.in_hand is None and likeliest(o.type) == kind]
        apart = np.array(
            [[math.dist(o.world_T_object[:2], item.world_T_object[:2]) for item in items] for _, o in anchors]
        )
        rows, columns = linear_sum_assignment(np.minimum(apart.reshape(len(anchors), len(items)), SAME_M))
        yield from ((anchors[i][0], items[j]) for i, j in zip(rows, columns, strict=True) if apart[i, j] < SAME_M)
