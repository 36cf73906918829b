"""One decision of a recorded run in words: belief, plans, candidates, action and observation."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from skolem.tools.recorded.rules import rulebook_of
from skolem.tools.words.belief_table import COLUMNS, belief_rows, object_cells, probability, table_lines
from skolem.tools.words.optimality import optimality
from skolem.tools.words.plan_tree import drop_line, plan_lines
from skolem.traces import Trace
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import (
    DROPPED,
    TICKS_PER_SECOND,
    Action,
    ActionResult,
    Belief,
    Decision,
    Denotation,
    Detection,
    IdentityChange,
    Meaning,
    Observation,
    Plan,
    RunEnd,
)
from skolem.traces.messages.likeliest import likeliest
from skolem.traces.wording.wording import Wording

TOPICS = ("/belief", "/denotation", "/plan", "/decision", "/action", "/action/result", "/obs", "/run/end")
CANDIDATES = 12  # number shown for one search, cheapest first
HISTORY_COLUMNS = ("step", "exists", *COLUMNS[1:], "after", "identity")


@dataclass(slots=True)
class Moment:
    """The record of one decision.

    Attributes:
        step: Number of actions executed before.
        tick: Simulated time of the decision.
        belief: The belief.
        identity: Anchors that were merged into one or split into two since the decision before.
        denotation: The denotation; None if the trace does not record it.
        stack: The plan stack at the end of the decision.
        plans: Every change of the plan stack.
        decisions: Every search.
        action: The action; None if the run ended here.
        result: Its result.
        observation: The observation after it.
        end: The end of the run, if it ended here.
    """

    step: int
    tick: int = 0
    belief: Belief | None = None
    identity: tuple[IdentityChange, ...] = ()
    denotation: Denotation | None = None
    stack: Plan | None = None
    plans: list[Plan] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    action: Action | None = None
    result: ActionResult | None = None
    observation: Observation | None = None
    end: RunEnd | None = None

    def take(self, message: object) -> None:
        """Take in a message of this decision."""
        match message:
            case Belief():
                self.belief = message
            case Denotation():
                self.denotation = message
            case Plan():
                self.plans.append(message)
            case Decision():
                self.decisions.append(message)
            case Action():
                self.action = message
            case ActionResult():
                self.result = message
            case Observation():
                self.observation = message
            case _:
                pass


def moment(trace: Trace, step: int) -> Moment:
    """Read one decision.

    Raises:
        InputError: If the run has no decision of that number.
    """
    found, last, before = Moment(step), -1, 0
    for recorded in trace.messages(*TOPICS):
        message = recorded.message
        if isinstance(message, Plan) and message.step <= step:
            found.stack = message
        if isinstance(message, RunEnd):
            found.end = message if message.steps == step else None
        elif (last := getattr(message, "step", last)) == step:
            found.tick = recorded.tick if isinstance(message, Belief) else found.tick
            found.take(message)
        if isinstance(message, Belief):
            found.identity = message.identity[before:] if message.step == step else found.identity
            before = len(message.identity)
    if found.belief is None:
        there = f"has decisions 0 to {last}" if last >= 0 else "ended before its first decision"
        raise InputError([Fault("--step", 0, 0, f"the run {there}, got {step}")])
    return found


def moment_lines(found: Moment, meanings: Mapping[str, Meaning], words: Wording) -> list[str]:
    """Return a decision as lines of text; `meanings` give the colour words."""
    assert found.belief is not None, "`moment` has found one"
    lines = [f"step {found.step}, {found.tick / TICKS_PER_SECOND:.2f} s simulated", ""]
    lines += table_lines(COLUMNS, belief_rows(found.belief, meanings))
    lines += [f"identity: {identity_text(change)}" for change in found.identity]
    lines += [*_doubts(found.belief), *_regions(found.belief), *_meant(found.denotation, words)]
    if any(plan.cause in DROPPED for plan in found.plans):
        lines += ["", *(drop_line(plan, words) for plan in found.plans if plan.cause in DROPPED)]
    if found.stack is not None and found.stack.layers:
        lines += ["", "plan stack (the chosen step of each layer in angle brackets)"]
        lines += [f"  {line}" for line in plan_lines(found.stack, words)]
    for decision in found.decisions:
        lines += ["", *_search(decision, words)]
    return [*lines, "", *_outcome(found, words)]


def identity_text(change: IdentityChange) -> str:
    """Return in words which anchors were merged into one, or which was split into two."""
    if change.kind == "merged":
        return f"{change.other} turned out to be {change.anchor}, whose name goes on"
    return f"{change.anchor} turned out to be two objects"


def _doubts(belief: Belief) -> list[str]:
    doubts = [(a, belief.objects[a].exists) for a in belief.anchors if belief.objects[a].exists < 1.0]
    return [f"exists: {', '.join(f'{anchor} {probability(p)}' for anchor, p in doubts)}"] if doubts else []


def _regions(belief: Belief) -> list[str]:
    known = [f"{name} on {region.support} {probability(region.seen)}" for name, region in belief.regions.items()]
    return [f"contents known: {', '.join(known)}"] if known else []


def _meant(denotation: Denotation | None, words: Wording) -> Iterator[str]:
    for description, table in ({} if denotation is None else denotation.probability).items():
        ranked = sorted(table.items(), key=lambda item: (-item[1], item[0]))
        yield f"{words.meant(description)}: {', '.join(f'{anchor} {p:.3f}' for anchor, p in ranked) or 'nobody'}"


def _search(decision: Decision, words: Wording) -> Iterator[str]:
    """Yield the subgoal of a search, its result, and the candidates of the first expansion."""
    yield f"a plan was sought for {words.aim(decision.subgoal)}"
    if decision.plan:
        p = math.exp(-decision.cost / 1e6)
        yield f"  p = {p:.3f}, {optimality(decision.within)}: {' ; '.join(map(words.operation, decision.plan))}"
    else:
        yield "  no plan"
    calls = f"{decision.clingo_calls} rule call{'' if decision.clingo_calls == 1 else 's'}"
    expansions = f"{decision.expansions} expansion{'' if decision.expansions == 1 else 's'}"
    yield f"  {expansions}, {calls}, {decision.ground_atoms} ground atoms"
    steps = [(words.operation(candidate.op), candidate) for candidate in decision.candidates[:CANDIDATES]]
    width = max((len(op) for op, _ in steps), default=0)
    yield "  steps that the rules know for it:" if steps else "  the rules know no step for it"
    for op, candidate in steps:
        said = "possible" if candidate.rejected is None else f"not possible: {words.refusal(candidate.rejected)}"
        yield f"  p {math.exp(-candidate.cost / 1e6):.3f}  {op.ljust(width)}  {said}"
    if len(decision.candidates) > CANDIDATES:
        yield f"  and {len(decision.candidates) - CANDIDATES} more (all with --json)"


def _outcome(found: Moment, words: Wording) -> Iterator[str]:
    """Yield the action with its result and observation, or the end of the run."""
    if found.action is not None:
        status = "" if found.result is None else f" -> {found.result.status.replace('_', ' ')}"
        yield f"did: {words.operation(found.action.op)}{status}"
    if found.observation is not None:
        yield from _sensed(found.observation)
    if found.end is not None:
        yield words.end(found.end)


def _sensed(observation: Observation) -> Iterator[str]:
    if observation.kind == "look":
        yield f"saw: {len(observation.detections) or 'no'} object{'' if len(observation.detections) == 1 else 's'}"
        for detection in observation.detections:
            yield f"  {_seen(detection)}"
    if observation.wrench is not None:
        yield f"felt: {-observation.wrench.force_newton[2]:.2f} N in the {observation.wrench.hand} hand"


def _seen(detection: Detection) -> str:
    likelihoods = detection.type_log_likelihood
    kind = likeliest(likelihoods) if likelihoods else "of no type"
    x, y, z, _ = detection.base_T_object
    rgb = " ".join(f"{channel:.2f}" for channel in detection.rgb)
    return f"{kind} at ({x:.2f}, {y:.2f}, {z:.2f}) from the base, rgb {rgb}, {detection.points} points"


def moment_fields(found: Moment, meanings: Mapping[str, Meaning]) -> dict[str, object]:
    """Return a decision as the fields of `--json`: the table's rows, and the messages as recorded."""
    assert found.belief is not None, "`moment` has found one"
    optional = {
        "denotation": found.denotation,
        "stack": found.stack,
        "action": found.action,
        "result": found.result,
        "observation": found.observation,
        "end": found.end,
    }
    return {
        "step": found.step,
        "simulated_s": round(found.tick / TICKS_PER_SECOND, 3),
        "belief": [dict(zip(COLUMNS, row, strict=True)) for row in belief_rows(found.belief, meanings)],
        "identity": [change.model_dump(mode="json") for change in found.identity],
        "exists": {anchor: found.belief.objects[anchor].exists for anchor in found.belief.anchors},
        "plans": [plan.model_dump(mode="json") for plan in found.plans],
        "decisions": [decision.model_dump(mode="json") for decision in found.decisions],
    } | {name: None if message is None else message.model_dump(mode="json") for name, message in optional.items()}


def history(trace: Trace, anchor: str, meanings: Mapping[str, Meaning]) -> list[tuple[str, ...]]:
    """Return an object's rows, one for each decision with it in the belief, or at which it was merged into another.

    A row has the step, the cells, the action before, and the merged or split anchors since the row before.

    Raises:
        InputError: If no belief of the run has an object of that name.
    """
    rows: list[tuple[str, ...]] = []
    known, did, before = set[str](), "", 0
    for recorded in trace.messages("/belief", "/action"):
        message = recorded.message
        if isinstance(message, Action):
            did = message.op
        elif isinstance(message, Belief):
            known |= message.objects.keys()
            changes = [c for c in message.identity[before:] if anchor in (c.anchor, c.other)]
            before = len(message.identity)
            item = message.objects.get(anchor)
            if item is not None or changes:
                cells = ("",) * 5 if item is None else (probability(item.exists), *object_cells(item, meanings))
                rows.append((str(message.step), *cells, did, "; ".join(map(identity_text, changes))))
    if not rows:
        raise InputError([Fault("--object", 0, 0, f"no belief has {anchor!r}; there are: {', '.join(sorted(known))}")])
    return rows


def words_of(trace: Trace) -> Mapping[str, Meaning]:
    """Return the meanings of the words in a run's own rules.

    Raises:
        InputError: If this version cannot read the rules of the run.
    """
    return rulebook_of(trace.attachments).vocabulary.meanings
