"""What-if replay: which decisions of a recorded run change with other rules, another goal or other thresholds.

The changed mind gets the recorded observations, and after every decision it goes on with the recorded action. So each
decision is compared for the recorded history. The record does not apply after the first other action.
"""

import math
from contextlib import closing
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Final, Literal

from skolem.reasoner.terms import MICRO
from skolem.tools.loop import WorldKind, worlds
from skolem.tools.recorded.geometry import RecalledGeometry
from skolem.tools.recorded.replaying import same_act
from skolem.tools.recorded.rethinking import Given, Rethinking, Thought, end_text
from skolem.tools.recorded.run import CUT_SHORT, RecordedRun, RecordedStep
from skolem.traces.messages import Command, Decision, LookAt, MoveBase, Pick, Place, Plan, RunEnd, Weigh

Kind = Literal["act", "end", "motion", "plan", "search"]
ELSEWHERE: Final = 0.05  # metres and radians: a motion that ends farther off shows the robot another scene


@dataclass(frozen=True, slots=True)
class Altered:
    """A decision that changes.

    Attributes:
        step: Number of the decision.
        kind: `act`: another action, or the same one elsewhere; `end`: another end of the run; `motion`: the same action
            on another path to nearly the same pose; `plan`: the same action for another plan; `search`: the same action
            and plan with other candidates or costs.
        was: The recorded decision.
        now: The new decision.
    """

    step: int
    kind: Kind
    was: str
    now: str

    def __str__(self) -> str:
        return f"step {self.step}, {self.kind}: was {self.was}, would be {self.now}"


@dataclass(slots=True)
class Foreseen:
    """The result of a what-if replay.

    Attributes:
        altered: The decisions that change, each with its gravest change.
        decisions: Number of decisions taken again.
        recorded: Number of recorded decisions.
        stopped: Why the rest of the record does not apply; empty if it does.
        planned: Number of geometric questions that the planner answered, because the record does not.
    """

    altered: list[Altered] = field(default_factory=list)
    decisions: int = 0
    recorded: int = 0
    stopped: str = ""
    planned: int = 0


def foresee(run: RecordedRun, given: Given) -> Foreseen:
    """Return the decisions of a run that change for a mind with other inputs.

    Recorded geometric answers are used if the prior is unchanged, for then the belief is, too; the planner of the run's
    world answers other questions.

    Raises:
        InputError: If there is such a question, and that world is not installed.
    """
    foreseen = Foreseen()
    prior, world = given.prior, _installed(run)
    planner = None if world is None else lambda: world.planner(prior.types, run.start.seed)
    with closing(RecalledGeometry(planner, recall=prior == run.prior)) as geometry:
        mind = Rethinking(run, given, geometry)
        for recorded in run.steps():
            foreseen.recorded += 1
            if not foreseen.stopped:
                _decide(mind, recorded, foreseen)
            if geometry.unanswered is not None:
                worlds.named(
                    run.start.world, f"{run.path}: step {recorded.step} asks for motions that are not recorded"
                )
        foreseen.planned = geometry.planned
    return foreseen


def _installed(run: RecordedRun) -> WorldKind | None:
    """Return the kind of world of a run; None if it is not installed, for many replays do not need it."""
    return worlds.named(run.start.world) if run.start.world in worlds.names() else None


def _decide(mind: Rethinking, recorded: RecordedStep, foreseen: Foreseen) -> None:
    """Take one decision with the changed mind, and go on with the recorded action if it would do the same."""
    if recorded.action is None and (recorded.end is None or recorded.end.status in CUT_SHORT):
        foreseen.stopped = f"step {recorded.step}: the record ends before the decision"
        return
    thought = mind.decide(recorded)
    foreseen.decisions += 1
    change = _change(recorded, thought)
    if change is not None:
        foreseen.altered.append(change)
        if change.kind in ("act", "end"):
            foreseen.stopped = f"step {change.step}: what follows in the trace came of {change.was}"
    if recorded.action is not None and not foreseen.stopped:
        mind.go_on(recorded.action, recorded)


def _change(recorded: RecordedStep, thought: Thought) -> Altered | None:
    """Return the gravest change of a decision; None if it does not change."""
    step, was, now = recorded.step, recorded.action, thought.action
    turn = thought.turn
    if turn is None or was is None or now is None:
        if turn is None or was is not None or now is not None or _ended(recorded.end) != _ended(turn.end):
            return Altered(step, "end" if was is None else "act", _outcome(recorded), thought.outcome)
    elif not same_act(was, now):
        return Altered(step, "act", was.op, now.op)
    elif not ends_alike(was.command, now.command):
        return Altered(step, "act", f"{was.op}{_to(was.command)}", f"{now.op}{_to(now.command)}, elsewhere")
    elif was.command != now.command:
        return Altered(step, "motion", was.op, f"{now.op} on another path")
    for one, other in zip_longest(map(_planned, recorded.all_of(Plan)), map(_planned, turn.plans), fillvalue=()):
        if one != other:
            return Altered(step, "plan", *_parting(one, other))
    searches = map(_searched, recorded.all_of(Decision)), map(_searched, turn.decisions)
    for one, other in zip_longest(*searches, fillvalue=()):
        if one != other:
            return Altered(step, "search", *_parting(one, other))
    return None


def ends_alike(one: Command, other: Command) -> bool:
    """Return whether two motions of one kind end so near each other that the observation after both is the same."""
    hands = {command.hand for command in (one, other) if isinstance(command, Pick | Place | Weigh)}
    ends, others = _ending(one), _ending(other)
    if len(hands) > 1 or len(ends) != len(others):
        return False
    apart = [a - b for a, b in zip(ends, others, strict=True)]
    metres = 2 if isinstance(one, MoveBase) else 0  # number of leading values in metres; the others are angles
    apart[metres:] = [math.remainder(turn, math.tau) for turn in apart[metres:]]
    return all(abs(each) <= ELSEWHERE for each in apart)


def _ending(command: Command) -> tuple[float, ...]:
    """Return the end of a motion: base pose in the frame of the start, head angles, or arm angles at the object."""
    match command:
        case MoveBase(start_T_waypoint=path):
            return path[-1] if path else (0.0, 0.0, 0.0)
        case LookAt(pan=pan, tilt=tilt):
            return (pan, tilt)
        case Pick(reach=path) | Place(lower=path):
            return path[-1] if path else ()
    return ()


def _to(command: Command) -> str:
    """Return the end of a motion in words; empty for an arm, whose angles do not help a reader."""
    match command:
        case MoveBase():
            return " by ({:.2f} m, {:.2f} m, {:.2f} rad)".format(*_ending(command))
        case LookAt():
            return " at ({:.2f}, {:.2f}) rad".format(*_ending(command))
    return ""


def _ended(end: RunEnd | None) -> tuple[str, str | None] | None:
    return None if end is None else (end.status, end.anchor)


def _outcome(recorded: RecordedStep) -> str:
    return recorded.action.op if recorded.action is not None else end_text(recorded.end)


def _planned(plan: Plan) -> tuple[str, ...]:
    """Return a change of the plan stack: its cause, and for each layer the chosen step and those after it."""
    layers = zip(plan.layers, plan.current, strict=True)
    return (f"[{plan.cause}]", *(" > ".join(step.op for step in layer[chosen:]) for layer, chosen in layers))


def _searched(decision: Decision) -> tuple[str, ...]:
    """Return a search: its result, and every candidate with its cost in nats or the reason of its rejection."""
    found = f"{' > '.join(decision.plan) or 'no plan'} {decision.cost / MICRO:.6f}"
    return (found, *(f"{c.op} {c.rejected or f'{c.cost / MICRO:.6f}'}" for c in decision.candidates))


def _parting(one: tuple[str, ...], other: tuple[str, ...]) -> tuple[str, str]:
    """Return the first parts that differ."""
    pairs = zip_longest(one, other, fillvalue="nothing")
    return next((a, b) for a, b in pairs if a != b)
