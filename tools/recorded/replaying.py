"""Replay of a recorded run: the mind gets the recorded observations and must make the recorded decisions again."""

from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, replace

from skolem.reasoner import parse_goal
from skolem.tools.loop import worlds
from skolem.tools.loop.stopwatch import Stopwatch
from skolem.tools.recorded.geometry import RecalledGeometry
from skolem.tools.recorded.rethinking import Given, Rethinking, Thought
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import CUT_SHORT, RecordedRun, RecordedStep
from skolem.traces.compare.diff import Comparison, Tolerance
from skolem.traces.errors import Fault, InputError, error_text
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import TICKS_PER_SECOND, Action, RunEnd


@dataclass(frozen=True, slots=True)
class Options:
    """How a run is replayed.

    Attributes:
        tolerance: How far floats may lie apart.
        from_step: The first decision to take again.
        re_anchor: Whether the reasoner recalls the recorded memory before every decision, so that every step that
            diverges by itself is found.
        plan_motions: Whether the planner answers geometric questions, instead of the trace.
        keep_all: Whether every divergence is kept.
    """

    tolerance: Tolerance
    from_step: int = 0
    re_anchor: bool = False
    plan_motions: bool = False
    keep_all: bool = False


@dataclass(slots=True)
class Replayed:
    """The result of a replay.

    Attributes:
        comparison: Comparison of the recorded and the new messages.
        decisions: Number of decisions taken again.
        simulated_s: Simulated time of the run up to the last of them, seconds.
        seconds: Wall time of the replay.
        recorded_s: Wall time of the run, seconds; None if it was not recorded.
        ended: Whether the trace has the end of the run.
        stopped: Why the replay stopped before the end of the trace; empty if it did not.
        other_end: A sentence if the run ended in an error and the replay does not; empty otherwise.
    """

    comparison: Comparison
    decisions: int = 0
    simulated_s: float = 0.0
    seconds: float = 0.0
    recorded_s: float | None = None
    ended: bool = False
    stopped: str = ""
    other_end: str = ""

    @property
    def identical(self) -> bool:
        """Whether the replay agrees with the record in everything."""
        return self.comparison.identical

    @property
    def believes_otherwise(self) -> bool:
        """Whether a belief differs first: the estimator has changed, since it got the recorded observations."""
        return any(found.topic == "/belief" and found.kind == "value" for found in self.comparison.divergences[:1])


def replay(
    run: RecordedRun, options: Options, watch: Stopwatch | None = None, rulebooks: Rulebooks | None = None
) -> Replayed:
    """Replay a run and compare the new messages with the recorded ones.

    Args:
        run: The recorded run.
        options: What to replay, and how to compare.
        watch: Measures the replay; by default a new one.
        rulebooks: Rules of runs that were replayed before; runs with the same rules share them.

    Raises:
        InputError: If rules or goal are wrong, there is no such decision, its memory is not recorded, or motions are to
            be planned in a world that is not installed.
    """
    replayed = Replayed(Comparison(options.tolerance, options.keep_all or options.re_anchor))
    watch = watch or Stopwatch()
    begun = watch.total()
    with closing(_geometry(run, options)) as geometry:
        mind = Rethinking(run, given_in(run, rulebooks), geometry, watch)
        for recorded in run.steps():
            if recorded.step >= options.from_step:
                _rethink(mind, recorded, options, replayed)
            elif recorded.action is not None:
                mind.go_on(recorded.action, recorded)
            if replayed.stopped:
                break
    if not replayed.decisions:
        raise InputError([Fault("--from-step", 0, 0, f"{run.path} has no decision {options.from_step}")])
    replayed.seconds, replayed.recorded_s = watch.total() - begun, run.wall_seconds()
    return replayed


def given_in(run: RecordedRun, rulebooks: Rulebooks | None = None, rules: Mapping[str, bytes] | None = None) -> Given:
    """Return the inputs of a run's mind, from its trace alone or with other rule files.

    Raises:
        InputError: If the rules or the goal are not sound for this version of the product.
    """
    rulebook = (rulebooks or Rulebooks()).of(run.attachments, rules)
    names = [item.anchor for item in run.prior.objects]
    goal = parse_goal(run.start.goal, rulebook.vocabulary.words(), names)
    prior = run.prior
    if rules:
        prior = prior.model_copy(update={"types": dict(rulebook.vocabulary.types)})
    goal = replace(goal, evaluation=run.start.evaluation or "independent")
    return Given(goal, rulebook, prior, run.start.limits)


def same_act(a: Action, b: Action) -> bool:
    """Return whether two actions are the same operation, even on another path or elsewhere."""
    return (a.op, a.command.kind) == (b.op, b.command.kind)


def other_end(recorded: RunEnd | None, failure: str) -> str:
    """Return a sentence if a run ended in an error and its repetition does not; empty otherwise.

    Args:
        recorded: The recorded end; None if there is none.
        failure: The error that ends the repetition; empty if there is none.
    """
    if recorded is None or recorded.status != "error" or failure == recorded.reason:
        return ""
    now = f", but another: {failure}" if failure else ""
    return f"the recorded error ({recorded.reason}) does not come again{now}"


def _geometry(run: RecordedRun, options: Options) -> RecalledGeometry:
    if not options.plan_motions:
        return RecalledGeometry()
    world = worlds.named(run.start.world, str(run.path))
    return RecalledGeometry(lambda: world.planner(run.prior.types, run.start.seed), recall=False)


def _rethink(mind: Rethinking, recorded: RecordedStep, options: Options, replayed: Replayed) -> None:
    """Take one decision again, compare it, and go on to the next; or note why the replay stops."""
    if options.re_anchor or recorded.step == options.from_step > 0:
        mind.recall(recorded)
    thought = mind.decide(recorded)
    replayed.comparison.add(recorded.step, *_comparable(recorded, thought))
    replayed.decisions += 1
    replayed.simulated_s = recorded.messages[-1].tick / TICKS_PER_SECOND
    replayed.ended = recorded.end is not None
    failure = _failure(thought)
    if recorded.action is not None and recorded.met is not None:
        if options.re_anchor:
            failure = _go_on(mind, recorded.action, recorded)
        elif thought.action is not None and same_act(thought.action, recorded.action):
            failure = _go_on(mind, thought.action, recorded)
        else:
            replayed.stopped = f"what follows in the trace came of {recorded.action.op}, not of {thought.outcome}"
    replayed.other_end = other_end(recorded.end, failure)


def _failure(thought: Thought) -> str:
    """Return the error that ended a decision; empty if the decision only asked a question that is not recorded."""
    asks = bool(thought.messages) and thought.messages[-1].topic == "/geometry"
    return "" if asks else thought.failure


def _go_on(mind: Rethinking, action: Action, recorded: RecordedStep) -> str:
    """Take in the recorded result of an action; return the error if it fails where the run failed too, else empty."""
    try:
        mind.go_on(action, recorded)
    except Exception as error:
        if recorded.end is None or recorded.end.status != "error":
            raise
        return error_text(error)
    return ""


def _comparable(recorded: RecordedStep, thought: Thought) -> tuple[list[Recorded], list[Recorded]]:
    """Return the recorded and the new messages; those after the end of a run that was cut short are left out."""
    end = recorded.end
    if not recorded.last or (end is not None and end.status not in CUT_SHORT):
        return recorded.messages, thought.messages
    expected = [message for message in recorded.messages if message.topic != "/run/end"]
    return expected, thought.messages[: len(expected)]
