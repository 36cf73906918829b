"""A mind that decides again in a recorded run: it gets the recorded prior and observations."""

from dataclasses import dataclass

from skolem.reasoner import Goal, Turn
from skolem.reasoner.rulebook.book import Rulebook
from skolem.tools.loop.mind import Mind
from skolem.tools.loop.stopwatch import Stopwatch
from skolem.tools.recorded.geometry import RecalledGeometry
from skolem.tools.recorded.run import RecordedRun, RecordedStep
from skolem.traces.errors import BrokenRulesError, Fault, InputError, error_text
from skolem.traces.file.codec import HashChain, encode
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import CLASS_OF, INPUT, Action, Chain, Geometry, Limits, Message, Prior, RunEnd


@dataclass(frozen=True, slots=True)
class Given:
    """The inputs of a mind.

    Attributes:
        goal: The goal of the run.
        rulebook: The rules and the words.
        prior: The initial belief.
        limits: Counts after which the robot gives up.
    """

    goal: Goal
    rulebook: Rulebook
    prior: Prior
    limits: Limits


@dataclass(frozen=True, slots=True)
class Thought:
    """The result of taking one decision of a recorded run again.

    Attributes:
        messages: All messages of the decision, as a run would record them.
        turn: The decision; None if it failed.
        failure: Why it failed; empty if it did not.
    """

    messages: list[Recorded]
    turn: Turn | None
    failure: str = ""

    @property
    def action(self) -> Action | None:
        """The chosen action; None at the end of the run, and if the decision failed."""
        return None if self.turn is None else self.turn.action

    @property
    def outcome(self) -> str:
        """The decision in words."""
        if self.turn is None:
            return f"a failure ({self.failure})"
        return self.turn.action.op if self.turn.action is not None else end_text(self.turn.end)


def end_text(end: RunEnd | None) -> str:
    """Return the end of a run in words."""
    assert end is not None, "a decision is an action or an end"
    return f"the end, {end.status}{f' ({end.anchor})' if end.anchor else ''}"


class Rethinking:
    """A mind, and the recorded run that it goes through."""

    def __init__(
        self, run: RecordedRun, given: Given, geometry: RecalledGeometry, watch: Stopwatch | None = None
    ) -> None:
        """Start at the beginning of the run.

        Args:
            run: The recorded run.
            given: The inputs of the mind.
            geometry: Answers the mind's geometric questions.
            watch: Measures the parts of the mind; by default a new one.
        """
        self._run, self._geometry = run, geometry
        self._held: frozenset[bytes] = frozenset()  # recorded messages of the present decision
        self._thought: list[tuple[str, bytes]] = []
        self._mind = Mind(given.goal, given.rulebook, given.prior, given.limits, geometry, self._emit, watch)

    def recall(self, recorded: RecordedStep) -> None:
        """Give the mind the recorded memory of this decision.

        Raises:
            InputError: If the memory is not recorded.
        """
        if recorded.memory is None:
            raise InputError(
                [
                    Fault(
                        str(self._run.path),
                        0,
                        0,
                        "an older trace, without /memory: it can be replayed from step 0 only",
                    )
                ]
            )
        self._mind.recall(recorded.memory)

    def decide(self, recorded: RecordedStep) -> Thought:
        """Take one decision again."""
        self._held, self._thought = frozenset(message.data for message in recorded.messages), []
        self._geometry.take(recorded.answers)
        turn, failure = None, ""
        try:
            turn = self._mind.decide(recorded.step)
        except Exception as error:
            if isinstance(error, InputError) and not isinstance(error, BrokenRulesError):
                raise  # a limit of the rules' child: it depends on the machine, and is no thought
            failure = error_text(error)
            self._note(recorded, failure)
        return Thought(self._messages(recorded, turn), turn, failure)

    def go_on(self, action: Action, recorded: RecordedStep) -> None:
        """Take in the recorded result and observation as those of `action`."""
        if recorded.met is not None:
            self._mind.update(action, *recorded.met)

    def _emit(self, topic: str, message: Message) -> None:
        data = self._run.encoded(topic, message, self._held)
        if data is not None:
            self._thought.append((topic, data))

    def _note(self, recorded: RecordedStep, failure: str) -> None:
        """Note why a decision failed: the open question, or the end that the recorder writes for a failed run."""
        if self._geometry.unanswered is not None:
            version = 0 if recorded.belief is None else recorded.belief.version
            asked = Geometry(step=recorded.step, query=self._geometry.unanswered, belief_version=version)
            self._emit("/geometry", asked)
        elif recorded.end is not None and recorded.end.reason == failure:
            self._emit("/run/end", recorded.end)
        else:
            end = RunEnd(status="error", steps=recorded.step, reason=failure, goal_probability=0.0)
            self._emit("/run/end", end)

    def _messages(self, recorded: RecordedStep, turn: Turn | None) -> list[Recorded]:
        """Return the new messages among the recorded inputs, with the hash chain over both and the end."""
        tick = recorded.messages[0].tick
        found = [Recorded(topic, tick, 0, data) for topic, data in self._thought]
        if turn is None:
            return found
        if turn.action is not None:
            found += [message for message in recorded.messages if CLASS_OF[message.topic] == INPUT]
        found.append(Recorded("/chain", found[-1].tick, 0, self._link(recorded, found)))
        if turn.end is not None and (data := self._run.encoded("/run/end", turn.end, self._held)) is not None:
            found.append(Recorded("/run/end", tick, 0, data))
        return found

    def _link(self, recorded: RecordedStep, found: list[Recorded]) -> bytes:
        chain = HashChain(recorded.link)
        for message in [*(self._run.head if recorded.step == 0 else []), *found]:
            chain.add(message.topic, message.data)
        return encode("/chain", Chain(step=recorded.step, chain=chain.close()))
