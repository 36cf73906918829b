"""The mind at a recorded decision, rebuilt from the trace to explain it.

No recorded text is interpreted: the belief is computed again from the observations, the reasoner decides again, and
derivations come from the rules attached to the trace. An explanation is plain data; `text` puts it into words.
"""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field

from skolem.estimation import Belief
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.proofs import Derivation
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.terms import ANY, Compound, Term, compound, prob
from skolem.tools.loop.mind import Mind
from skolem.tools.loop.stopwatch import Stopwatch
from skolem.tools.recorded.geometry import RecalledGeometry
from skolem.tools.recorded.rethinking import Given
from skolem.tools.recorded.run import RecordedRun, RecordedStep
from skolem.traces.errors import Fault, InputError, NotRecordedError
from skolem.traces.messages import Decision, Memory, Message, Plan, PlanStep, Quantity, RememberedStep
from skolem.traces.wording import amounts
from skolem.traces.wording.recorded import Recorded

PLANNED = ("start", "refine")  # causes of plans that a search found


@dataclass(frozen=True, slots=True)
class Insight:
    """A mind at one recorded decision, valid only until the next one is asked for: the belief then changes.

    Attributes:
        given: The inputs of the mind.
        recorded: The decision in the trace.
        mind: The mind, whose geometry answers from the trace.
        posed: The goal in its belief.
    """

    given: Given
    recorded: RecordedStep
    mind: Mind
    posed: PosedGoal

    @property
    def step(self) -> int:
        """The number of the decision."""
        return self.recorded.step

    @property
    def belief(self) -> Belief:
        """The belief."""
        return self.mind.belief

    @property
    def denotations(self) -> Denotations:
        """The descriptions of the goal."""
        return self.mind.denotations

    def derivation(self, fluent: Term) -> Derivation:
        """Return the derivation of the rules for a fluent."""
        queries = Queries(
            self.posed.situation, self.denotations.alternatives, self.given.limits, self.denotations.universe
        )
        return Derivation(self.given.rulebook, [compound("goal", fluent)], queries)

    def stack(self) -> Memory | None:
        """Decide again, and return the plan stack at the end of the decision; None if the trace cannot tell."""
        if self.recorded.memory is None:
            return None
        self.mind.recall(self.recorded.memory)
        try:
            self.mind.decide(self.step)
        except NotRecordedError:
            return None
        return self.mind.memory(self.step + 1)


def insights(run: RecordedRun, given: Given, steps: Iterable[int]) -> Iterator[Insight]:
    """Yield the mind at each of some decisions, in order."""
    wanted = sorted(set(steps))
    geometry = RecalledGeometry(suppose_room=True)  # so that plans which the robot did not weigh can be compared
    mind = Mind(given.goal, given.rulebook, given.prior, given.limits, geometry, _unrecorded, Stopwatch())
    for recorded in run.steps():
        if recorded.step in wanted:
            geometry.take(recorded.answers)
            if recorded.memory is not None:
                mind.recall(recorded.memory)
            with suppress(NotRecordedError):
                mind.take_stock(recorded.step)
            yield Insight(given, recorded, mind, mind.posed)
        if recorded.step >= max(wanted, default=-1) or recorded.action is None or recorded.met is None:
            return
        mind.update(recorded.action, *recorded.met)


def _unrecorded(topic: str, message: Message) -> None:
    """Ignore a message: the trace has the messages of the run."""


@dataclass(slots=True)
class Course:
    """The history of the plan stack up to one decision.

    Attributes:
        found: The decision.
        before: The decision before it; None at the first.
        made: For each layer of the stack at its end, the step at which it was planned.
        within: For each of these layers the bound `Decision.within` of its plan.
        root: The subgoal of the top layer when it was planned; empty if there is none.
        stack: The plan stack at the beginning of the decision, top first.
        bound: The step at which the top layer's object not met yet turned out to be a known one, and the subgoal since
            then; None if it did not.
        plans: The changes of the stack, up to the end of the decision.
        memories: The recorded memories at the beginning of every decision, the next one included.
    """

    found: RecordedStep
    before: RecordedStep | None
    made: list[int] = field(default_factory=list)
    within: list[float | None] = field(default_factory=list)
    root: tuple[str, ...] = ()
    stack: tuple[tuple[PlanStep, ...], ...] = ()
    bound: tuple[int, tuple[str, ...]] | None = None
    plans: list[Plan] = field(default_factory=list)
    memories: dict[int, Memory] = field(default_factory=dict)


def course(run: RecordedRun, step: int | None) -> Course:
    """Return the history of the plan stack up to a decision, the last one if `step` is None.

    Raises:
        InputError: If the run has no such decision.
    """
    made: list[int] = []
    within: list[float | None] = []
    root: tuple[str, ...] = ()
    before, recorded = None, None
    stack: tuple[tuple[PlanStep, ...], ...] = ()
    bound: tuple[int, tuple[str, ...]] | None = None
    memories: dict[int, Memory] = {}
    changes: list[Plan] = []
    for current in run.steps():
        if (memory := current.memory) is not None:
            memories[current.step] = memory
        if recorded is not None and recorded.step == step:
            break
        before, recorded = recorded, current
        plans = current.all_of(Plan)
        changes += plans
        found = iter([decision for decision in current.all_of(Decision) if decision.plan])
        for plan in plans:
            if plan.cause in PLANNED:
                above = len(plan.layers) - 1
                made, within = [*made[:above], plan.step], [*within[:above], next(found).within]
                root, bound = (plan.layers[0][-1].subgoal, None) if len(plan.layers) == 1 else (root, bound)
            if plan.cause == "bind_skolem" and plan.layers:
                bound = plan.step, plan.layers[0][-1].subgoal
            del made[len(plan.layers) :], within[len(plan.layers) :]
        if current.step == step or current.last:
            continue
        stack = plans[-1].layers if plans else stack
    assert recorded is not None, "a run without decisions has no steps to go through"
    if step not in (None, recorded.step):
        raise InputError([Fault("--step", 0, 0, f"the run has decisions 0 to {recorded.step}, got {step}")])
    return Course(recorded, before, made, within, root, stack, bound, changes, memories)


# ---------------------------------------------------------------- the truth of fluents


@dataclass(frozen=True, slots=True)
class Truth:
    """The truth of a fluent in a belief.

    Attributes:
        fluent: The fluent, as a term.
        holds: Whether it holds; None if the trace cannot tell.
        probability: Its probability; None if it is not about a probability.
        wanted: The bound on its probability; None in the same case.
        detail: The figures of a Gaussian fluent, or another reason for or against it.
    """

    fluent: str
    holds: bool | None
    probability: float | None = None
    wanted: float | None = None
    detail: str = ""


def truth(insight: Insight, fluent: Term) -> Truth:
    """Return the truth of a fluent in a belief."""
    situation = insight.posed.situation
    try:
        holds: bool | None = situation.holds(fluent)
    except NotRecordedError:
        holds = None
    match fluent:
        case Compound("b", (phi, int(p))) if "sk(" not in str(phi):
            return Truth(str(fluent), holds, situation.probability(phi), prob(p))
        case Compound("bn", (Compound(quantity, (str(anchor),)), *_)) if anchor in situation.anchors():
            return Truth(str(fluent), holds, detail=_gaussian(insight, quantity, anchor))
        case Compound("at", (activity,)) if activity in situation.fruitless_here:
            return Truth(str(fluent), holds, detail="was in vain from here")
    return Truth(str(fluent), holds)


def _gaussian(insight: Insight, quantity: str, anchor: str) -> str:
    names: dict[str, Quantity] = {"pose": "pose", "colour": "colour", "weight": "weight"}
    known = insight.belief.gaussian(names[quantity], anchor)
    mean, sd = (_thousandths(values) for values in (known.mean, known.covariance.diagonal() ** 0.5))
    match quantity:
        case "pose":
            known_as = f"{amounts.pose_place(mean)}, known within {amounts.pose_spread(sd)}"
        case "colour":
            known_as = f"{amounts.colour_place(mean, {})}, known within {amounts.colour_spread(sd)}"
        case _:
            known_as = f"{amounts.weight(mean[0])}, known within {amounts.weight_spread(sd[0])}"
    return f"it is {known_as}; it exists with p = {known.probability:.3f}"


def _thousandths(values: Iterable[float]) -> list[Recorded]:
    """Return numbers in thousandths, as terms hold them."""
    return [Recorded(str(round(1000 * float(value)))) for value in values]


def mentioned(term: Term) -> set[str]:
    """Return the constants that occur in a term."""
    if isinstance(term, Compound):
        return {name for arg in term.args for name in mentioned(arg)}
    return {term} if isinstance(term, str) and term != ANY else set()


Layer = tuple[RememberedStep, ...]
