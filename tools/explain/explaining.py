"""The explanation of a decision, put together in one pass over the trace."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from skolem.reasoner.terms import parse_term
from skolem.tools.explain.actions import LayerView, Rules, view
from skolem.tools.explain.drops import Drop, drops, truths
from skolem.tools.explain.end import Ending, ending, failure
from skolem.tools.explain.insight import Course, Insight, Truth, course, insights, mentioned
from skolem.tools.explain.objects import Choice, choice
from skolem.tools.explain.refusals import Refused
from skolem.tools.recorded.replaying import Options, given_in, replay
from skolem.tools.recorded.rethinking import Given
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun, RecordedStep
from skolem.traces.compare.diff import tolerance_for
from skolem.traces.errors import BrokenRulesError, InternalError, error_text
from skolem.traces.messages import Memory

NO_MEMORY = "an older trace, without /memory: the rules behind the action cannot be told"


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why one decision was taken.

    Attributes:
        goal: The goal of the run.
        step: The decision.
        action: The action; empty if the run ended here.
        choice: Why this object; None if no object was chosen.
        layers: Why this action: every plan on the stack.
        drops: Why plans were dropped.
        ending: Why the run ended; None if it did not end here, or ended well.
        notes: What could not be explained, and why.
        parts: The first decision at which this version of the product decides differently from the robot; None if it
            decides alike up to this one.
    """

    goal: str
    step: int
    action: str
    choice: Choice | None
    layers: tuple[LayerView, ...]
    drops: tuple[Drop, ...]
    ending: Ending | None
    notes: tuple[str, ...]
    parts: int | None = None


@dataclass(slots=True)
class _Thoughts:
    """The findings of taking the decisions again, so far."""

    choice: Choice | None = None
    before: dict[str, Truth] = field(default_factory=dict)
    now: dict[str, Truth] = field(default_factory=dict)
    ending: Ending | None = None
    views: tuple[LayerView, ...] = ()


def explained(trace: Path, step: int | None) -> Explanation:
    """Explain a decision of a recorded run; the last one if `step` is None.

    Raises:
        InputError: If there is no such decision, or its rules cannot be read any more.
        TraceError: If the trace cannot be read.
    """
    run, rulebooks = RecordedRun(trace), Rulebooks()
    path = course(run, step)
    given = given_in(run, rulebooks)
    found, end = path.found, path.found.end
    thoughts, notes = _Thoughts(), [] if found.memory is not None else [NO_MEMORY]
    try:
        _think(run, given, path, thoughts)
    except Exception as error:
        again = end is not None and error_text(error) == end.reason
        if not again and not isinstance(error, InternalError | BrokenRulesError):
            raise
        notes.append(f"thought again, it fails {'in the same way' if again else f'with: {str(error).splitlines()[0]}'}")
    if end is not None and end.status == "error":
        thoughts.ending = failure(found, end)
        # without a decision, no object was chosen and none rejected
        thoughts.choice = thoughts.choice if path.made else None
    return Explanation(
        goal=run.start.goal,
        step=found.step,
        action="" if found.action is None else found.action.op,
        choice=thoughts.choice,
        layers=thoughts.views,
        drops=drops(path, thoughts.now, thoughts.before),
        ending=thoughts.ending,
        notes=(*notes, *_bound(path)),
        parts=_parting(trace, found.step, rulebooks),
    )


def _think(run: RecordedRun, given: Given, path: Course, thoughts: _Thoughts) -> None:
    """Take again the decisions that led to the one to explain.

    Raises:
        InternalError: If the rules fail; earlier findings are kept.
    """
    at, made = path.found.step, path.made
    failed = path.found.end if path.found.end is not None and path.found.end.status != "goal_achieved" else None
    chosen_at = made[0] if made else at
    following = path.memories.get(at + 1)
    most = run.start.limits.repeats
    for insight in insights(run, given, {at - 1, at, *made}):
        if insight.step == at - 1:
            thoughts.before = truths(insight, path.stack)
        if insight.step == at:
            following = following or insight.stack()
        if insight.step == chosen_at:
            after = following if chosen_at == at else path.memories.get(chosen_at + 1)
            refused = Refused(path.plans, chosen_at, after, most)
            thoughts.choice = choice(insight, path.root if made else _achieved(insight), refused)
        if insight.step == at:
            thoughts.now = truths(insight, path.stack)
            if failed is not None and thoughts.choice is not None:
                refused = Refused(path.plans, at, following, most)
                thoughts.ending = ending(insight, thoughts.choice, failed, following, refused.here)
    if following is not None and len(following.layers) == len(made):
        thoughts.views = _views(run, given, path, following)


def _bound(path: Course) -> Iterator[str]:
    """Yield the known object that the plan's object not met yet turned out to be."""
    if path.made and path.bound is not None and path.bound[1] != path.root:
        step, subgoal = path.bound
        before, after = (
            {name for text in texts for name in mentioned(parse_term(text))} for texts in (path.root, subgoal)
        )
        if names := sorted(after - before):
            yield f"the object not met yet at step {path.made[0]} was taken to be {', '.join(names)} at step {step}"


def _achieved(insight: Insight) -> tuple[str, ...]:
    """Return the reading of the goal that holds; empty if none does."""
    return tuple(map(str, insight.posed.achieved() or ()))


def _views(run: RecordedRun, given: Given, path: Course, stack: Memory) -> tuple[LayerView, ...]:
    """Return every plan of the stack, each explained in the belief in which it was made."""
    rules = Rules()
    views: dict[int, LayerView] = {}
    for insight in insights(run, given, path.made):
        rules.enter(insight)
        for i, made in enumerate(path.made):
            if made == insight.step:
                views[i] = view(stack.layers[i], stack.current[i], made, path.within[i], rules)
    return tuple(views[i] for i in sorted(views))


def _parting(trace: Path, step: int, rulebooks: Rulebooks) -> int | None:
    """Return the first decision, up to `step`, that differs from the recorded one; None if none does.

    An explanation holds only as far as this version decides as the robot did. Last digits of floats do not count, as
    between two machines.
    """
    replayed = replay(_Beginning(trace, step), Options(tolerance_for("other machine")), rulebooks=rulebooks)
    return next((divergence.step for divergence in replayed.comparison.divergences), None)


class _Beginning(RecordedRun):
    """A recorded run, up to one decision."""

    def __init__(self, path: Path, until: int) -> None:
        super().__init__(path)
        self._until = until

    def steps(self) -> Iterator[RecordedStep]:
        for recorded in super().steps():
            yield recorded
            if recorded.step >= self._until:
                return
