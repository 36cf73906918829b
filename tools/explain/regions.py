"""Why this region: every region that may hold an object not met yet, with the reasons for and against it."""

from collections.abc import Iterator
from dataclasses import dataclass

from skolem.reasoner.planning.instances import Instance, title
from skolem.reasoner.planning.regression import Found, Subgoal
from skolem.reasoner.terms import CAP_MICRONATS, Compound, Term, nll, prob
from skolem.tools.explain.insight import Insight, mentioned
from skolem.tools.explain.plans import Rival, beaten, planned


@dataclass(frozen=True, slots=True)
class RegionOption:
    """A region where the meant object may be found.

    Attributes:
        region: Its anchor.
        chosen: Whether the plan searches it.
        exists_in: Probability that it holds an object not met yet that satisfies the description, by description.
        cost: Cost of a search for that object, -ln p in micro-nats, for the cheapest description.
        contents: Probability that its contents are known.
        plan: The cheapest plan that searches it, in execution order; empty if there is none.
        probability: Probability of that plan; None if there is none.
        rejected: Why it was not chosen; empty if it was.
    """

    region: str
    chosen: bool
    exists_in: dict[str, float]
    cost: int
    contents: float
    plan: tuple[str, ...]
    probability: float | None
    rejected: str


def region_options(insight: Insight, root: Subgoal, chosen: Found | None, rival: Rival) -> tuple[RegionOption, ...]:
    """Return every region for a reading of the goal about an object not met yet, the likeliest first.

    Args:
        insight: The mind that chose.
        root: The reading.
        chosen: The chosen plan; None if it is of another reading, or there is none.
        rival: The chosen plan, with which other plans are compared.
    """
    wanted = dict(_wanted(root))
    options = [_option(insight, region, root, wanted, chosen, rival) for region in insight.belief.regions()]
    return tuple(sorted(options, key=lambda o: (not o.chosen, -(o.probability or 0.0), o.cost, o.region)))


def _wanted(root: Subgoal) -> Iterator[tuple[str, int]]:
    """Yield every description that an object not met yet has to satisfy, with the bound in micro-nats."""
    for fluent in sorted(root, key=str):
        match fluent:
            case Compound("b", (Compound("den", (str(expression), Compound("sk", _))), int(p))):
                yield expression, p


def _option(
    insight: Insight,
    region: str,
    root: Subgoal,
    wanted: dict[str, int],
    chosen: Found | None,
    rival: Rival,
) -> RegionOption:
    situation = insight.posed.situation
    p = {e: situation.probability(Compound("exists_in", (e, region))) for e in wanted}
    contents = insight.belief.prob_contents(region)
    is_chosen = chosen is not None and chosen.steps is not None and region in _searched(chosen)
    why = _not_searchable(p, contents, wanted, insight.given.limits.min_plausible)
    found = None if why else chosen if is_chosen else _by_way_of(insight, region, root)
    if not why and not is_chosen:
        why = _not_chosen(insight, found, rival)
    known = found is not None and found.steps is not None
    return RegionOption(
        region=region,
        chosen=is_chosen,
        exists_in=p,
        cost=min((min(nll(each), CAP_MICRONATS) for each in p.values()), default=0),
        contents=contents,
        plan=tuple(title(s.instance.operation) for s in found.steps or ()) if found is not None else (),
        probability=prob(found.cost) if found is not None and known else None,
        rejected="" if is_chosen else why,
    )


def _searched(found: Found) -> set[str]:
    return {name for step in found.steps or () for name in mentioned(step.instance.operation)}


def _by_way_of(insight: Insight, region: str, root: Subgoal) -> Found | None:
    """Return the cheapest plan without another region, even if it is unlikely."""
    others = set(insight.belief.regions()) - {region}

    def elsewhere(instance: Instance, _level: int) -> bool:
        operation: Term = instance.operation
        return bool(mentioned(operation) & others)

    return planned(insight, root, CAP_MICRONATS, elsewhere)


def _not_searchable(p: dict[str, float], contents: float, wanted: dict[str, int], least: float) -> str:
    """Return why no rule offers a search of a region; empty if one does, by the conditions of @searchable."""
    likeliest = max(p.values(), default=0.0)
    if likeliest < least:
        return f"implausible: p = {likeliest:.2g} that such a thing is in it, below {least:g} (limits.min_plausible)"
    bound = max((prob(c) for c in wanted.values()), default=1.0)
    if contents >= bound:
        return f"what it holds is known, with p = {contents:.2f}"
    return ""


def _not_chosen(insight: Insight, found: Found | None, rival: Rival) -> str:
    if found is None:
        return "the trace does not tell: a question to the geometry was not asked in the run"
    if found.steps is None:
        return "no plan that searches it" if found.exhausted else "no plan within limits.expansions that searches it"
    limits = insight.given.limits
    if prob(found.cost) < limits.min_plan_probability:
        least = f"below {limits.min_plan_probability:g} (limits.min_plan_probability)"
        return f"its best plan has p = {prob(found.cost):.2g}, {least}"
    return beaten(insight, found, rival)
