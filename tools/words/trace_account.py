"""A recorded run in figures, for `info` and for the manifest of golden traces."""

import re
from collections import Counter
from dataclasses import dataclass, field

from skolem.traces import Trace
from skolem.traces.file.clock import time_ns
from skolem.traces.file.codec import ContentHash
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import (
    DROPPED,
    TICKS_PER_SECOND,
    Action,
    Decision,
    Plan,
    PlanCause,
    RunEnd,
    RunStart,
    Verdict,
)

COUNTED = ("/run/start", "/plan", "/decision", "/action", "/run/end", "/truth/verdict")
OPERATOR = re.compile(r"\w+")


@dataclass(slots=True)
class Account:
    """A run in figures.

    Attributes:
        start: The start of the run.
        end: The end of the run; None if the trace ends before.
        verdict: Whether the goal was true in the world; None if that is not recorded.
        steps: Number of executed actions.
        replans: How often plans were dropped, because a needed fluent became false or a step was found impossible.
        causes: Causes of changes of the plan stack, with counts.
        executed: Executed operators, with counts.
        planned: Operators and inference rules in plans, with counts.
        searches: Number of searches.
        within: The bound `Decision.within` of every plan that was found.
        clingo_calls: Number of solver calls.
        simulated_s: Simulated time, in seconds.
        messages: Number of messages by topic.
        bytes: Their size before compression, by topic.
        hashes: Hashes of the content, and of the decisions.
    """

    start: RunStart | None = None
    end: RunEnd | None = None
    verdict: Verdict | None = None
    steps: int = 0
    replans: int = 0
    causes: Counter[PlanCause] = field(default_factory=Counter)
    executed: Counter[str] = field(default_factory=Counter)
    planned: Counter[str] = field(default_factory=Counter)
    searches: int = 0
    within: list[float | None] = field(default_factory=list)
    clingo_calls: int = 0
    simulated_s: float = 0.0
    messages: Counter[str] = field(default_factory=Counter)
    bytes: Counter[str] = field(default_factory=Counter)
    hashes: ContentHash = field(default_factory=ContentHash)

    def take(self, recorded: Recorded) -> None:
        """Take in the next message in file order."""
        topic = recorded.topic
        self.messages[topic] += 1
        self.bytes[topic] += len(recorded.data)
        self.steps += topic == "/action/result"
        self.simulated_s = recorded.tick / TICKS_PER_SECOND
        self.hashes.add(topic, recorded.data, time_ns(recorded.tick), recorded.sequence)
        if topic in COUNTED:
            self._count(recorded.message)

    def _count(self, message: object) -> None:
        match message:
            case RunStart():
                self.start = message
            case RunEnd():
                self.end = message
            case Verdict():
                self.verdict = message
            case Action(op=op):
                self.executed[operator(op)] += 1
            case Plan(cause=cause):
                self.causes[cause] += 1
                self.replans += cause in DROPPED
            case Decision(plan=plan, within=within, clingo_calls=calls):
                self.planned.update(map(operator, plan))
                self.within += [within] if plan else []
                self.searches += 1
                self.clingo_calls += calls
            case _:
                pass


def account(trace: Trace) -> Account:
    """Read a whole trace and return its figures."""
    found = Account()
    for recorded in trace.messages():
        found.take(recorded)
    return found


def operator(op: str) -> str:
    """Return the name of an operator or inference rule without its arguments."""
    name = OPERATOR.match(op)
    return name[0] if name else op
