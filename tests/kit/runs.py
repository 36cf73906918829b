"""Whole runs of the scenario files, each done once and read by every item that asks for it.

A `Run` is the recorded messages of one trace in memory. Assertions are about rows: operators, anchors, levels, plans
that were given up and why; never about joint values. The figures over hundreds of seeds come from `skolem sweep` and
stand in docs/results.md; the seeds here are few, so that the tests stay short.
"""

import re
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from kit.places import SCENARIOS
from kit.tabletop import EXACT, TYPES, near_table

from skolem.sim.truth.bodies import TrueBody
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.traces.file.reader import Trace
from skolem.traces.messages import (
    HANDS,
    Action,
    ActionResult,
    Belief,
    Command,
    Decision,
    Geometry,
    NoiseModel,
    Observation,
    Plan,
    RunEnd,
    TrueObject,
    TrueState,
    Verdict,
)


@dataclass(frozen=True, slots=True)
class Run:
    """The messages of one run.

    Attributes:
        actions: What was done; `op` is the row's text, `args` the anchors.
        results: What the joints said of it, one for each action.
        observations: What was seen or felt, one for each action.
        beliefs: Before each decision; one more than actions.
        plans: The plan stack whenever it changed.
        decisions: Every search.
        questions: Every geometric question.
        truths: The world after so many actions; one more than actions.
        end: Why it ended.
        verdict: Whether the goal is true in the world.
    """

    actions: tuple[Action, ...]
    results: tuple[ActionResult, ...]
    observations: tuple[Observation, ...]
    beliefs: tuple[Belief, ...]
    plans: tuple[Plan, ...]
    decisions: tuple[Decision, ...]
    questions: tuple[Geometry, ...]
    truths: tuple[TrueState, ...]
    end: RunEnd
    verdict: Verdict

    @property
    def operators(self) -> list[str]:
        """The rows: operators with their anchors, in order."""
        return [action.op for action in self.actions]

    @property
    def achieved(self) -> bool:
        """Whether the robot believes its goal achieved."""
        return self.end.status == "goal_achieved"

    def named(self, operator: str) -> list[str]:
        """Return the object of each action of one operator, in order."""
        return [action.args[0] for action in self.actions if action.op.startswith(f"{operator}(")]

    def where(self, operator: str) -> int:
        """Return the number of the first action whose row begins so."""
        return next(i for i, row in enumerate(self.operators) if row.startswith(operator))

    def top_plans(self) -> dict[int, tuple[str, ...]]:
        """Return the plans made for the goal itself, by the number of the action that was to be next."""
        started = [plan for plan in self.plans if plan.cause == "start"]
        return {plan.step: tuple(step.op for step in plan.layers[0]) for plan in started}

    def given_up(self) -> list[Plan]:
        """Return every time the stack was popped to the top because no pre-image held."""
        return [plan for plan in self.plans if plan.cause == "preimage_lost" and not plan.layers]

    def asked(self, activity: str, anchor: str) -> list[Geometry]:
        """Return the geometric questions about an activity with an object, whichever hand is to do it, in order."""
        return [question for question in self.questions if _about(question) == (activity, anchor)]

    def known(self) -> tuple[str, ...]:
        """Return the anchors known at the start."""
        return self.beliefs[0].anchors


def _about(question: Geometry) -> tuple[str, str]:
    """Return the activity of a question like `ready pick(left, sodaC)`, and the object or region it begins with."""
    _, activity, *args = re.findall(r"\w+", question.query)
    return activity, next(arg for arg in args if arg not in HANDS)


@cache
def ran(name: str, seed: int = 0, world: str = "symbolic", overrides: tuple[str, ...] = ()) -> Run:
    """Return a run of a scenario file, done at the first call."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        setup = prepare(SCENARIOS / f"{name}.yaml", overrides, seed, world)
        run(setup, path)
        trace = Trace(path)
        (end,), (verdict,) = trace.of(RunEnd), trace.of(Verdict)
        return Run(
            tuple(trace.of(Action)),
            tuple(trace.of(ActionResult)),
            tuple(trace.of(Observation)),
            tuple(trace.of(Belief)),
            tuple(trace.of(Plan)),
            tuple(trace.of(Decision)),
            tuple(trace.of(Geometry)),
            tuple(trace.of(TrueState)),
            end,
            verdict,
        )


def over(name: str, seeds: Iterable[int]) -> list[Run]:
    """Return the runs of several seeds in the world without physics."""
    return [ran(name, seed) for seed in seeds]


def with_physics(name: str) -> Run:
    """Return the one run of a scenario with the physics engine; other seeds are run by `skolem sweep`."""
    return ran(name, 1, "pybullet")


def distinct_successes(runs: Iterable[Run]) -> set[tuple[str, ...]]:
    """Return the different sequences of operators that ended with a goal believed achieved, and true."""
    return {tuple(one.operators) for one in runs if one.achieved and one.verdict.true}


class Stage:
    """The robot before a table in the physics engine, led by hand; all is exact unless a noise model is given."""

    def __init__(self, things: list[TrueBody], noise: NoiseModel = EXACT, seed: int = 0) -> None:
        from skolem.sim.physics.pybullet import PyBulletWorld

        self.world = PyBulletWorld(TYPES, near_table(*things), (0.0, 0.0, 0.0), 0.2, noise, seed)
        self.step = 0

    def __enter__(self) -> "Stage":
        return self

    def __exit__(self, *_: object) -> None:
        self.world.close()

    def do(self, command: Command) -> tuple[ActionResult, Observation]:
        """Carry out a command as the next action."""
        found = self.world.execute(Action(step=self.step, op="test", args=(), command=command))
        self.step += 1
        return found

    def thing(self, name: str) -> TrueObject:
        """Return what an object truly is and where."""
        return thing_in(self.world.state(self.step), name)


def thing_in(truth: TrueState, name: str) -> TrueObject:
    """Return an object of the true world."""
    return next(thing for thing in truth.objects if thing.id == name)
