"""Why this object: the chosen one and every other known anchor, with the reasons for and against it."""

import itertools
from dataclasses import dataclass

from skolem.reasoner.planning.instances import title
from skolem.reasoner.planning.regression import Found, Subgoal
from skolem.reasoner.terms import CAP_MICRONATS, Compound, Term, compound, nll, parse_term, prob, substitute
from skolem.tools.explain.gaps import Gap, gaps
from skolem.tools.explain.insight import Insight, Truth, truth
from skolem.tools.explain.plans import Rival, beaten, planned
from skolem.tools.explain.refusals import Refused
from skolem.tools.explain.regions import RegionOption, region_options
from skolem.traces.messages import Decision

MOST_BINDINGS = 10_000  # with more bindings of several variables, they are not listed one by one


@dataclass(frozen=True, slots=True)
class Option:
    """An object that the goal may be about.

    Attributes:
        object: Its anchor; `sk(var(o))` for an object that was not met yet.
        chosen: Whether the plan is about it.
        denotes: Probability that it is meant, by description.
        exists: Probability that it exists; None for an object not met yet.
        conjuncts: Probability of each property in the descriptions.
        fluents: The truth of each conjunct of the goal for this object.
        plan: The cheapest plan, in execution order; empty if there is none.
        probability: Probability of that plan; None if there is none.
        rejected: Why it was not chosen; empty if it was.
        refused: The first steps that the search refused, with the reasons.
        regions: Every region where an object not met yet may be found; empty for a known one.
    """

    object: str
    chosen: bool
    denotes: dict[str, float]
    exists: float | None
    conjuncts: dict[str, float]
    fluents: tuple[Truth, ...]
    plan: tuple[str, ...]
    probability: float | None
    rejected: str
    refused: tuple[str, ...] = ()
    regions: tuple[RegionOption, ...] = ()


@dataclass(frozen=True, slots=True)
class Choice:
    """The choice of an object.

    Attributes:
        step: The decision at which it was made.
        descriptions: The descriptions behind the constants e1, e2, ..
        options: The chosen one first, then by the probability of being meant.
        gaps: Where the two evaluations of a description differ.
    """

    step: int
    descriptions: dict[str, str]
    options: tuple[Option, ...]
    gaps: tuple[Gap, ...] = ()


def choice(insight: Insight, subgoal: tuple[str, ...], refused: Refused) -> Choice:
    """Return the options at the decision at which a plan for `subgoal` was made; if that is empty, none was chosen.

    Args:
        insight: The mind that chose.
        subgoal: The recorded subgoal of the plan.
        refused: The steps that the mind refused.
    """
    goal = insight.given.goal
    chosen = frozenset(map(parse_term, subgoal))
    worst = nll(insight.given.limits.min_plan_probability)
    found = {root: planned(insight, root, worst) for root in insight.posed.instantiations}
    sought = bool(insight.recorded.all_of(Decision))
    rival = Rival(bool(chosen), _cost(insight, chosen, found, refused), refused, sought)
    options = [_option(insight, name, roots, chosen, found, rival) for name, roots in _candidates(insight)]
    options.sort(key=lambda o: (not o.chosen, -(sum(o.denotes.values())), o.object))
    said = {name: str(text) for name, text in goal.expressions.items()}
    return Choice(insight.step, said, tuple(options), gaps(goal, insight.given.rulebook, insight.belief))


def _cost(insight: Insight, chosen: Subgoal, found: dict[Subgoal, Found | None], refused: Refused) -> int | None:
    """Return the cost of the chosen plan, which has no refused step; None if none was chosen."""
    plan = found.get(chosen)
    if plan is None or plan.steps is None:
        return None
    if any(refused.forbids(step.instance, step.level) for step in plan.steps):
        other = planned(insight, chosen, nll(insight.given.limits.min_plan_probability), refused.forbids)
        plan = other if other is not None and other.steps is not None else plan
    return plan.cost


def _candidates(insight: Insight) -> list[tuple[Term, list[Subgoal]]]:
    """Return every object with the readings of the goal that are about it."""
    goal = insight.given.goal
    anchors: tuple[Term, ...] = insight.posed.situation.anchors()
    variables: list[Term] = [compound("var", name) for name in goal.variables]
    if not variables:
        names = [a for a in anchors if any(str(a) in str(fluent) for fluent in goal.fluents)]
        return [(name, [frozenset(goal.fluents)]) for name in names]
    choices: list[tuple[Term, ...]] = [(*anchors, compound("sk", variable)) for variable in variables]
    if len(anchors) ** len(variables) > MOST_BINDINGS:
        choices = [choices[0], *(each[-1:] for each in choices[1:])]
    found: dict[Term, list[Subgoal]] = {}
    for binding in itertools.product(*choices):
        root = frozenset(substitute(f, dict(zip(variables, binding, strict=True))) for f in goal.fluents)
        found.setdefault(binding[0], []).append(root)
    return list(found.items())


def _option(
    insight: Insight,
    name: Term,
    roots: list[Subgoal],
    chosen: Subgoal,
    found: dict[Subgoal, Found | None],
    rival: Rival,
) -> Option:
    offered = [root for root in roots if root in found]
    plans = [f for root in offered if (f := found[root]) is not None]
    plan = min((f for f in plans if f.steps is not None), key=lambda f: f.cost, default=None)
    is_chosen = chosen in roots
    root = chosen if is_chosen else (offered or roots)[0]
    known = isinstance(name, str)
    denotes = {e: insight.denotations.probability(e, str(name), insight.belief) for e in insight.given.goal.expressions}
    conjuncts: dict[str, float] = {}
    for expression in insight.given.goal.expressions if known else ():
        conjuncts |= insight.denotations.conjuncts(expression, str(name), insight.belief)
    return Option(
        object=str(name),
        chosen=is_chosen,
        denotes=denotes if known else {},
        exists=insight.belief.prob_exists(str(name)) if known else None,
        conjuncts=conjuncts,
        fluents=tuple(truth(insight, fluent) for fluent in sorted(root, key=str)),
        plan=() if plan is None else tuple(title(s.instance.operation) for s in plan.steps or ()),
        probability=None if plan is None else prob(plan.cost),
        rejected="" if is_chosen else _why_not(insight, name, offered, plans, plan, rival),
        refused=tuple(f"{c.op}: {c.rejected}" for f in plans[:1] for c in f.candidates if c.rejected),
        regions=() if known else region_options(insight, root, plan if is_chosen else None, rival),
    )


def _why_not(
    insight: Insight,
    name: Term,
    offered: list[Subgoal],
    plans: list[Found],
    plan: Found | None,
    rival: Rival,
) -> str:
    if not offered:
        return _not_offered(insight, name)
    if plan is None:
        return _no_plan(insight, name, offered, plans)
    return beaten(insight, plan, rival)


def _no_plan(insight: Insight, name: Term, offered: list[Subgoal], plans: list[Found]) -> str:
    limits = insight.given.limits
    if not plans:
        return "the trace does not tell: a question to the geometry was not asked in the run"
    if any(not found.exhausted for found in plans):
        return f"no plan within {limits.expansions} expansions (limits.expansions)"
    dear = [f for root in offered if (f := planned(insight, root, CAP_MICRONATS)) is not None and f.steps is not None]
    if dear:
        p = prob(min(found.cost for found in dear))
        return f"its best plan has p = {p:.2g}, below {limits.min_plan_probability:g} (limits.min_plan_probability)"
    if isinstance(name, Compound):
        known = insight.belief.regions()
        return "no region that could hold it is left to search" if known else "no region is known that could hold it"
    return "there is no plan for it, however unlikely"


def _not_offered(insight: Insight, name: Term) -> str:
    if isinstance(name, Compound):
        return "no rule offers an object that was not met yet"
    least = min(
        (insight.denotations.probability(e, str(name), insight.belief) for e in insight.given.goal.expressions),
        default=1.0,
    )
    floor = insight.given.limits.min_plausible
    if least < floor:
        return f"implausible: p = {least:.2g} that it is meant, below {floor:g} (limits.min_plausible)"
    return "others are likelier meant, and only the likeliest are considered"
