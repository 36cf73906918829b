"""The parts of an explanation put together, in one pass over the trace."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from skolem.reasoner.terms import parse_term
from skolem.tools.explanation import Course, Insight, Truth, course, insights, mentioned
from skolem.tools.explanation_actions import LayerView, Rules, view
from skolem.tools.explanation_drops import Drop, drops, truths
from skolem.tools.explanation_end import Ending, ending
from skolem.tools.explanation_objects import Choice, choice
from skolem.tools.recorded_run import RecordedRun
from skolem.tools.replaying import given_in
from skolem.traces.messages import Memory

NO_MEMORY = "an older trace, without /memory: the rules behind the action cannot be told"


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why one decision was taken.

    Attributes:
        goal: Of the run.
        step: The decision.
        action: What was done; empty if the run ended here.
        choice: Why this object; None if no object was chosen any more.
        layers: Why this action: every plan on the stack.
        drops: Why plans were dropped.
        ending: Why the run ended; None if it did not end here, or ended well.
        notes: What could not be told, and why.
    """

    goal: str
    step: int
    action: str
    choice: Choice | None
    layers: tuple[LayerView, ...]
    drops: tuple[Drop, ...]
    ending: Ending | None
    notes: tuple[str, ...]


def explained(trace: Path, step: int | None) -> Explanation:
    """Explain a decision of a recorded run; the last one if `step` is None.

    Raises:
        InputError: If there is no such decision, or its rules cannot be read any more.
        TraceError: If the trace cannot be read.
    """
    run = RecordedRun(trace)
    path = course(run, step)
    at, made = path.found.step, path.made
    failed = path.found.end if path.found.end is not None and path.found.end.status != "goal_achieved" else None
    chosen_at = made[0] if made else at
    rules = Rules()
    before: dict[str, Truth] = {}
    now: dict[str, Truth] = {}
    found_choice, end, stack = None, None, None
    notes = [] if path.found.memory is not None else [NO_MEMORY]
    for insight in insights(run, given_in(run), {at - 1, at, *made}):
        if insight.step == at - 1:
            before = truths(insight, path.stack)
        if insight.step == chosen_at:
            found_choice = choice(insight, path.root if made else _achieved(insight))
        if insight.step == at:
            now = truths(insight, path.stack)
            stack = insight.stack()
            if failed is not None and found_choice is not None:
                end = ending(insight, found_choice, failed, stack)
    views = _views(run, path, stack, rules) if made and stack is not None else {}
    action = "" if path.found.action is None else path.found.action.op
    return Explanation(
        goal=run.start.goal,
        step=at,
        action=action,
        choice=found_choice,
        layers=tuple(views[i] for i in sorted(views)),
        drops=drops(path, now, before),
        ending=end,
        notes=(*notes, *_bound(path)),
    )


def _bound(path: Course) -> Iterator[str]:
    """Yield what the object turned out to be that was not met when the plan was made."""
    if path.made and path.bound is not None and path.bound[1] != path.root:
        step, subgoal = path.bound
        before, after = (
            {name for text in texts for name in mentioned(parse_term(text))} for texts in (path.root, subgoal)
        )
        if names := sorted(after - before):
            yield f"the object not met yet at step {path.made[0]} was taken to be {', '.join(names)} at step {step}"


def _achieved(insight: Insight) -> tuple[str, ...]:
    """Return the reading of the goal that holds; nothing if none does."""
    return tuple(map(str, insight.posed.achieved() or ()))


def _views(run: RecordedRun, path: Course, stack: Memory, rules: Rules) -> dict[int, LayerView]:
    """Return every plan of the stack, each explained in the belief in which it was made."""
    views: dict[int, LayerView] = {}
    for insight in insights(run, given_in(run), path.made):
        rules.enter(insight)
        for i, made in enumerate(path.made):
            if made == insight.step:
                views[i] = view(stack.layers[i], stack.current[i], made, path.within[i], rules)
    return views
