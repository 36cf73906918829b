"""The regressor against the reference in plain Python, on generated beliefs: same instances, same plans, same costs."""

import math
from collections.abc import Iterable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from minds import Region, TableBelief, TableGeometry, Thing
from numpy.random import PCG64, Generator, SeedSequence
from papers import EXAMPLE_GOAL, posed, shipped
from reference import Reference, cheapest
from test_regression import Table, instance, terms

from skolem.reasoner.goals import PosedGoal, read_mutexes
from skolem.reasoner.instances import Instance
from skolem.reasoner.queries import Queries
from skolem.reasoner.regression import Found, Subgoal, regress
from skolem.reasoner.terms import Term, nll, parse_term, prob

DEAREST = nll(1e-4)
MUTEXES = read_mutexes(shipped())


@st.composite
def scenes(draw: st.DrawFn) -> PosedGoal:
    """A goal posed of a belief in up to four things on two tables, one perhaps in a hand, one in the way of another."""
    share = st.sampled_from([0.05, 0.3, 0.6, 0.9, 0.99])
    things = {name: Thing({"table": 1.0}, pose_sd=draw(st.sampled_from([0.004, 0.03]))) for name in ("desk", "side")}
    movable = [f"o{k + 1}" for k in range(draw(st.integers(1, 4)))]
    for name in movable:
        soda = draw(share)
        things[name] = Thing(
            {"soda": soda, "bottle": 1.0 - soda},
            on=draw(st.sampled_from(["desk", "side"])),
            hsv=(draw(st.sampled_from([0.2, 0.33, 0.6])), 0.8, 0.8),
            hsv_sd=draw(st.sampled_from([0.01, 0.05, 0.2])),
            ln_kg=(math.log(draw(st.sampled_from([0.1, 0.3, 0.5]))), draw(st.sampled_from([0.05, 0.6]))),
            pose_sd=draw(st.sampled_from([0.004, 0.03, 0.08])),
            exists=draw(st.sampled_from([0.6, 0.97, 1.0])),
        )
    if draw(st.booleans()):
        held = things[draw(st.sampled_from(movable))]
        held.on, held.hand = None, draw(st.sampled_from(["right", "left"]))
    regions = {f"_reg{k}_": Region("side", draw(st.floats(0.1, 3.0))) for k in range(draw(st.integers(0, 2)))}
    geometry = TableGeometry()
    if len(movable) > 1 and draw(st.booleans()):
        geometry.in_the_way = {f"pick({hand}, o1)": ("o2",) for hand in ("right", "left")}
    geometry.at = set(draw(st.sampled_from([[], ["look(o1)"], ["pick(right, o1)", "look(o1)"]])))
    return posed(EXAMPLE_GOAL, TableBelief(things, regions), geometry=geometry)


def reference(at: PosedGoal) -> Reference:
    return Reference(Queries(at.situation, {"e1": (("green", "heavy", "soda"),)}))


def accepted(instances: Iterable[Instance]) -> list[Instance]:
    return [instance for instance in instances if not instance.rejected]


class Plain:
    """Offers of the reference; satisfies `regression.Offers`."""

    def __init__(self, at: PosedGoal) -> None:
        self._at, self._reference = at, reference(at)
        self.mutexes = MUTEXES
        self._memo: dict[Term, tuple[Instance, ...]] = {}

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        if fluent not in self._memo:
            self._memo[fluent] = tuple(self._reference.instances(fluent))
        return self._memo[fluent]

    def prepare(self, fluents: Iterable[Term]) -> None:
        del fluents

    def holds(self, fluent: Term) -> bool:
        return self._at.situation.holds(fluent)


def planned(at: PosedGoal, roots: Iterable[Subgoal], level: int, optimal: bool = False, plain: bool = False) -> Found:
    offers = Plain(at) if plain else at.offers
    return regress(tuple(roots), offers, lambda _: level, lambda *_: False, 150, DEAREST, None, optimal)


@given(scenes())
@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
def test_the_rules_give_the_instances_of_the_reference(at: PosedGoal) -> None:
    """Every fluent that regression could come to, thousands in all."""
    plain, waiting, seen = reference(at), [f for root in at.instantiations for f in root], set[Term]()
    while waiting:
        at.offers.prepare(waiting)
        needs = set[Term]()
        for fluent in waiting:
            found = accepted(at.offers.offers(fluent))
            assert found == plain.instances(fluent), fluent
            needs |= {need for instance in found for need, _ in instance.preconditions}
        seen |= set(waiting)
        waiting = sorted(needs - seen, key=str)


@given(scenes())
@settings(max_examples=15, suppress_health_check=[HealthCheck.too_slow])
def test_plans_and_costs_are_those_of_the_reference(at: PosedGoal) -> None:
    for level in (0, 1):
        for optimal in (False, True):
            found = planned(at, at.instantiations, level, optimal)
            expected = planned(at, at.instantiations, level, optimal, plain=True)
            assert (found.steps, found.cost, found.bound) == (expected.steps, expected.cost, expected.bound)


@given(scenes())
@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
def test_the_optimum_is_that_of_a_search_through_every_order_of_every_step(at: PosedGoal) -> None:
    """What is pruned (inferences alone, steps once for many fluents) costs nothing; the default keeps to its bound."""
    plain = Plain(at)
    least = cheapest(at.instantiations, plain.offers, plain.holds, MUTEXES, 0, DEAREST)
    best, usual = planned(at, at.instantiations, 0, optimal=True), planned(at, at.instantiations, 0)
    assert best.exhausted
    assert (None if best.steps is None else best.cost) == least
    if usual.steps is not None and least is not None:
        assert usual.bound <= least <= usual.cost
        assert usual.within is None or usual.cost <= usual.within * least * (1 + 1e-12)
    assert best.steps is None or best.within == 1.0


def problem(seed: int) -> tuple[Table, Subgoal]:
    """Return up to six steps among six fluents, with what holds and what is wanted."""
    draw = Generator(PCG64(SeedSequence(seed)))

    def some(least: int, most: int) -> list[str]:
        return [f"f{k}" for k in draw.permutation(6)[: draw.integers(least, most + 1)]]

    steps = []
    for k in range(draw.integers(2, 7)):
        results, needs, loses = some(1, 2), some(0, 2), some(0, 1)
        preconditions = [(need, 0) for need in needs if need not in results]
        steps.append(instance(f"s{k}", results, preconditions, 1 - k / 10, [f for f in loses if f not in results]))
    return Table(steps, some(0, 3)), terms(*some(1, 3))


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=2000)
def test_the_optimum_of_any_problem_is_that_of_the_reference(seed: int) -> None:
    table, goal = problem(seed)
    best = regress([goal], table, lambda _: 9, lambda *_: False, 3000, DEAREST, optimal=True)
    least = cheapest([goal], table.offers, table.holds, table.mutexes, 9, DEAREST)
    assert (None if best.steps is None else best.cost) == least


@pytest.mark.parametrize("level", [0, 1])
@given(at=scenes())
@settings(max_examples=15, suppress_health_check=[HealthCheck.too_slow])
def test_a_plan_is_as_likely_as_all_its_steps_together(at: PosedGoal, level: int) -> None:
    found = planned(at, at.instantiations, level)
    chances = [prob(cost) for step in found.steps or () for _, cost in step.instance.costs]
    assert found.steps is None or prob(found.cost) == pytest.approx(math.prod(chances), rel=1e-9)


def test_the_reference_is_not_empty() -> None:
    at = posed(EXAMPLE_GOAL, TableBelief({"desk": Thing({"table": 1.0}), "o1": Thing({"soda": 0.9, "bottle": 0.1})}))
    assert [str(i.step) for i in reference(at).instances(parse_term("holding(o1)"))] == [
        "pick(left,o1)",
        "pick(right,o1)",
    ]
