"""One run: the loop observe, update, decide, act, with every message recorded.

The simulator alone knows the scenario's true world; belief and reasoner get the prior, observations and results.
"""

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Protocol

from google.protobuf.message import Message as Protobuf

from skolem.reasoner import Turn
from skolem.sim.scenario.scenario import believed_noise, moves_before, prior_of, true_bodies
from skolem.tools.loop.displaced import displaced, in_all
from skolem.tools.loop.mind import Mind
from skolem.tools.loop.setup import Setup, run_start
from skolem.tools.loop.source import SOURCE_SHA256
from skolem.tools.loop.stopwatch import LOADING, PHYSICS, RECORDING, SENSING, Stopwatch
from skolem.tools.loop.verdict import own_makes_it_true, verdict
from skolem.tools.loop.worlds import World, WorldStart
from skolem.traces import TraceWriter, messages
from skolem.traces.file.environment import environment
from skolem.traces.file.made_of import RULES, SCENARIO
from skolem.traces.messages import DROPPED, Action, ActionResult, Observation, RunEnd, TrueState


class Watcher(Protocol):
    """An observer of a run."""

    def believed(self, belief: messages.Belief, tick: int) -> None:
        """Take the belief before a decision."""
        ...

    def decided(self, turn: Turn) -> None:
        """Take the plans and the next action."""
        ...

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Take the action with its result and the observation after it."""
        ...


class Unwatched:
    """A `Watcher` that ignores the run."""

    def believed(self, belief: messages.Belief, tick: int) -> None:
        """Ignore the belief."""

    def decided(self, turn: Turn) -> None:
        """Ignore the decision."""

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Ignore the action."""


@dataclass(slots=True)
class Outcome:
    """The result of a run.

    Attributes:
        end: Why the run ended; None while it goes on, and if it was cut short.
        verdict: Whether the goal is true in the world; None if the run was cut short.
        own: Whether the goal is true of the object that the robot chose; None if the run was cut short.
        actions: Number of executed actions.
        replans: How often plans were dropped, because a needed fluent became false or a step was found impossible.
        clingo_calls: Number of solver calls.
        tick: Simulated time in ticks.
        seconds: Wall time by part, seconds.
        total_s: Total wall time, seconds.
        content_hash: Hash of everything recorded but wall times; empty until the trace is written.
    """

    end: RunEnd | None = None
    verdict: messages.Verdict | None = None
    own: bool | None = None
    actions: int = 0
    replans: int = 0
    clingo_calls: int = 0
    tick: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    total_s: float = 0.0
    content_hash: str = ""


def run(
    setup: Setup,
    path: Path,
    watcher: Watcher | None = None,
    watch: Stopwatch | None = None,
    outcome: Outcome | None = None,
    partial: IO[bytes] | None = None,
) -> Outcome:
    """Run the robot until it stops by itself, write the trace to `path`, and return the result.

    An exception closes the trace with its reason and is raised again.

    Args:
        setup: The inputs of the run.
        path: Path of the trace.
        watcher: Sees the run while it goes on.
        watch: Measures the run; by default a new one.
        outcome: Filled in during the run, so that the caller has it if the run raises; by default a new one.
        partial: The partial file of the trace, if the caller has begun it already.

    Raises:
        InputError: If the trace cannot be begun.
        UnwrittenError: If the trace cannot be written to its end.
    """
    watch, outcome = watch or Stopwatch(), outcome or Outcome()
    attachments = {SCENARIO: setup.document.effective_text().encode()}
    attachments |= {f"{RULES}{name}": content for name, content in setup.rulebook.files.items()}
    metadata = {"scenario": setup.scenario.name, "seed": str(setup.seed), "world": setup.world.name}
    env = environment() | {"source": SOURCE_SHA256}
    writer = TraceWriter(path, attachments=attachments, run=metadata, env=env, profile=setup.profile, file=partial)
    try:
        with writer:
            try:
                _Run(setup, writer, watcher or Unwatched(), watch, outcome).to_the_end()
            finally:
                outcome.seconds, outcome.total_s = watch.seconds(), watch.total()
    finally:
        outcome.content_hash = writer.content_hash if writer.written else ""
    return outcome


class _Run:
    """The loop of one run."""

    def __init__(self, setup: Setup, writer: TraceWriter, watcher: Watcher, watch: Stopwatch, outcome: Outcome) -> None:
        self._setup, self._watcher, self._watch, self._outcome = setup, watcher, watch, outcome
        self._writer = writer
        self._tick: Callable[[], int] = lambda: 0
        self._believed: messages.Belief | None = None
        self._displaced: list[messages.Displaced] = []

    def to_the_end(self) -> None:
        """Build the world, run the loop, and judge the result."""
        self._write("/run/start", run_start(self._setup))
        with self._watch.part(LOADING):
            world = self._world()
        try:
            self._tick = lambda: world.tick
            self._loop(world)
        finally:
            world.close()

    def _loop(self, world: World) -> None:
        setup = self._setup
        prior = prior_of(setup.scenario, setup.types, setup.seed, world.robot_state())
        self._write("/prior", prior)
        first = world.state(0)
        self._write("/truth/state", first)
        with self._watch.part(LOADING):
            planner = setup.world.planner(setup.types, setup.seed)
        with closing(planner):
            mind = Mind(setup.goal, setup.rulebook, prior, setup.scenario.limits, planner, self._emit, self._watch)
            step = 0
            while (action := (turn := self._decide(mind, step)).action) is not None:
                self._act(world, mind, action)
                step += 1
        assert turn.end is not None, "a turn has an action or an end"
        self._judge(world, step, turn.end, first)

    def _decide(self, mind: Mind, step: int) -> Turn:
        """Let the robot take one decision, and count and show it."""
        turn = mind.decide(step)
        self._outcome.replans += sum(plan.cause in DROPPED for plan in turn.plans)
        self._outcome.clingo_calls += sum(decision.clingo_calls for decision in turn.decisions)
        self._writer.candidate(turn.closest.probability, turn.closest.anchor)
        self._watcher.decided(turn)
        return turn

    def _emit(self, topic: str, message: messages.Message) -> None:
        """Record a message of the mind, and show the belief before the decision is taken."""
        self._write(topic, message)
        if isinstance(message, messages.Belief):
            self._believed = message
            self._watcher.believed(message, self._tick())

    def _act(self, world: World, mind: Mind, action: Action) -> None:
        """Execute the action, record result and observation, and update the belief with them."""
        step = action.step
        for name, world_T_object in moves_before(self._setup.scenario, self._setup.types, step):
            world.disturb(name, world_T_object)
        before = world.state(step)
        with self._watch.part(SENSING if action.command.kind == "look_at" else PHYSICS):
            result, observation = world.execute(action)
        self._outcome.actions, self._outcome.tick = step + 1, world.tick
        self._write("/action/result", result)
        self._write("/obs", observation)
        self._write("/truth/state", self._compared(before, world.state(step + 1)))
        self._watcher.acted(action, result, observation)
        mind.update(action, result, observation)
        self._close_step(step)

    def _compared(self, before: TrueState, after: TrueState) -> TrueState:
        """Return the true state after an action with what the action displaced without intent."""
        found = displaced(before, after)
        self._displaced += found
        return after.model_copy(update={"displaced": found})

    def _judge(self, world: World, step: int, end: RunEnd, first: TrueState) -> None:
        """Record whether the goal is true in the world, and then the end of the run."""
        setup = self._setup
        state, rulebook = world.state(step), setup.rulebook
        judged = verdict(setup.goal, rulebook, state, setup.types, first)
        self._outcome.verdict = judged.model_copy(update={"displaced": in_all(self._displaced)})
        assert self._believed is not None, "a run that ends by itself has taken a decision"
        self._outcome.own = own_makes_it_true(
            setup.goal, rulebook, state, setup.types, self._believed, end.anchor, first
        )
        self._write("/truth/verdict", self._outcome.verdict)
        self._close_step(step)
        self._write("/run/end", end)
        self._outcome.end = end

    def _close_step(self, step: int) -> None:
        spent = self._watch.seconds() | {"total": self._watch.total()}
        milliseconds = {part: round(1e3 * seconds, 3) for part, seconds in spent.items()}
        self._write("/perf", messages.Perf(step=step, milliseconds=milliseconds))
        with self._watch.part(RECORDING):
            self._writer.close_step(step, self._tick())

    def _write(self, topic: str, message: messages.Message | Protobuf) -> None:
        with self._watch.part(RECORDING):
            self._writer.write(topic, message, self._tick())

    def _world(self) -> World:
        """Build the true world; nothing else gets the truth."""
        setup, types = self._setup, self._setup.types
        robot = setup.scenario.robot
        start = WorldStart(
            types=types,
            bodies=true_bodies(setup.scenario, types),
            world_T_base=(robot.base.x, robot.base.y, robot.base.theta),
            torso_m=robot.torso_m,
            noise=setup.scenario.true_noise.message(),
            believed_noise=believed_noise(setup.scenario),
            seed=setup.seed,
            images=setup.images,
            record=self._record,
        )
        return setup.world.build(start)

    def _record(self, topic: str, message: Protobuf) -> None:
        self._write(topic, message)
