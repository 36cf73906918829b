"""Why a run ended without success, and the changes with which it could go on."""

import math
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

from skolem.reasoner.planning.goals import nearness
from skolem.reasoner.planning.hierarchy import PlanStack
from skolem.reasoner.planning.instances import title
from skolem.reasoner.planning.refusals import IMPOSSIBLE, IN_VAIN, NOT_FOUND, SPENT, UNLIKELY
from skolem.reasoner.planning.regression import Step, regress
from skolem.reasoner.terms import CAP_MICRONATS, Compound, parse_term, prob
from skolem.tools.explain.insight import Insight, Truth, truth
from skolem.tools.explain.objects import Choice
from skolem.tools.explain.plans import planned
from skolem.tools.explain.refusals import Refusal, ruled_out
from skolem.tools.recorded.run import RecordedStep
from skolem.traces.errors import NotRecordedError
from skolem.traces.messages import Decision, Memory, Plan, RunEnd, RunStatus

DOUBTFUL = 0.5
LOWEST_BOUND = 0.01  # a lower bound on a probability is not worth proposing


@dataclass(frozen=True, slots=True)
class Remedy:
    """An obstacle, and the change that would remove it.

    Attributes:
        kind: `goal`, `property`, `threshold`, `expansions`, `plan_changes`, `steps`, `repeats`, `rule`, `geometry`,
            `region` or `failure`.
        finding: The obstacle.
        change: The change that would remove it.
    """

    kind: str
    finding: str
    change: str


@dataclass(frozen=True, slots=True)
class Ending:
    """The end of a run without success.

    Attributes:
        status: The recorded status.
        reason: The recorded reason.
        remedies: The obstacles and their remedies, nearest to the goal first.
    """

    status: RunStatus
    reason: str
    remedies: tuple[Remedy, ...]


def ending(
    insight: Insight, choice: Choice, end: RunEnd, after: Memory | None, refused: Sequence[Refusal] = ()
) -> Ending:
    """Return why a run ended.

    Args:
        insight: The mind at the last decision.
        choice: The objects that could be chosen.
        end: The end of the run.
        after: The memory after the end; None if the trace cannot tell.
        refused: The steps that were refused at the last decision.
    """
    found = [*_short_of_the_goal(choice, end), *_properties(insight, choice, end.anchor), *_limits(insight, end)]
    in_vain = _in_vain(insight, after)
    repeats = f"limits.repeats above {insight.given.limits.repeats}, or what keeps it from working"
    for name, count in in_vain.items():
        found.append(Remedy("repeats", f"{name} was done {count} times without doing what it should", repeats))
    if end.status == "goal_unachievable":
        found += [*_threshold(insight), *_impossible(insight, end, refused, in_vain), *_regions(insight)]
    return Ending(end.status, end.reason, tuple(found))


def _short_of_the_goal(choice: Choice, end: RunEnd) -> Iterator[Remedy]:
    """Yield the conjuncts of the goal that are not believed of its closest object."""
    best = next((o for o in choice.options if o.object == end.anchor), None)
    for each in () if best is None else best.fluents:
        if _is_met_otherwise(each, choice):
            continue
        if each.holds is False and each.probability is not None and each.wanted is not None:
            finding = f"the goal asks for {each.fluent}; its closest object has p = {each.probability:.3f}"
            lower = f"a bound of at most {_below(each.probability):g}, or " if each.probability >= LOWEST_BOUND else ""
            yield Remedy("goal", finding, f"{lower}evidence that raises p")


def _is_met_otherwise(fluent: Truth, choice: Choice) -> bool:
    """Return whether the fluent asks for one of several descriptions that another known object satisfies."""
    match parse_term(fluent.fluent):
        case Compound("b", (Compound("den", (str(expression), _)), _)) if len(choice.descriptions) > 1:
            return any(option.denotes.get(expression, 0.0) >= (fluent.wanted or 1.0) for option in choice.options)
    return False


def _properties(insight: Insight, choice: Choice, anchor: str | None) -> Iterator[Remedy]:
    """Yield the property that the nearest object to each description lacks, then other properties that no object has.

    Among equally near objects `anchor` is taken.
    """
    goal = insight.given.goal
    objects = [option.object for option in choice.options if option.exists is not None]
    objects.sort(key=lambda name: name != anchor)
    scope = "all known objects" if goal.variables else "the objects that the goal names"
    has: dict[str, dict[str, float]] = {name: {} for name in objects}
    lacking: set[str] = set()
    for expression, text in goal.expressions.items():
        each = {name: insight.denotations.conjuncts(expression, name, insight.belief) for name in objects}
        each = {name: conjuncts for name, conjuncts in each.items() if conjuncts}
        if not each:
            continue
        nearest, finding = _nearest(insight, each, scope)
        least = min(sorted(each[nearest]), key=each[nearest].__getitem__)
        lacking.add(least)
        if each[nearest][least] < DOUBTFUL:
            finding += f" (meant by {text})" if len(goal.expressions) > 1 else ""
            yield Remedy("property", finding, f"an object that is also {least}, known or found")
        for name, conjuncts in each.items():
            has[name] |= conjuncts
    for word in sorted({word for conjuncts in has.values() for word in conjuncts} - lacking):
        p, name = max((conjuncts[word], name) for name, conjuncts in has.items() if word in conjuncts)
        if p < DOUBTFUL:
            finding = f"of {scope} {name} is the likeliest to be {word}, with p = {p:.3g}"
            yield Remedy("property", finding, f"an object that is {word}, known or found")


def _nearest(insight: Insight, conjuncts: Mapping[str, Mapping[str, float]], scope: str) -> tuple[str, str]:
    """Return the nearest object to a description, and a sentence on it and on the nearest object that a hand can hold.

    Args:
        insight: The mind at the last decision.
        conjuncts: Probability of every property in the description, by object.
        scope: The objects in words.
    """
    near = {name: nearness(found, name, insight.belief) for name, found in conjuncts.items()}

    def described(name: str) -> str:
        return ", ".join(f"{word} {p:.3g}" for word, p in conjuncts[name].items())

    nearest = max(near, key=lambda name: near[name][1:])
    movable = max(near, key=near.__getitem__)
    finding = f"of {scope} {nearest} comes nearest to what is meant: {described(nearest)}"
    if near[movable][0] and not near[nearest][0]:
        finding += f"; of those that a hand can hold {movable}: {described(movable)}"
    return nearest, finding


def _limits(insight: Insight, end: RunEnd) -> Iterator[Remedy]:
    limits = insight.given.limits
    changes = len(insight.recorded.all_of(Plan))
    if end.steps >= limits.steps:
        yield Remedy("steps", f"{end.steps} actions were executed", f"limits.steps above {limits.steps}")
    if changes > limits.plan_changes:
        finding = f"plans changed {changes} times without an action"
        yield Remedy("plan_changes", finding, f"limits.plan_changes above {limits.plan_changes}")
    stopped = [d for d in insight.recorded.all_of(Decision) if not d.plan and d.expansions >= limits.expansions]
    if stopped:
        finding = f"{len(stopped)} of the last searches stopped at {limits.expansions} expansions without a plan"
        yield Remedy("expansions", finding, f"limits.expansions above {limits.expansions}")


def _in_vain(insight: Insight, after: Memory | None) -> dict[str, int]:
    """Return the commands that are not tried again, with the number of their failures.

    The last action is judged at the beginning of the last decision.
    """
    memory, most = after or insight.recorded.memory, insight.given.limits.repeats
    failures = {} if memory is None else memory.failures
    return {title(parse_term(command)): count for command, count in sorted(failures.items()) if count >= most}


def _threshold(insight: Insight) -> Iterator[Remedy]:
    """Yield the plan that would be found if no plan were too unlikely."""
    limits = insight.given.limits
    plans = [f for root in insight.posed.instantiations if (f := planned(insight, root, CAP_MICRONATS)) is not None]
    best = min((found for found in plans if found.steps is not None), key=lambda found: found.cost, default=None)
    if best is None or best.steps is None:
        return
    p = _below(prob(max(best.cost, _dearest(insight, best.steps))))
    if p < limits.min_plan_probability:
        names = "; ".join(title(step.instance.operation) for step in best.steps)
        finding = f"the likeliest plan, refined as far as the trace can tell, has p = {p:g}: {names}"
        yield Remedy("threshold", finding, f"limits.min_plan_probability of at most {p:g}")


def _dearest(insight: Insight, steps: Sequence[Step]) -> int:
    """Return the highest cost of the plans that refine the first step, as far as no new geometric answer is needed."""
    stack, dearest = PlanStack(), 0
    stack.push(steps)
    most, offers = insight.given.limits.expansions, insight.posed.offers
    while (current := stack.current()) is not None and not current.is_concrete:
        try:
            ways = (
                regress((current.subgoal,), offers, stack.level_of, lambda *_: False, most, CAP_MICRONATS, final)
                for final in (current.instance.operation, None)
            )
            found = next((way for way in ways if way.steps), None)
        except NotRecordedError:
            break
        if found is None or found.steps is None:
            break
        dearest = max(dearest, found.cost)
        stack.push(found.steps)
    return dearest


def _below(p: float) -> float:
    """Return a probability above 0, rounded down to two digits."""
    unit = 10.0 ** (math.floor(math.log10(p)) - 1)
    return float(f"{math.floor(p / unit) * unit:.2g}")


def failure(found: RecordedStep, end: RunEnd) -> Ending:
    """Return the end of a run that failed with an error, which is all that is known."""
    done = "the next action could not be decided" if found.action is None else f"{found.action.op} could not be done"
    finding = f"{done}, at step {found.step}: {end.reason.splitlines()[0] if end.reason else 'no reason is recorded'}"
    change = "the rule or value that is named there; other beliefs may pass by it"
    return Ending(end.status, end.reason, (Remedy("failure", finding, change),))


def _impossible(insight: Insight, end: RunEnd, refused: Sequence[Refusal], in_vain: Container[str]) -> Iterator[Remedy]:
    """Yield the steps that rules or costs kept from being refined, and those that could not be executed."""
    objections = {each.op: found for each in refused if (found := ruled_out(insight, each))}
    for op, found in sorted(objections.items()):
        finding = f"{op} has no way to be done that the rules do not refuse: {'; '.join(map(str, found))}"
        yield Remedy("rule", finding, "the rules that are named, or what they ask of the belief")
    said = dict(part.split(": ", 1) for part in end.reason.split("; ") if ": " in part)
    for op in sorted({each.op for each in refused if each.op not in in_vain} - objections.keys()):
        if op in said.get(UNLIKELY, ""):
            floor = f"limits.min_plan_probability below {insight.given.limits.min_plan_probability:g}"
            yield Remedy("threshold", f"{op} has no way to be done that is likely enough", floor)
        elif not any(op in said.get(why, "") for why in (NOT_FOUND, IN_VAIN, SPENT)):  # their remedies stand elsewhere
            finding = f"{op} was {IMPOSSIBLE}"
            yield Remedy(
                "geometry", finding, "a way to do it: other things, another arrangement, or a better known one"
            )
    for answer in insight.recorded.answers:
        if answer.query.startswith("approach") and answer.answer is None:
            finding = f"no way to {answer.query.removeprefix('approach ')}"
            finding += f" was found; {SPENT}, tried {answer.tried} stances" if answer.tried else ""
            yield Remedy("geometry", finding, "a free place within reach for it")


def _regions(insight: Insight) -> Iterator[Remedy]:
    """Yield the regions that are no longer worth a search, if the goal may be about an object that is not met yet."""
    if not insight.given.goal.variables:
        return
    regions = insight.belief.regions()
    if not regions:
        yield Remedy("region", "no region is known that could be searched", "a region in the prior (belief.regions)")
    for region in regions:
        for expression, text in insight.given.goal.expressions.items():
            p = insight.posed.situation.probability(Compound("exists_in", (expression, region)))
            seen = truth(insight, Compound("b", (Compound("contents", (region,)), 0))).probability
            finding = f"{region}: seen {seen:.2f}, p = {p:.2g} that something hidden in it is meant by {text}"
            floor = insight.given.limits.min_plausible
            below = f"below {floor:g} it is not searched, limits.min_plausible"
            least = below if p < floor else "its contents count as known"
            yield Remedy("region", finding, f"an unseen part, or more objects expected there ({least})")
