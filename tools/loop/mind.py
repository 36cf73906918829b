"""The robot's mind: belief, reasoner and geometry; a run and a replay use the same one.

The caller gives it the prior, actions, results and observations. Its messages go through `emit`, in a fixed order.
"""

from collections.abc import Callable

from skolem.estimation import Belief, EstimatorConfig
from skolem.reasoner import Agent, Geometry, Goal, Turn
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.relations import speaks_of_the_start
from skolem.reasoner.rulebook.book import Rulebook
from skolem.tools.loop.recorded_geometry import RecordedGeometry
from skolem.tools.loop.stopwatch import ESTIMATION, REASONING, Stopwatch
from skolem.traces.messages import Action, ActionResult, Limits, Memory, Message, Observation, Prior

Emit = Callable[[str, Message], None]  # (topic, message)


def _unheard(topic: str, message: Message) -> None:
    """Ignore a message."""


class Mind:
    """Updates the belief and decides; a function of its inputs alone."""

    def __init__(
        self,
        goal: Goal,
        rulebook: Rulebook,
        prior: Prior,
        limits: Limits,
        geometry: Geometry,
        emit: Emit = _unheard,
        watch: Stopwatch | None = None,
    ) -> None:
        """Start with the initial belief.

        Args:
            goal: The goal of the run.
            rulebook: The rules and the words.
            prior: The initial belief.
            limits: Counts after which the robot gives up.
            geometry: Answers geometric questions about the belief, which it gets before each decision.
            emit: Takes every message of the mind, on the topics /belief, /memory, /geometry, /denotation, /plan,
                /decision and /action; by default messages are dropped.
            watch: Measures estimation and reasoning; by default a new one.
        """
        self._emit = emit
        self._watch = watch = watch or Stopwatch()
        with watch.part(ESTIMATION):
            self._belief = Belief(prior, EstimatorConfig(remembers=speaks_of_the_start(goal)))
        self._geometry = RecordedGeometry(geometry, emit, watch)
        with watch.part(REASONING):
            self._agent = Agent(goal, rulebook, self._belief, self._geometry, limits)

    @property
    def belief(self) -> Belief:
        """The belief, which every update changes."""
        return self._belief

    @property
    def denotations(self) -> Denotations:
        """The descriptions of the goal."""
        return self._agent.denotations

    @property
    def posed(self) -> PosedGoal:
        """The goal, posed in the belief of the last `take_stock`."""
        return self._agent.posed

    def take_stock(self, step: int) -> None:
        """Pose the goal in the present belief, which is how `decide` begins, without emitting messages."""
        self._geometry.sync(self._belief.snapshot(step))
        self._agent.take_stock()

    def decide(self, step: int) -> Turn:
        """Return the next action or the end of the run, and emit the messages of the decision."""
        with self._watch.part(ESTIMATION):
            snapshot = self._belief.snapshot(step)
        self._emit("/belief", snapshot)
        self._emit("/memory", self._agent.memory(step))
        self._geometry.sync(snapshot)
        with self._watch.part(REASONING):
            turn = self._agent.decide(step)
        self._emit("/denotation", turn.denotation)
        for plan in turn.plans:
            self._emit("/plan", plan)
        for decision in turn.decisions:
            self._emit("/decision", decision)
        if turn.action is not None:
            self._emit("/action", turn.action)
        return turn

    def update(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Update the belief with an executed action, its result, and the observation after it."""
        with self._watch.part(ESTIMATION):
            self._belief.update(action, result, observation)

    def memory(self, step: int) -> Memory:
        """Return the memory before a decision; with the belief, the decision depends on nothing else."""
        return self._agent.memory(step)

    def recall(self, memory: Memory) -> None:
        """Replace the memory by the one of a recorded mind at the same decision."""
        self._agent.recall(memory)
