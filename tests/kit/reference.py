"""The reference regressor: a second version of rule instances and search, in plain Python, for small problems.

It shares only the terms, the fluents' relations (`patterns`) and the belief queries with the product. It has no rule
file, no clingo, no order among equals, and remembers nothing but the steps that it took back before. It is slow and
short on purpose.
"""

import heapq
import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, lru_cache

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.patterns import Mutexes, entails
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.regression import Subgoal
from skolem.reasoner.terms import ANY, Compound, Term, compound, matches, parse_term

SURE, LIKELY, PATIENCE, ROUNDING = 223_144, 693_147, 693_147, 3
SLIP = LANDING = OVERLOOKED = 51_293
DRIFT, STILL_BLOCKED = 30_459, 105_361
HANDS = ("right", "left")
MEASURES = {"soda": "type", "bottle": "type", "carton": "type", "green": "colour", "heavy": "weight"}
Need = tuple[Term, int]


@cache
def t(text: str, **terms: Term) -> Term:
    """Return the term written in `text`, with each {name} replaced."""
    return parse_term(text.format(**{name: str(term) for name, term in terms.items()}))


def edges(support: Term) -> Term:
    return t("bn(pose({s}),any,sd(20,20,40),any,{p})", s=support, p=SURE)


class Reference:
    """Rule instances of one situation."""

    def __init__(self, queries: Queries) -> None:
        self.q = queries

    def instances(self, fluent: Term) -> list[Instance]:
        """Return every instance that achieves a fluent and that no rule rejects, sorted by text."""
        return sorted(self._all(fluent), key=lambda i: str(i.step))

    def _all(self, fluent: Term) -> Iterator[Instance]:
        match fluent:
            case Compound("b", (Compound("den", (str(e), o)), int(p))):
                yield from self._examine(fluent, e, o, p) if self.q.rigid(o) else self._find(fluent, e, o, p)
            case Compound("b", (Compound("holds", (Compound("", words), o)), int(p))):
                step = compound("split", compound("", *words), o, p)
                needs = [(t("b(supposed({k},{o}),{p})", k=k, o=o, p=(p - len(words)) // len(words)), 0) for k in words]
                yield self._made(step, [fluent], needs, immediate=True)
            case Compound("b", (Compound("supposed" | "prop" as kind, (str(k), o)), int(p))):
                yield from self._infer(fluent, kind, k, o, p)
            case Compound("b", (Compound("type" | "exists", (o, *_)), _)) if not self.q.rigid(o):
                yield self._look(o, fluent, o, [])
            case Compound("bn", (Compound("colour" | "pose", (o,)), _, _, _, _)) if not self.q.rigid(o):
                yield self._look(o, fluent, o, [])
            case Compound("bn", (Compound("weight", (o,)), _, _, _, _)) if not self.q.rigid(o):
                needs = [(compound("krd", o), 0), (compound("held", "right", o), 1)]
                yield self._made(compound("weigh", o), [fluent], needs, executes=compound("weigh", o))
            case Compound("b", (Compound("type", (str(o), str(k))), int(p))):
                yield self._look(
                    o, fluent, o, [(t("b(type({o},{k}),{p})", o=o, k=k, p=self.q.before_reading(o, k, p)), 0)]
                )
            case Compound("b", (Compound("exists", (str(o),)), _)):
                yield self._look(o, fluent, o, [])
            case Compound("bn", (Compound("colour" | "pose" as quantity, (str(o),)), _, _, _, _)):
                for seen in {o, *(self.q.standing_on(o) if quantity == "pose" else ())}:
                    if self._count(fluent) is not None:
                        yield self._look(seen, fluent, o, self._earlier(fluent, quantity, o))
            case Compound("bn", (Compound("weight", (str(o),)), _, _, _, _)) if self.q.graspable(o):
                needs = [(compound("krd", o), 0), (compound("held", "right", o), 1)]
                if self._count(fluent) is not None:
                    yield self._made(compound("weigh", o), [fluent], needs, executes=compound("weigh", o))
            case Compound("b", (Compound("contents", (r,)), _)):
                step = compound("look_region", r)
                name, needs = compound("look_at_region", r), [(compound("at", step), 1)]
                yield self._made(step, [fluent], needs, {"overlooked": OVERLOOKED}, operation=name, executes=step)
            case Compound("clear", (activity,)):
                yield from self._remove(fluent, activity)
            case Compound("at", (activity,)):
                yield self._move(fluent, activity)
            case Compound("holding", (o,)) if self.q.rigid(o):
                yield from self._picks(str(o), HANDS)
            case Compound("held", (str(hand), o)) if hand in HANDS and self.q.rigid(o):
                yield from self._picks(str(o), [hand])
            case _:
                yield from self._places(fluent)

    def _examine(self, fluent: Term, e: str, o: Term, p: int) -> Iterator[Instance]:
        anchor, present = str(o), int(str(self.q.present(e, str(o))))
        doubt = int(str(self.q.doubt(anchor)))
        exists = 2 * doubt if 4 * doubt <= p else p // 2
        rest = p - exists - ROUNDING
        for props in self.q.props_for(e, anchor, rest):
            assert isinstance(props, Compound)
            portion = int(str(self.q.portion(e, props, anchor, rest)))
            needs: list[Need] = [(t("b(den({e},{o}),{p})", e=e, o=o, p=present + PATIENCE), 0)]
            needs += [(t("b(holds({w},{o}),{p})", w=props, o=o, p=portion), 1)]
            needs += [(t("b(holds({w},{o}),{p})", w=w, o=o, p=rest - portion), 1) for w in self.q.settled(e, props)]
            needs += [(t("b(exists({o}),{p})", o=o, p=exists), 1)]
            name, results = compound("examine_obj", e, o), [fluent, compound("krd", o)]
            costs = {"prior_of_description": present}
            yield self._made(compound("examine", e, props, o, p), results, needs, costs, operation=name)

    def _find(self, fluent: Term, e: str, o: Term, p: int) -> Iterator[Instance]:
        if not isinstance(o, Compound):
            return
        for found in self.q.searchable(e, p):
            assert isinstance(found, Compound)
            region, cost = found.args
            needs = [(t("b(exists_in({e},{r}),{c})", e=e, r=region, c=cost), 0)]
            needs += [(t("b(contents({r}),{p})", r=region, p=p), 1)]
            name, results = compound("find_obj", e, region, o), [fluent, compound("krd", o)]
            costs = {"prior_of_existence": int(str(cost))}
            yield self._made(compound("find", e, region, o, p), results, needs, costs, operation=name)

    def _infer(self, fluent: Term, kind: str, k: str, o: Term, p: int) -> Iterator[Instance]:
        if not self.q.rigid(o):
            return
        anchor, costs = str(o), {"unfavourable_reading": int(str(self.q.favourable(k, str(o), p)))}
        if kind == "prop":
            costs["prior_of_property"] = self.q.believed(k, anchor)
        needs: list[Need] = [(compound("krd", o), 0)]
        if MEASURES[k] == "type":
            needs += [(t("b(type({o},{k}),{p})", o=o, k=k, p=p), 0)]
        else:
            bands = self.q.band(k, anchor, p)
            if not bands:
                return
            assert isinstance(bands[0], Compound)
            mean, sd, tol = bands[0].args
            bound = t("bn({q}({o}),{m},{v},{d},{p})", q=MEASURES[k], o=o, m=mean, v=sd, d=tol, p=LIKELY)
            needs += [(bound, 0)]
        name = compound("infer", k, o)
        yield self._made(compound("infer", k, o, p), [fluent], needs, costs, operation=name, immediate=True)

    def _look(self, seen: Term, fluent: Term, about: Term, more: list[Need]) -> Instance:
        step = compound("look", seen)
        needs: list[Need] = [(compound("krd", seen), 0), (compound("loose", seen), 0)]
        needs += [(compound("clear", step), 1), (compound("at", step), 1), *more]
        missed = int(str(self.q.detected(str(about)))) if self.q.rigid(about) else 0
        costs = {f"missed({about})": missed} if self.q.rigid(about) else {}
        count = (self.q.rigid(about) and self._count(fluent)) or 1
        if count > 1:
            costs[f"missed_again({about})"] = (count - 1) * missed
        return self._made(step, [fluent], needs, costs, operation=compound("look_at", seen), executes=step)

    def _count(self, fluent: Term) -> int | None:
        """Return the number of looks or weighings in one step: 1 for a pose, None if there is none."""
        match fluent:
            case Compound("bn", (Compound("colour" | "weight" as quantity, (str(o),)), mean, sigma, delta, _)):
                found = self.q.observations(quantity, o, mean, sigma, delta)
                return int(str(found[0])) if found else None
        return 1

    def _earlier(self, fluent: Term, quantity: str, o: str) -> list[Need]:
        assert isinstance(fluent, Compound)
        phi, mean, sigma, _, p = fluent.args
        before = self.q.before_look(quantity, o, sigma) if quantity == "pose" else ANY
        return [] if before == ANY else [(Compound("bn", (phi, mean, before, ANY, p)), 0)]

    def _remove(self, fluent: Term, activity: Term) -> Iterator[Instance]:
        blockers = self.q.blockers(activity)
        if blockers:
            needs = [(compound("aside", o, activity), 0) for o in blockers]
            step, name = compound("remove", activity), compound("remove_obst", activity)
            yield self._made(step, [fluent], needs, {"still_blocked": STILL_BLOCKED}, operation=name, immediate=True)

    def _move(self, fluent: Term, activity: Term) -> Instance:
        step, results = compound("move", activity), [fluent]
        match activity:
            case Compound("pick", (_, o)):
                results.append(compound("at", compound("look", o)))
            case Compound("place", (_, s, _)):
                results.append(compound("at", compound("look", s)))
        loses = ["at(any)", "bn(pose(any),any,sd(under(50),any,any),any,any)"]
        return self._made(step, results, [], {"ends_elsewhere": DRIFT}, destroys=map(parse_term, loses), executes=step)

    def _picks(self, o: str, hands: Iterable[str]) -> Iterator[Instance]:
        if not self.q.graspable(o):
            return
        yaw: Term = 150 if self.q.yaw_observable(o) else ANY
        for hand in hands:
            step = compound("pick", hand, o)
            needs: list[Need] = [(compound("krd", o), 0), (compound("clear", step), 2)]
            needs += [(compound("empty", each), 1) for each in HANDS]
            needs += [(t("bn(pose({o}),any,sd(50,50,any),any,{p})", o=o, p=SURE), 1)]
            needs += [(t("bn(pose({o}),any,sd(8,8,{y}),any,{p})", o=o, y=yaw, p=SURE), 3), (compound("at", step), 3)]
            needs += [(edges(support), 3) for support in self.q.support_of(o)]
            loses = [compound("empty", hand), compound("loose", o), t("b(on({o},any),any)", o=o)]
            loses += [t("aside({o},any)", o=o)]
            results = [compound("holding", o), compound("held", hand, o)]
            name = compound("pick", o)
            yield self._made(step, results, needs, {"slips": SLIP}, destroys=loses, operation=name, executes=step)

    def _places(self, fluent: Term) -> Iterator[Instance]:
        match fluent:
            case Compound("b", (Compound("on", (o, s)), _)):
                yield from self._place("place", None, o, s, "nothing", [fluent], errand=False)
            case Compound("b", (Compound("off", (o, left)), _)):
                for s in self.q.supports():
                    if s != left:
                        yield from self._place("place", None, o, s, "nothing", [fluent])
            case Compound("empty", (str(hand),)):
                for o, s in itertools.product(self.q.in_hand(hand), self.q.supports()):
                    yield from self._place("place", None, o, s, "nothing", [fluent])
            case Compound("loose", (o,)):
                for s in self.q.supports():
                    yield from self._place("place", None, o, s, "nothing", [fluent])
            case Compound("aside", (o, activity)):
                for hand, s in itertools.product(HANDS, self.q.supports()):
                    yield from self._place("put", hand, o, s, activity, [fluent, compound("empty", hand)])

    def _place(
        self,
        kind: str,
        hand: str | None,
        o: Term,
        s: Term,
        activity: Term,
        results: Sequence[Term],
        errand: bool = True,
    ) -> Iterator[Instance]:
        if (self.q.rigid(o) and not self.q.graspable(str(o))) or self.q.graspable(str(s)):
            return
        executes = compound("place", o, s, activity)
        step = executes if hand is None else compound(kind, hand, o, s, activity)
        needs: list[Need] = [(compound("krd", o), 0), (compound("holding", o), 1)]
        if hand is not None:
            needs = [(compound("krd", o), 0), (compound("held", hand, o), 1)]
            needs += [(compound("aside", other, activity), 0) for other in self._in_front(hand, o, activity)]
        if self.q.rigid(o) and not self.q.room(str(o), str(s)):
            return
        if self.q.rigid(o) and activity == "nothing" and not errand:
            needs.append((compound("clear", executes), 1))
        needs += [(edges(s), 2), (compound("at", executes), 2)]
        loses = ["holding({o})", "held(any,{o})", "b(on({o},any),any)", "bn(pose({o}),any,any,any,any)"]
        costs = {"lands_elsewhere": LANDING}
        if errand:
            costs["way"] = 10 * int(str(self.q.distance(str(s))))
        yield self._made(
            step,
            [*results, compound("loose", o)],
            needs,
            costs,
            destroys=[*(t(lost, o=o) for lost in loses), t("b(off({o},{s}),any)", o=o, s=s)],
            operation=compound("place", o, s),
            executes=executes,
        )

    def _in_front(self, hand: str, o: Term, activity: Term) -> list[Term]:
        """Return the blockers of an activity that stand before `o`, without those that `o` stands before in turn."""
        row = self.q.blockers(activity)
        before = {
            each: [x for x in self.q.blockers(compound("pick", hand, each)) if x in row and x != each] for each in row
        }

        def leads(start: Term) -> set[Term]:
            reached, queue = set[Term](), [start]
            while queue:
                fresh = [x for x in before[queue.pop()] if x not in reached]
                reached.update(fresh)
                queue += fresh
            return reached

        return [x for x in before.get(o, []) if o not in leads(x)] if len(row) > 1 else []

    @staticmethod
    def _made(
        step: Term,
        results: Iterable[Term],
        needs: Iterable[Need],
        costs: dict[str, int] | None = None,
        destroys: Iterable[Term] = (),
        operation: Term | None = None,
        executes: Term | None = None,
        immediate: bool = False,
    ) -> Instance:
        priced = frozenset((parse_term(reason), cost) for reason, cost in (costs or {}).items())
        name = step if operation is None else operation
        return Instance(
            step,
            name,
            priced,
            frozenset(results),
            frozenset(needs),
            frozenset(destroys),
            executes,
            immediate,
        )


# ---------------------------------------------------------------- the search


class UnfinishedError(Exception):
    """The search was given up."""


def offered(goal: Subgoal, instances: Callable[[Term], Sequence[Instance]]) -> list[Instance]:
    """Return every step that achieves some fluent of a conjunction, once with all its results."""
    found: dict[Term, Instance] = {}
    for instance in (i for fluent in goal for i in instances(fluent)):
        found[instance.step] = found[instance.step].merged(instance) if instance.step in found else instance
    return list(found.values())


def cheapest(
    roots: Iterable[Subgoal],
    instances: Callable[[Term], Sequence[Instance]],
    holds: Callable[[Term], bool],
    mutexes: Mutexes,
    level: int,
    dearest: int,
    patience: int = 100_000,
) -> int | None:
    """Return the least cost of a plan for one of the roots; None if there is none.

    The search tries every step for every fluent, in every order.

    Raises:
        UnfinishedError: If more than `patience` conjunctions are expanded.
    """
    order = itertools.count()
    queue = [(0, next(order), root) for root in roots]
    done: set[Subgoal] = set()
    while queue:
        cost, _, goal = heapq.heappop(queue)
        if goal in done:
            continue
        if all(map(holds, goal)):
            return cost
        done.add(goal)
        if len(done) > patience:
            raise UnfinishedError
        for whole in offered(goal, instances):
            before = regressed(whole, min(level, whole.concrete), goal, mutexes)
            if before is not None and cost + whole.price <= dearest:
                heapq.heappush(queue, (cost + whole.price, next(order), before))
    return None


@lru_cache(1 << 16)  # the same conjunctions come again for other goals and at other levels
def regressed(step: Instance, level: int, goal: Subgoal, mutexes: Mutexes) -> Subgoal | None:
    """Return the fluents that must hold before a step so that the goal holds after it; None if there are none."""
    rest = {f for f in goal if not any(entails(r, f) for r in step.results)}
    now = {f for f, at in step.preconditions if at <= level}
    later = {f for f, at in step.preconditions if at > level}
    if len(rest) == len(goal) or (level > 0 and step.on_placeholder):
        return None
    if any(mutexes.exclude(f, g) for f in rest for g in step.results | later):
        return None
    if any(matches(pattern, f) for f in rest for pattern in step.destroys):
        return None
    if any(mutexes.exclude(f, g) for f in now for g in rest):
        return None
    if any(mutexes.exclude(f, g) for f, g in itertools.combinations_with_replacement(now, 2)):
        return None
    before = rest | now
    pairs = itertools.permutations(before, 2)
    weaker = {f for f, g in pairs if entails(g, f) and not (entails(f, g) and str(f) < str(g))}
    return frozenset(before - weaker)
