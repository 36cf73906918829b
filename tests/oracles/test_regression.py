"""The regressor against the reference in plain Python, on generated beliefs: same instances, same plans, same costs."""

import itertools
import math
from collections import Counter
from collections.abc import Iterable

import pytest
from hypothesis import given, strategies as st
from kit.draws import examples
from kit.instance_tables import Table, instance, terms
from kit.minds import TableBelief, Thing
from kit.papers import EXAMPLE_GOAL, posed, shipped
from kit.posed import scenes
from kit.reference import Reference, UnfinishedError, cheapest, offered, regressed
from numpy.random import PCG64, Generator, SeedSequence

from skolem.reasoner.planning.goals import PosedGoal, read_mutexes
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.regression import Found, Subgoal, regress
from skolem.reasoner.terms import Compound, Term, nll, parse_term, prob

DEAREST = nll(1e-4)
MUTEXES = read_mutexes(shipped())
SCENES = 50
LEVELS = (0, 1, 2)
PATIENCE = 60  # conjunctions that the reference looks at
MEANT = ("green", "heavy", "soda")
SKILLS = {  # how likely the robot's own steps succeed, whatever is believed
    "look_region": 0.95,
    "move": 0.97,
    "pick": 0.95,
    "place": 0.95,
    "put": 0.95,
    "remove": 0.9,
    "split": 1.0,
    "weigh": 1.0,
}
WISHES = (
    "holding({x})",
    "held(left,{x})",
    "loose({x})",
    "empty(right)",
    "clear(pick(right,{x}))",
    "bn(pose({x}),any,sd(8,8,any),any,223144)",
    "b(on({x},desk),{p})",
    "b(exists({x}),{p})",
    "b(prop(green,{x}),{p})",
    "b(prop(heavy,{x}),{p})",
    "b(prop(soda,{x}),{p})",
    "b(den(e1,{x}),{p})",
    "b(den(e1,{sk}),{p})",
    "empty(right) & empty(left)",
    "empty(left) & b(on({x},desk),{p})",
    "loose({x}) & b(on({y},desk),{p})",
    "holding({x}) & b(on({y},side),{p})",
    "held(right,{x}) & b(prop(soda,{y}),{p})",
    "holding({y}) & b(prop(heavy,{x}),{p})",
    "b(on({x},desk),{p}) & b(on({y},side),{p})",
    "b(prop(green,{x}),{p}) & b(on({y},side),{p})",
    "b(den(e1,{x}),{p}) & b(on({x},desk),{p})",
    "b(den(e1,{sk}),{p}) & b(on({sk},desk),{p})",
)


def reference(at: PosedGoal) -> Reference:
    return Reference(Queries(at.situation, {"e1": (MEANT,)}))


def accepted(instances: Iterable[Instance]) -> list[Instance]:
    return [instance for instance in instances if not instance.rejected]


class Plain:
    """What the reference offers, each fluent asked about once, and what holds."""

    def __init__(self, at: PosedGoal) -> None:
        self._at, self._reference = at, reference(at)
        self._memo: dict[Term, tuple[Instance, ...]] = {}

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        if fluent not in self._memo:
            self._memo[fluent] = tuple(self._reference.instances(fluent))
        return self._memo[fluent]

    def holds(self, fluent: Term) -> bool:
        return self._at.situation.holds(fluent)


def planned(at: PosedGoal, roots: Iterable[Subgoal], level: int, optimal: bool = False, most: int = 3000) -> Found:
    return regress(tuple(roots), at.offers, lambda _: level, lambda *_: False, most, DEAREST, None, optimal)


def wishes(at: PosedGoal) -> list[tuple[Subgoal, ...]]:
    """Return what might be wanted in a scene and does not hold: one or two fluents, and the example's own goal."""
    movable = [anchor for anchor in at.situation.anchors() if anchor.startswith("o")]
    if not movable:
        return []
    names = {"x": movable[0], "y": movable[-1], "sk": "sk(var(o))", "p": str(nll(0.9))}
    conjunctions = [terms(*(fluent.format(**names) for fluent in wish.split(" & "))) for wish in WISHES]
    return [
        roots for roots in (*((goal,) for goal in conjunctions), at.instantiations) if not any(map(at.holds_all, roots))
    ]


def follow(found: Found, roots: Iterable[Subgoal], plain: Plain, level: int) -> tuple[Subgoal, int]:
    """Return what the reference demands before a plan's steps so that they end in one of the roots, and their price."""
    assert found.steps
    goal, price = found.steps[-1].subgoal, 0
    assert goal in roots
    for step in reversed(found.steps):
        (taken,) = (each for each in offered(goal, plain.offers) if each.step == step.instance.step)
        before = regressed(taken, min(level, taken.concrete), goal, MUTEXES)
        assert before is not None, f"the reference refuses {taken.step}"
        goal, price = before, price + taken.price
    return goal, price


@given(scenes())
@examples(25)
def test_the_rules_give_the_instances_of_the_reference(at: PosedGoal) -> None:
    """Every fluent that regression could come to, thousands in all, and that an object leaves its place."""
    plain, waiting, seen = reference(at), [f for root in at.instantiations for f in root], set[Term]()
    waiting += [parse_term(f"b(off({o},side),105361)") for o in at.situation.anchors()]
    while waiting:
        at.offers.prepare(waiting)
        needs = set[Term]()
        for fluent in waiting:
            found = accepted(at.offers.offers(fluent))
            assert found == plain.instances(fluent), fluent
            needs |= {need for instance in found for need, _ in instance.preconditions}
        seen |= set(waiting)
        waiting = sorted(needs - seen, key=str)


def test_plans_and_costs_of_thousands_of_small_problems_are_those_of_the_reference() -> None:
    """A problem is a scene, a goal that does not hold in it, and a level; rules and search stand against the reference.

    The reference finds the least cost on its own. Then it follows the plan that was found, with its own instances and
    its own regression, to something that holds now. What takes it more than `PATIENCE` conjunctions is not compared.
    """
    compared = solved = given_up = 0

    def compare(at: PosedGoal, plain: Plain, roots: tuple[Subgoal, ...], level: int) -> None:
        nonlocal compared, solved, given_up
        try:
            least = cheapest(roots, plain.offers, plain.holds, MUTEXES, level, DEAREST, PATIENCE)
        except UnfinishedError:
            given_up += 1
            return
        best = planned(at, roots, level, optimal=True)
        compared += 1
        if least is None:
            assert best.steps is None
            assert best.exhausted
            return
        solved += 1
        assert (best.steps is None, best.cost, best.within) == (False, least, 1.0)
        before, price = follow(best, roots, plain, level)
        assert price == least
        assert all(map(plain.holds, before))

    @given(scenes(most=2))
    @examples(SCENES)
    def in_every_scene(at: PosedGoal) -> None:
        plain = Plain(at)
        for roots, level in itertools.product(wishes(at), LEVELS):
            compare(at, plain, roots, level)

    in_every_scene()
    assert compared >= 2000
    assert solved >= 1000
    assert given_up <= compared / 5


@given(scenes())
@examples(25)
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
@examples(2000)
def test_the_optimum_of_any_problem_is_that_of_the_reference(seed: int) -> None:
    table, goal = problem(seed)
    best = regress([goal], table, lambda _: 9, lambda *_: False, 3000, DEAREST, optimal=True)
    least = cheapest([goal], table.offers, table.holds, table.mutexes, 9, DEAREST)
    assert (None if best.steps is None else best.cost) == least


def chance(step: Instance, at: PosedGoal) -> float:
    """Return how likely a step does what is hoped for, by the numbers of the belief and of the robot's skills."""
    belief, meanings = at.situation.belief, at.situation.meanings
    match step.step:
        case Compound("examine", (_, _, str(o), _)):
            return belief.prob_exists(o) * math.prod(belief.prob_property(o, meanings[word]) for word in MEANT)
        case Compound("find", (_, str(region), _, _)):
            return belief.prob_exists_in(
                region, math.prod(belief.prob_property_of_new(meanings[word]) for word in MEANT)
            )
        case Compound("infer", (str(word), str(o), _)):
            reading = belief.prob_favourable(o, meanings[word], 0.9)
            supposed = all(phi.name == "supposed" for phi in map(subject, step.results))
            return reading * (1.0 if supposed else belief.prob_property(o, meanings[word]))
        case Compound("look", _):
            seen = {str(subject(fluent).args[0]) for fluent in step.results}
            return math.prod(belief.prob_detected(o) for o in seen)
        case Compound(kind, _):
            return SKILLS[kind]
    raise AssertionError(f"no step {step.step}")


def subject(fluent: Term) -> Compound:
    """Return what a belief is about: phi of b(phi, p)."""
    assert isinstance(fluent, Compound)
    phi = fluent.args[0]
    assert isinstance(phi, Compound)
    return phi


def test_a_plan_is_as_likely_as_all_its_steps_together() -> None:
    """Each cost is rounded to a millionth, and a step has two at most."""
    kinds = Counter[str]()

    @given(scenes(most=2))
    @examples(20)
    def in_every_scene(at: PosedGoal) -> None:
        for roots, level in itertools.product(wishes(at), LEVELS):
            found = planned(at, roots, level, most=150)
            if found.steps:
                likely = math.prod(chance(step.instance, at) for step in found.steps)
                assert prob(found.cost) == pytest.approx(likely, rel=2e-6 * len(found.steps))
                kinds.update(str(step.instance.step).partition("(")[0] for step in found.steps)

    in_every_scene()
    assert set(kinds) == {*SKILLS, "examine", "find", "infer", "look"}


def test_the_reference_is_not_empty() -> None:
    at = posed(EXAMPLE_GOAL, TableBelief({"desk": Thing({"table": 1.0}), "o1": Thing({"soda": 0.9, "bottle": 0.1})}))
    assert [str(i.step) for i in reference(at).instances(parse_term("holding(o1)"))] == [
        "pick(left,o1)",
        "pick(right,o1)",
    ]
