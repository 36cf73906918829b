"""One run as a row of a results file, read from its trace: a new run and an old one give the same row."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields

from skolem.tools.loop.setup import Setup
from skolem.tools.loop.stopwatch import PARTS
from skolem.tools.loop.verdict import own_makes_it_true
from skolem.tools.words.printable import cell
from skolem.traces import Trace
from skolem.traces.errors import TraceError
from skolem.traces.messages import (
    DROPPED,
    TICKS_PER_SECOND,
    Action,
    ActionResult,
    Belief,
    Decision,
    Perf,
    Plan,
    RunEnd,
    RunStart,
    RunStatus,
    TrueState,
    Verdict,
)

TIMES = (*PARTS, "total")


@dataclass(frozen=True, slots=True)
class Row:
    """The result of one run. Every field but the last two is the same in every repetition.

    Attributes:
        scenario: The scenario's name.
        seed: Seed of every random draw.
        world: Name of the simulator.
        status: The end of the run.
        believed: Whether the robot believes its goal achieved.
        true: Whether the goal is true in the simulator; None if the run was cut short.
        own: Whether it is true of the object that the robot has in mind; None if the run was cut short.
        expected: How the scenario says that the run ends.
        actions: Number of executed actions.
        replans: How often plans were dropped.
        clingo_calls: Number of solver calls.
        simulated_s: Simulated time, seconds.
        goal_probability: Probability that the goal holds of its best candidate, in the belief.
        anchor: That candidate.
        conjuncts: Probability of each property or fluent of the candidate.
        regions: Share of each region that has been seen.
        witness: A true object that makes the goal true.
        displaced: What the robot displaced without intent, each object with its way in metres.
        sequence: The executed operators with their arguments.
        reason: Why the run ended.
        trace: Name of the trace; empty if there is none, because every worker that ran it died.
        content_hash: Hash of everything in the trace but wall times.
        size_bytes: Size of the trace, wall times included.
        seconds: Wall time by part, and `total`.
    """

    scenario: str
    seed: int
    world: str
    status: RunStatus
    believed: bool
    true: bool | None
    own: bool | None
    expected: RunStatus
    actions: int
    replans: int
    clingo_calls: int
    simulated_s: float
    goal_probability: float
    anchor: str | None
    conjuncts: tuple[str, ...]
    regions: tuple[str, ...]
    witness: str | None
    displaced: tuple[str, ...]
    sequence: tuple[str, ...]
    reason: str
    trace: str
    content_hash: str
    size_bytes: int
    seconds: Mapping[str, float]

    @property
    def succeeded(self) -> bool:
        """Whether the goal is believed, and true of the object that the robot has in mind."""
        return self.believed and self.own is True

    @property
    def achievable(self) -> bool:
        """Whether the scenario says that the goal can be achieved."""
        return self.expected == "goal_achieved"

    @property
    def well_ended(self) -> bool:
        """Whether the run achieved an achievable goal, or gave up an impossible one."""
        return self.succeeded if self.achievable else self.status == self.expected

    def facts(self) -> dict[str, object]:
        """Return every field that is the same in every repetition, by name, in order."""
        return {name: getattr(self, name) for name in FACTS}


FACTS = tuple(field.name for field in fields(Row) if field.name not in ("size_bytes", "seconds"))


def expected_of(setup: Setup) -> RunStatus:
    """Return how the scenario says that its runs end."""
    return "goal_achieved" if setup.scenario.expect is None else setup.scenario.expect.status


def read_row(trace: Trace, name: str, setup: Setup) -> Row:
    """Return the row of a complete trace.

    Args:
        trace: The trace.
        name: Name of the trace in the results file.
        setup: What the run was made of.

    Raises:
        TraceError: If the trace has no start or no end, or is not sound.
    """
    start, end = next(trace.of(RunStart), None), next(trace.of(RunEnd), None)
    if start is None or end is None:
        raise TraceError(f"{trace.path}: the run has no {'end' if start else 'start'}")
    judged = next(trace.of(Verdict), None)
    milliseconds = next(iter(reversed(list(trace.of(Perf)))), Perf(step=0, milliseconds={})).milliseconds
    return Row(
        scenario=start.scenario,
        seed=start.seed,
        world=start.world,
        status=end.status,
        believed=end.status == "goal_achieved",
        true=None if judged is None else judged.true,
        own=None if judged is None else _own(trace, end, setup),
        expected=expected_of(setup),
        actions=sum(1 for _ in trace.of(ActionResult)),
        replans=sum(plan.cause in DROPPED for plan in trace.of(Plan)),
        clingo_calls=sum(decision.clingo_calls for decision in trace.of(Decision)),
        simulated_s=round(next(trace.messages("/run/end")).tick / TICKS_PER_SECOND, 3),
        goal_probability=end.goal_probability,
        anchor=end.anchor,
        conjuncts=_shares(end.conjuncts),
        regions=_shares(end.regions),
        witness=None if judged is None else judged.witness,
        displaced=() if judged is None else _shares({item.id: item.distance_m for item in judged.displaced}),
        sequence=tuple(action.op for action in trace.of(Action)),
        reason=end.reason,
        trace=name,
        content_hash=trace.content_hash,
        size_bytes=trace.path.stat().st_size,
        seconds={part: round(milliseconds.get(part, 0.0) / 1e3, 3) for part in TIMES},
    )


def _own(trace: Trace, end: RunEnd, setup: Setup) -> bool:
    """Return whether the goal is true of the object that the robot has in mind."""
    first, *others = trace.of(TrueState)
    state = others[-1] if others else first
    *_, belief = trace.of(Belief)
    return own_makes_it_true(setup.goal, setup.rulebook, state, setup.types, belief, end.anchor, first)


def _shares(probabilities: Mapping[str, float]) -> tuple[str, ...]:
    return tuple(f"{name} {p:.2f}" for name, p in probabilities.items())


def lost_row(start: RunStart, expected: RunStatus, reason: str) -> Row:
    """Return the row of a run that left no trace."""
    return Row(
        scenario=start.scenario,
        seed=start.seed,
        world=start.world,
        status="error",
        believed=False,
        true=None,
        own=None,
        expected=expected,
        actions=0,
        replans=0,
        clingo_calls=0,
        simulated_s=0.0,
        goal_probability=0.0,
        anchor=None,
        conjuncts=(),
        regions=(),
        witness=None,
        displaced=(),
        sequence=(),
        reason=reason,
        trace="",
        content_hash="",
        size_bytes=0,
        seconds=dict.fromkeys(TIMES, 0.0),
    )


def results_csv(rows: Iterable[Row]) -> str:
    """Return the results as CSV: every field that is the same in every repetition."""
    return _csv(FACTS, ([_cell(value) for value in row.facts().values()] for row in rows))


def times_csv(rows: Iterable[Row]) -> str:
    """Return the wall times in seconds as CSV."""
    head = ("scenario", "seed", *TIMES)
    return _csv(
        head, ([cell(row.scenario), str(row.seed), *(f"{row.seconds[part]:.3f}" for part in TIMES)] for row in rows)
    )


def _csv(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(lines)
    return stream.getvalue()


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return cell("; ".join(value))
    return "" if value is None else cell(str(value))
