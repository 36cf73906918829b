"""A recorded run as a replay reads it: the prior, and step by step the decisions and observations."""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from skolem.traces import Trace
from skolem.traces.compare.diff import by_step
from skolem.traces.errors import TraceError
from skolem.traces.file.codec import NO_CHAIN, counter_of
from skolem.traces.file.known_fields import KnownFields
from skolem.traces.file.made_of import digest, disagreements
from skolem.traces.file.reader import UNREADABLE, Recorded
from skolem.traces.messages import (
    JSON_TOPICS,
    Action,
    ActionResult,
    Belief,
    Chain,
    Geometry,
    Memory,
    Message,
    Observation,
    Perf,
    Prior,
    RunEnd,
    RunStart,
    canonical,
)

DECISIONS = tuple(topic for topic in JSON_TOPICS if counter_of(topic) == "decision")
CUT_SHORT = ("error", "interrupted")  # ends that the recorder writes, not the mind

M = TypeVar("M", bound=Message)


@dataclass(frozen=True)
class RecordedStep:
    """One decision of a recorded run, with its result.

    Attributes:
        step: Number of the decision.
        messages: INPUT and DERIVED messages, in file order.
        link: The hash chain before the decision.
        last: Whether this is the last decision of the trace.
    """

    step: int
    messages: list[Recorded]
    link: str
    last: bool

    def all_of(self, model: type[M]) -> list[M]:
        """Return the messages of one type, decoded."""
        found = [m.message for m in self.messages if JSON_TOPICS[m.topic][0] is model]
        return [message for message in found if isinstance(message, model)]

    def the(self, model: type[M]) -> M | None:
        """Return the message of one type; None if there is none."""
        return next(iter(self.all_of(model)), None)

    @cached_property
    def action(self) -> Action | None:
        """The chosen action; None at the end of the run, or if it was cut short."""
        return self.the(Action)

    @cached_property
    def met(self) -> tuple[ActionResult, Observation] | None:
        """The result of the action and the observation after it; None if they are not recorded."""
        result, observation = self.the(ActionResult), self.the(Observation)
        return None if result is None or observation is None else (result, observation)

    @cached_property
    def end(self) -> RunEnd | None:
        """The end of the run, at its last step."""
        return self.the(RunEnd)

    @property
    def belief(self) -> Belief | None:
        """The belief before the decision; None if it is not recorded."""
        return self.the(Belief)

    @property
    def memory(self) -> Memory | None:
        """The reasoner's memory before the decision; None in traces of older versions."""
        return self.the(Memory)

    @property
    def answers(self) -> list[Geometry]:
        """The geometric questions that were asked, with their answers."""
        return self.all_of(Geometry)


class RecordedRun:
    """A trace, opened for replay.

    Attributes:
        path: The trace.
        start: The recorded start of the run.
        prior: The initial belief.
    """

    def __init__(self, path: Path) -> None:
        """Open a trace.

        Raises:
            TraceError: If the trace cannot be read, does not begin as a run, or holds other files than its run had.
        """
        self.path = path
        self._trace = Trace(path)
        head = next(self._groups())
        found = {m.topic: m for m in head}
        if not {"/run/start", "/prior"} <= found.keys():
            raise TraceError(f"{path}: nothing to replay: the run was not yet told its goal and its prior belief")
        start, prior = found["/run/start"].message, found["/prior"].message
        assert isinstance(start, RunStart)
        assert isinstance(prior, Prior)
        check_made_of(self._trace, start)
        self.start, self.prior, self.head = start, prior, head
        schemas = self._trace.schemas
        try:
            self._known = {topic: KnownFields(schemas[topic]) for topic in DECISIONS if topic in schemas}
        except ValueError as error:
            raise TraceError(f"{path}: the schema of a topic is no JSON Schema; {UNREADABLE}") from error

    @property
    def attachments(self) -> dict[str, bytes]:
        """The scenario and the rule files of the run, by name."""
        return self._trace.attachments

    @property
    def environment(self) -> dict[str, str]:
        """The machine and the library versions of the run."""
        return self._trace.metadata.get("env", {})

    def encoded(self, topic: str, message: Message, held: Collection[bytes] = ()) -> bytes | None:
        """Return a message as this trace would hold it: without fields that its version does not know.

        None if its version does not record such a message.

        Args:
            topic: Topic of the message.
            message: A new message.
            held: Recorded messages, if they are at hand: a message among them needs no change.
        """
        if topic not in self._known:
            return None
        values = message.model_dump(mode="json")
        written = canonical(values)
        if written in held:
            return written
        try:
            return canonical(self._known[topic].of(values))
        except ValueError as error:
            raise TraceError(f"{self.path}: the schema of {topic} is none that a trace can have: {error}") from error

    def steps(self) -> Iterator[RecordedStep]:
        """Yield every decision in order.

        Raises:
            TraceError: If there is no decision, or messages are missing.
        """
        groups = self._groups()
        next(groups)
        link, group = NO_CHAIN, next(groups, None)
        if group is None:
            raise TraceError(f"{self.path}: nothing to replay: the run ended before its first decision")
        while group is not None:
            following = next(groups, None)
            yield RecordedStep(_step_of(group[0]), group, link, following is None)
            link, group = self._link_of(group), following

    def wall_seconds(self) -> float | None:
        """Return the duration of the run in seconds of wall time; None if wall times were not recorded."""
        recorded = self._trace.last("/perf")
        last = None if recorded is None else recorded.message
        return last.milliseconds["total"] / 1e3 if isinstance(last, Perf) else None

    def _link_of(self, group: list[Recorded]) -> str:
        """Return the hash chain after a group of messages."""
        chains = [m.message for m in group if m.topic == "/chain"]
        link = next((chain.chain for chain in chains if isinstance(chain, Chain)), NO_CHAIN)
        if not re.fullmatch(f"[0-9a-f]{{{len(NO_CHAIN)}}}", link):
            raise TraceError(f"{self.path}: {link!r} is no link of a hash chain; {UNREADABLE}")
        return link

    def _groups(self) -> Iterator[list[Recorded]]:
        return by_step(self._decisions())

    def _decisions(self) -> Iterator[Recorded]:
        """Yield the INPUT and DERIVED messages; a gap in them is an error, for the mind may lack an input."""
        for number, recorded in enumerate(self._trace.messages(*DECISIONS)):
            if recorded.sequence != number:
                raise TraceError(f"{self.path}: {recorded.topic}: decision message {number} is missing")
            yield recorded


def check_made_of(trace: Trace, start: RunStart) -> None:
    """Check that the files in a trace are those of its run; a recovered trace may lack some.

    Raises:
        TraceError: If a file is missing, changed or added.
    """
    attached = {name: digest(content) for name, content in trace.attachments.items()}
    for said in disagreements(start, attached, trace.metadata["run"]):
        raise TraceError(f"{trace.path}: what the run was made of is not in it any more: {said}")


def _step_of(message: Recorded) -> int:
    belief = message.message
    assert isinstance(belief, Belief)
    return belief.step
