"""The steps that the robot refused, with time and reason."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from skolem.reasoner.planning.instances import Instance, title
from skolem.reasoner.planning.patterns import Mutexes
from skolem.reasoner.planning.regression import Found, Offers, Subgoal, regress
from skolem.reasoner.terms import Term, nll, parse_term
from skolem.tools.explain.insight import Insight
from skolem.traces.errors import NotRecordedError
from skolem.traces.messages import Memory, Plan, PlanStep


@dataclass(frozen=True, slots=True)
class Refusal:
    """A step that could not be refined or executed in the belief of one decision.

    Attributes:
        step: The decision.
        operation: The operation, as a term.
        chosen: The step chosen in every layer of the stack, top first, the refused one last; empty if it was refused
            because its placeholder turned out to be an object with which it cannot be used.
        lacking: The fluents without which the robot cannot do it.
    """

    step: int
    operation: str
    chosen: tuple[PlanStep, ...]
    lacking: tuple[str, ...] = ()

    @property
    def op(self) -> str:
        """The step in words."""
        return title(parse_term(self.operation))

    def forbids(self, instance: Instance, level: int) -> bool:
        """Return whether a step is the refused one."""
        return bool(self.chosen) and (title(instance.operation), level) == (self.op, self.chosen[-1].level)


@dataclass(frozen=True, slots=True)
class Objection:
    """A rule that refuses a step: `rejected(S, Reason)`.

    Attributes:
        op: The step.
        reason: The reason that the rule gives.
        place: File and line of the rule, `mine.lp:6`.
    """

    op: str
    reason: str
    place: str

    def __str__(self) -> str:
        return f"{self.op}: {self.reason}{f' [{self.place}]' if self.place else ''}"


class Refused:
    """The steps that the robot refused at one decision."""

    def __init__(self, plans: Iterable[Plan], step: int, after: Memory | None, most: int) -> None:
        """Collect the refused steps.

        Args:
            plans: The changes of the stack from the first decision on.
            step: The decision.
            after: The memory after the decision; None if the trace cannot tell.
            most: How often in a row a command may fail, `limits.repeats`.
        """
        self._before = [each for each in refusals(plans) if each.step <= step]
        self.here = [each for each in self._before if each.step == step]
        counts = {} if after is None else after.failures
        self._failures = {name: count for name, count in counts.items() if count >= most}

    def forbids(self, instance: Instance, level: int) -> bool:
        """Return whether the robot refused a step."""
        return str(instance.executes) in self._failures or any(each.forbids(instance, level) for each in self.here)

    def objection(self, insight: Insight, found: Found) -> str:
        """Return which step of a plan was refused, when and why; empty if none was."""
        step = next((s for s in found.steps or () if self.forbids(s.instance, s.level)), None)
        if step is None:
            return ""
        op = title(step.instance.operation)
        same = [each for each in self._before if each.op == op and (each.lacking or each.step == insight.step)]
        if not same:
            return f"{op} was done {self._failures[str(step.instance.executes)]} times without doing what it should"
        first = next(each.step for each in self._before if each.op == op)
        since = "" if first == insight.step else f", and first at step {first}"
        return f"{op} was refused at step {same[-1].step}{since}: {self.why(insight, same[-1])}"

    def why(self, insight: Insight, refusal: Refusal) -> str:
        """Return why a step was refused at the decision of `insight`."""
        if refusal.lacking:
            return f"it needs {', '.join(refusal.lacking)}"
        if not refusal.chosen:
            return "the object not met yet turned out to be one with which it cannot be done"
        if _is_detailed(refusal):
            asked_in_vain = any(a.answer is None and a.blockers is None for a in insight.recorded.answers)
            if self._failures and not asked_in_vain:
                return f"it was done {insight.given.limits.repeats} times without doing what it should"
            return "no way was found to do it in the believed world"
        if objections := ruled_out(insight, refusal):
            return f"rules refuse {'; '.join(map(str, objections))}"
        inner = [each for each in self.here if refusal.op in {step.op for step in each.chosen} - {each.op}]
        if inner:
            return f"{inner[0].op}, which it takes, was refused: {self.why(insight, inner[0])}"
        return "no plan was found that does it in detail"


def chosen_in(plan: Plan | None) -> tuple[PlanStep, ...]:
    """Return the step chosen in every layer of a stack."""
    return () if plan is None else tuple(layer[i] for layer, i in zip(plan.layers, plan.current, strict=True))


def refusals(plans: Iterable[Plan]) -> Iterator[Refusal]:
    """Yield the refused steps, in order, from the changes of the stack."""
    before = None
    for plan in plans:
        if plan.cause == "refused":
            chosen = chosen_in(before)
            name, *others = plan.false_fluents
            if chosen and chosen[-1].op == title(parse_term(name)):
                yield Refusal(plan.step, name, chosen, tuple(others))
            else:
                yield from (Refusal(plan.step, each, ()) for each in plan.false_fluents)
        before = plan


def ruled_out(insight: Insight, refusal: Refusal) -> tuple[Objection, ...]:
    """Return the rules that keep a step from being refined; empty if the cause is no rule.

    If the removal of a single reason would allow a plan, only the rules with such reasons are returned.
    """
    if not refusal.chosen or _is_detailed(refusal):
        return ()
    heard = _Heard(insight.posed.offers)
    try:
        if _can_be_refined(insight, refusal, heard):
            return ()
        reasons = dict.fromkeys(reason for _, reason in heard.rejected)
        enough = [r for r in reasons if _can_be_refined(insight, refusal, _Heard(insight.posed.offers, r))]
    except NotRecordedError:
        return ()
    found = {
        Objection(title(step), reason, _place(insight, step, reason, fluent))
        for (step, reason), fluent in heard.rejected.items()
        if not enough or reason in enough
    }
    return tuple(sorted(found, key=str))


def _is_detailed(refusal: Refusal) -> bool:
    """Return whether a step was to be carried out, not refined."""
    step = refusal.chosen[-1]
    return step.primitive and step.level >= step.concrete


def _can_be_refined(insight: Insight, refusal: Refusal, offers: Offers) -> bool:
    """Return whether there is a plan, one level deeper, for the subgoal of a step, if no other step is refused."""
    limits = insight.given.limits
    subgoal: Subgoal = frozenset(map(parse_term, refusal.chosen[-1].subgoal))
    worst = nll(limits.min_plan_probability)

    def level_of(instance: Instance) -> int:
        name = title(instance.operation)
        return max((step.level + 1 for step in refusal.chosen if step.op == name), default=0)

    def nothing(_instance: Instance, _level: int) -> bool:
        return False

    ends = (parse_term(refusal.operation), None)
    return any(
        regress((subgoal,), offers, level_of, nothing, limits.expansions, worst, final, limits.optimal).steps
        for final in ends
    )


def _place(insight: Insight, step: Term, reason: str, fluent: Term) -> str:
    derivation = insight.derivation(fluent)
    atoms = [a for a in derivation.atoms("rejected", 2) if a.args[0] == step and str(a.args[1]) == reason]
    return derivation.proof(atoms[0]).place if atoms else ""


class _Heard:
    """Offers that note the instances that rules reject, and that can ignore one reason."""

    def __init__(self, offers: Offers, without: str | None = None) -> None:
        self._offers, self._without = offers, without
        self.rejected: dict[tuple[Term, str], Term] = {}  # (step, reason) -> a fluent for which the step was offered

    @property
    def mutexes(self) -> Mutexes:
        return self._offers.mutexes

    def prepare(self, fluents: Iterable[Term]) -> None:
        self._offers.prepare(fluents)

    def holds(self, fluent: Term) -> bool:
        return self._offers.holds(fluent)

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        found = self._offers.offers(fluent)
        for instance in found:
            for reason in instance.rejected:
                self.rejected.setdefault((instance.step, reason), fluent)
        return tuple(replace(i, rejected=tuple(r for r in i.rejected if r != self._without)) for i in found)
