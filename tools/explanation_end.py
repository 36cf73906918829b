"""Why a run ended without success, and what would have to change for it to go on."""

import math
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass

from skolem.reasoner.goals import nearness
from skolem.reasoner.hierarchy import PlanStack
from skolem.reasoner.instances import title
from skolem.reasoner.regression import Step, regress
from skolem.reasoner.terms import CAP_MICRONATS, Compound, parse_term, prob
from skolem.tools.explanation import Insight, truth
from skolem.tools.explanation_objects import Choice
from skolem.tools.explanation_plans import IMPLAUSIBLE, planned
from skolem.tools.recalled_geometry import NotRecordedError
from skolem.traces.fluents import readable
from skolem.traces.messages import Decision, Memory, Plan, RunEnd

UNLIKELY = 0.5


@dataclass(frozen=True, slots=True)
class Remedy:
    """Something that stood in the way, and what would remove it.

    Attributes:
        kind: `goal`, `property`, `threshold`, `expansions`, `plan_changes`, `steps`, `repeats`, `geometry` or `region`.
        finding: What stood in the way.
        change: What would have to be otherwise.
    """

    kind: str
    finding: str
    change: str


@dataclass(frozen=True, slots=True)
class Ending:
    """The end of a run without success.

    Attributes:
        status: As the trace has it.
        reason: As the robot put it.
        remedies: What stood in the way, nearest to the goal first.
    """

    status: str
    reason: str
    remedies: tuple[Remedy, ...]


def ending(insight: Insight, choice: Choice, end: RunEnd, after: Memory | None) -> Ending:
    """Return why a run ended.

    Args:
        insight: The mind at the last decision.
        choice: The objects there were to choose.
        end: How the run ended.
        after: What was remembered when it had ended; None if the trace cannot tell.
    """
    found = [*_short_of_the_goal(choice, end), *_properties(insight, choice), *_limits(insight, end)]
    in_vain = _in_vain(insight, after)
    repeats = f"limits.repeats above {insight.given.limits.repeats}, or what keeps it from working"
    for name, count in in_vain.items():
        found.append(Remedy("repeats", f"{name} was done {count} times without doing what it should", repeats))
    if end.status == "goal_unachievable":
        found += [*_threshold(insight), *_impossible(insight, in_vain), *_regions(insight)]
    return Ending(end.status, end.reason, tuple(found))


def _short_of_the_goal(choice: Choice, end: RunEnd) -> Iterator[Remedy]:
    """The conjuncts of the goal that its closest object falls short of."""
    best = next((o for o in choice.options if o.object == end.anchor), None)
    for each in () if best is None else best.fluents:
        if each.holds is False and each.probability is not None and each.wanted is not None:
            finding = f"the goal asks for {readable(each.fluent)}; its closest object has p = {each.probability:.3f}"
            yield Remedy("goal", finding, f"a bound of at most {each.probability:.3f}, or evidence that raises p")


def _properties(insight: Insight, choice: Choice) -> Iterator[Remedy]:
    """How near the nearest of the known objects comes to what is meant, and further properties that none has."""
    known = [option for option in choice.options if option.conjuncts and option.exists is not None]
    lacking = ""
    if known:
        nearest = max(known, key=lambda option: nearness(option.conjuncts, option.object, insight.belief))
        lacking = min(sorted(nearest.conjuncts), key=nearest.conjuncts.__getitem__)
        has = ", ".join(f"{word} {p:.3g}" for word, p in nearest.conjuncts.items())
        finding = f"of all known objects {nearest.object} comes nearest to what is meant: {has}"
        if nearest.conjuncts[lacking] < UNLIKELY:
            yield Remedy("property", finding, f"an object that is {lacking} besides would have to be known or found")
    for word in sorted({word for option in known for word in option.conjuncts} - {lacking}):
        p, name = max((o.conjuncts[word], o.object) for o in known if word in o.conjuncts)
        if p < UNLIKELY:
            finding = f"of all known objects {name} is the likeliest to be {word}, with p = {p:.3g}"
            yield Remedy("property", finding, f"an object that is {word} would have to be known or found")


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
    """Return the actions that are not tried again, with how often they did not do what they should.

    The one that was done last is judged at the beginning of the last decision.
    """
    before, most = insight.recorded.memory, insight.given.limits.repeats
    if before is None:
        return {}
    done = {step: step for step, count in before.failures.items() if count >= most}
    done |= {} if before.executed is None else {before.executed.instance: before.executed.called}
    failures = (after or before).failures
    often = {step: count for step, count in sorted(failures.items()) if step in done and count >= most}
    return {title(parse_term(done[step])): count for step, count in often.items()}


def _threshold(insight: Insight) -> Iterator[Remedy]:
    """The plan that would be found if no plan were too unlikely."""
    limits = insight.given.limits
    plans = [f for root in insight.posed.instantiations if (f := planned(insight, root, CAP_MICRONATS)) is not None]
    best = min((found for found in plans if found.steps is not None), key=lambda found: found.cost, default=None)
    if best is None or best.steps is None:
        return
    p = _below(prob(max(best.cost, _dearest(insight, best.steps))))
    if p < limits.min_plan_probability:
        names = "; ".join(title(step.instance.called) for step in best.steps)
        finding = f"the likeliest plan, refined as far as the trace can tell, has p = {p:g}: {names}"
        yield Remedy("threshold", finding, f"limits.min_plan_probability of at most {p:g}")


def _dearest(insight: Insight, steps: Sequence[Step]) -> int:
    """Return the cost of the dearest plan that refines the first step, down to where geometry would be asked anew."""
    stack, dearest = PlanStack(), 0
    stack.push(steps)
    most, offers = insight.given.limits.expansions, insight.posed.offers
    while (current := stack.current()) is not None and not current.is_concrete:
        try:
            ways = (
                regress((current.subgoal,), offers, stack.level_of, lambda *_: False, most, CAP_MICRONATS, final)
                for final in (current.instance.called, None)
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
    """Return the next smaller number of two digits."""
    unit = 10.0 ** (math.floor(math.log10(p)) - 1)
    return float(f"{math.floor(p / unit) * unit:.2g}")


def _impossible(insight: Insight, in_vain: Container[str]) -> Iterator[Remedy]:
    """Steps that could not be refined or executed in the believed world."""
    names = {n for p in insight.recorded.all_of(Plan) if p.cause == "refused" for n in p.false_fluents}
    for name in sorted(names - {name for name in names if title(parse_term(name)) in in_vain}):
        finding = f"{title(parse_term(name))} was found impossible in the believed world"
        yield Remedy("geometry", finding, "a way to do it: other things, another arrangement, or a better known one")
    for answer in insight.recorded.answers:
        if answer.query.startswith("approach") and answer.answer is None:
            finding = f"no way to {answer.query.removeprefix('approach ')}"
            yield Remedy("geometry", finding, "a free place within reach for it")


def _regions(insight: Insight) -> Iterator[Remedy]:
    """Regions that are not worth a search any more, if the goal could be about something that was not met yet."""
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
            least = f"below {IMPLAUSIBLE:g} it is not searched" if p < IMPLAUSIBLE else "its contents count as known"
            yield Remedy("region", finding, f"an unseen part, or more objects expected there ({least})")
