"""Whole runs of the scenario files; each is executed once and read by several tests.

A `Run` holds the recorded messages of one trace in memory. Assertions are about rows (operators, anchors, levels, given
up plans and the reasons), never about joint values. The figures over hundreds of seeds come from `skolem sweep` and
stand in docs/results.md. The tests run few seeds, so that they stay short.
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
        actions: The executed actions; `op` is the row's text, `args` the anchors.
        results: The result of each action by the joints.
        observations: The observation after each action.
        beliefs: The belief before each decision; one more than actions.
        plans: The plan stack after each change.
        decisions: Every search.
        questions: Every geometric question.
        truths: The true world before the first and after each action; one more than actions.
        end: The reason of the end.
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
        """The rows, which are operators with their anchors, in order."""
        return [action.op for action in self.actions]

    @property
    def achieved(self) -> bool:
        """Whether the robot believes that its goal is achieved."""
        return self.end.status == "goal_achieved"

    def named(self, operator: str) -> list[str]:
        """Return the object of each action of one operator, in order."""
        return [action.args[0] for action in self.actions if action.op.startswith(f"{operator}(")]

    def where(self, operator: str) -> int:
        """Return the number of the first action whose row begins with a text."""
        return next(i for i, row in enumerate(self.operators) if row.startswith(operator))

    def top_plans(self) -> dict[int, tuple[str, ...]]:
        """Return the plans for the goal itself, by the number of the action after each."""
        started = [plan for plan in self.plans if plan.cause == "start"]
        return {plan.step: tuple(step.op for step in plan.layers[0]) for plan in started}

    def given_up(self) -> list[Plan]:
        """Return the changes that popped the stack to the top because no pre-image held."""
        return [plan for plan in self.plans if plan.cause == "preimage_lost" and not plan.layers]

    def asked(self, activity: str, anchor: str) -> list[Geometry]:
        """Return the geometric questions about an activity with an object, by any hand, in order."""
        return [question for question in self.questions if _about(question) == (activity, anchor)]

    def known(self) -> tuple[str, ...]:
        """Return the anchors known at the start."""
        return self.beliefs[0].anchors


def _about(question: Geometry) -> tuple[str, str]:
    """Return the activity of a question like `ready pick(left, sodaC)`, and its first object or region."""
    _, activity, *args = re.findall(r"\w+", question.query)
    return activity, next(arg for arg in args if arg not in HANDS)


@cache
def ran(name: str, seed: int = 0, world: str = "symbolic", overrides: tuple[str, ...] = ()) -> Run:
    """Return a run of a scenario file, executed at the first call."""
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
    """Return the one run of a scenario with the physics engine; `skolem sweep` runs other seeds."""
    return ran(name, 1, "pybullet")


def distinct_successes(runs: Iterable[Run]) -> set[tuple[str, ...]]:
    """Return the different sequences of operators of runs whose goal is believed achieved and is true."""
    return {tuple(one.operators) for one in runs if one.achieved and one.verdict.true}


class Stage:
    """The robot before a table in the physics engine; tests give the commands. Without a noise model all is exact."""

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
        """Return the true body of an object."""
        return thing_in(self.world.state(self.step), name)


def thing_in(truth: TrueState, name: str) -> TrueObject:
    """Return an object of the true world."""
    return next(thing for thing in truth.objects if thing.id == name)
