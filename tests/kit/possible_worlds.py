"""Small beliefs whose possible worlds can be counted one by one, and the truth of an expression in one of them.

This is the oracle of `reasoner/worlds`: it shares no code with it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations_with_replacement, pairwise, product
from math import exp, factorial, prod
from typing import Any

import numpy as np
from hypothesis import strategies as st
from kit.relation_tables import BOOK
from numpy.typing import NDArray

from skolem.reasoner.language.descriptions import (
    And,
    Argument,
    Atom,
    Count,
    CountKind,
    Every,
    Exists,
    Expression,
    Name,
    Not,
    Number,
    Object,
    Or,
    Same,
    Variable,
    Was,
    constant_of,
)
from skolem.traces.messages import HsvUnion, HsvVolume, Meaning, Relation, Strangers, TypeIs, TypeIsNot, WeightInterval

# The shipped words, and colours that overlap with them, one of them around hue 0.
VOCABULARY = replace(
    BOOK.vocabulary,
    meanings={
        **BOOK.vocabulary.meanings,
        "leafy": HsvVolume(hue=(0.2, 0.3), saturation=(0.3, 1.0), value=(0.0, 1.0)),
        "warm": HsvVolume(hue=(0.9, 0.25), saturation=(0.0, 1.0), value=(0.0, 1.0)),
    },
)
PROPERTIES = ("Green", "Leafy", "Warm", "Soda", "Bottle", "Heavy", "Light")
MOST_STRANGERS = 3  # in a region; beyond that, means of .001 leave a probability of 4e-14
NEGLIGIBLE = 1e-19  # a world of less is left out; there are fewer than a million
Hsv = tuple[float, float, float]


@dataclass(frozen=True)
class Look:
    """What an object is like."""

    kind: str
    hsv: Hsv
    kg: float

    def is_a(self, meaning: Meaning) -> bool:
        match meaning:
            case TypeIs(type=kind):
                return self.kind == kind
            case TypeIsNot(type=kind):
                return self.kind != kind
            case HsvVolume() | HsvUnion():
                return meaning.contains(self.hsv)
            case WeightInterval():
                return meaning.at_least_kg <= self.kg and (meaning.below_kg is None or self.kg < meaning.below_kg)


@dataclass(frozen=True)
class Likely:
    """A distribution over what an object is like: type, colour and weight are independent."""

    kinds: Mapping[str, float]
    colours: Mapping[Hsv, float]
    weights: Mapping[float, float]

    def looks(self) -> Iterator[tuple[float, Look]]:
        for (kind, p), (hsv, q), (kg, r) in product(self.kinds.items(), self.colours.items(), self.weights.items()):
            yield p * q * r, Look(kind, hsv, kg)

    def prob(self, meaning: Meaning) -> float:
        return sum(p for p, look in self.looks() if look.is_a(meaning))


@dataclass(frozen=True)
class World:
    """One world: what exists, what it is like, and the relations that hold."""

    looks: Mapping[str, Look]
    on: frozenset[tuple[str, str]]
    near: frozenset[tuple[str, str]]
    before: "World | None" = None  # the same objects where they were at the start, if something was moved

    def beside(self, one: str, other: str) -> bool:
        return (one, other) in self.near or (other, one) in self.near


@dataclass(frozen=True)
class Arrangement:
    """Where things are, with its probability in 128ths."""

    share: int
    on: frozenset[tuple[str, str]]
    near: frozenset[tuple[str, str]]
    before: "Arrangement | None" = None  # that of the start, if something was moved since


class Known:
    """A belief without joint relations: each is a fact of its own."""

    def __init__(
        self,
        likely: Mapping[str, Likely],
        exists: Mapping[str, float],
        arrangements: Sequence[Arrangement],
        version: int = 0,
    ) -> None:
        self.likely, self.exists, self.arrangements, self.version = likely, exists, tuple(arrangements), version

    def anchors(self) -> tuple[str, ...]:
        return tuple(self.likely)

    def prob_exists(self, anchor: str) -> float:
        return self.exists.get(anchor, 0.0)

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        return self.likely[anchor].prob(meaning)

    def prob_on(self, anchor: str, support: str) -> float:
        return sum(a.share for a in self.arrangements if (anchor, support) in a.on) / 128

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        return sum(a.share for a in self.arrangements if {(anchor, other), (other, anchor)} & a.near) / 128

    def prob_was_on(self, anchor: str, support: str) -> float:
        return sum(a.share for a in self.arrangements if (anchor, support) in (a.before or a).on) / 128

    def prob_was_near(self, anchor: str, other: str, distance_m: float) -> float:
        pairs = {(anchor, other), (other, anchor)}
        return sum(a.share for a in self.arrangements if pairs & (a.before or a).near) / 128


class Open(Known):
    """A belief over arrangements, with strangers in regions."""

    def __init__(
        self,
        likely: Mapping[str, Likely],
        exists: Mapping[str, float],
        arrangements: Sequence[Arrangement],
        regions: Sequence[Strangers] = (),
        new: Likely | None = None,
        version: int = 0,
    ) -> None:
        super().__init__(likely, exists, arrangements, version)
        self.regions_, self.new = tuple(regions), new

    def prob_property_of_new(self, meaning: Meaning) -> float:
        assert self.new is not None
        return self.new.prob(meaning)

    def strangers(self) -> tuple[Strangers, ...]:
        return self.regions_

    def relations(self, asked: Sequence[Relation]) -> "Picked":
        return Picked(self.arrangements, tuple(asked))

    def __repr__(self) -> str:
        return f"Open({self.likely}, {self.exists}, {self.arrangements}, {self.regions_}, {self.new})"

    @cached_property
    def worlds(self) -> list[tuple[float, World]]:
        """Every world with its probability."""
        return list(self._worlds())

    def _worlds(self) -> Iterator[tuple[float, World]]:
        unmet = list(self._unmet())
        for arrangement in self.arrangements:
            for weight, looks in _choices([_object(n, self.likely[n], self.exists[n]) for n in self.likely]):
                for share, found, places in unmet:
                    p = weight * share * arrangement.share / 128
                    if p >= NEGLIGIBLE:
                        every, then = {**looks, **found}, arrangement.before or arrangement
                        before = World(every, then.on | places, then.near)
                        yield p, World(every, arrangement.on | places, arrangement.near, before)

    def _unmet(self) -> Iterator[tuple[float, dict[str, Look], frozenset[tuple[str, str]]]]:
        options = []
        for i, region in enumerate(self.regions_):
            assert self.new is not None
            numbers: list[tuple[float, dict[str, Look]]] = []
            for n in range(MOST_STRANGERS + 1):
                for chosen in combinations_with_replacement(list(self.new.looks()), n):
                    orders = factorial(n) / prod(factorial(chosen.count(one)) for one in dict.fromkeys(chosen))
                    weight = exp(-region.expected) * region.expected**n / factorial(n) * orders
                    looks = {f"stranger{i}{k}": look for k, (_, look) in enumerate(chosen)}
                    numbers.append((weight * prod(p for p, _ in chosen), looks))
            options += [numbers, _object(f"overlooked{i}", self.new, region.overlooked)]
        for weight, looks in _choices(options):
            on = {
                (name, self.regions_[int(name.removeprefix("stranger").removeprefix("overlooked")[0])].support)
                for name in looks
            }
            yield weight, looks, frozenset(on)


@dataclass(frozen=True)
class Picked:
    """Relations in arrangements, of which one number picks one."""

    arrangements: tuple[Arrangement, ...]
    asked: tuple[Relation, ...]
    dimension: int = 1

    def truth(self, uniforms: NDArray[np.float64]) -> NDArray[np.bool_]:
        ends = np.cumsum([a.share for a in self.arrangements]) / 128
        picked = np.searchsorted(ends, uniforms[:, 0], side="right")
        rows = [[self._holds(relation, a) for relation in self.asked] for a in self.arrangements]
        return np.array(rows, dtype=np.bool_).reshape(len(rows), len(self.asked))[picked]

    def settled(self) -> NDArray[np.int8]:
        rows = [[self._holds(relation, a) for relation in self.asked] for a in self.arrangements]
        truth = np.array(rows, dtype=np.bool_).reshape(len(rows), len(self.asked))
        return np.where(truth.all(axis=0), 1, np.where(truth.any(axis=0), 0, -1)).astype(np.int8)

    def _holds(self, relation: Relation, arrangement: Arrangement) -> bool:
        one, other = relation.anchors
        if relation.earlier:
            arrangement = arrangement.before or arrangement
        if relation.kind == "on":
            return (one, other) in arrangement.on
        return (one, other) in arrangement.near or (other, one) in arrangement.near


_Options = list[tuple[float, dict[str, Look]]]


def _object(name: str, likely: Likely, exists: float) -> _Options:
    return [(1.0 - exists, {}), *((exists * p, {name: look}) for p, look in likely.looks())]


def _choices(options: Sequence[_Options]) -> Iterator[tuple[float, dict[str, Look]]]:
    for chosen in product(*options):
        if weight := prod(p for p, _ in chosen):
            yield weight, {name: look for _, looks in chosen for name, look in looks.items()}


# ---------------------------------------------------------------- truth


def true_in(expression: Expression, env: Mapping[str, str], world: World) -> bool:
    """Return whether an expression is true in a world, its variables standing for objects that exist there."""
    match expression:
        case And(left, right):
            return true_in(left, env, world) and true_in(right, env, world)
        case Or(left, right):
            return true_in(left, env, world) or true_in(right, env, world)
        case Not(body):
            return not true_in(body, env, world)
        case Same(left, right):
            return _meant(left, env) == _meant(right, env) and _meant(left, env) in world.looks
        case Exists(variable, body):
            return any(true_in(body, {**env, variable: one}, world) for one in world.looks)
        case Every(variable, condition, body):
            each = [{**env, variable: one} for one in world.looks]
            return all(true_in(body, e, world) for e in each if true_in(condition, e, world))
        case Count(kind, number, variable, body):
            count = sum(true_in(body, {**env, variable: one}, world) for one in world.looks)
            return {"exactly": count == number, "at least": count >= number, "at most": count <= number}[kind]
        case Was(body):
            return true_in(body, env, world.before or world)
        case Atom(word, args):
            return _atom(constant_of(word), [_meant(arg, env) for arg in args], world)
    raise AssertionError(expression)


def _meant(argument: Argument, env: Mapping[str, str]) -> str | float:
    match argument:
        case Number(value):
            return value
        case Variable(name):
            return env[name]
        case Name(name):
            return name


def _atom(relation: str, args: Sequence[str | float], world: World) -> bool:
    match args:
        case [str(one)]:
            return one in world.looks and world.looks[one].is_a(VOCABULARY.meanings[relation])
        case [str(one), str(other)]:
            if one not in world.looks or other not in world.looks:
                return False
            if relation == "on":
                return (one, other) in world.on
            return one != other and world.beside(one, other)
        case [str(one), float(grams)]:
            return one in world.looks and world.looks[one].kg >= max(0.0, grams / 1000)
    raise AssertionError(relation)


def enumerated(expression: Expression, env: Mapping[str, str], belief: Open) -> float:
    """Return the probability of the worlds in which the meant objects exist and the expression is true."""
    return sum(p for p, world in belief.worlds if {*env.values()} <= {*world.looks} and true_in(expression, env, world))


# ---------------------------------------------------------------- drawn beliefs and expressions

LEAST = 0.001  # mean number of strangers: four of them are less likely than any rounding
NAMES = ("a", "b", "c", "d")
COLOURS: tuple[Hsv, ...] = ((0.22, 0.8, 0.5), (0.28, 0.5, 0.5), (0.95, 0.8, 0.8), (0.6, 0.8, 0.8))
WEIGHTS = (0.05, 0.2, 0.35, 0.9)


def _shares(draw: st.DrawFn, values: Sequence[Any], most: int) -> dict[Any, float]:
    chosen = draw(st.lists(st.sampled_from(values), min_size=1, max_size=most, unique=True))
    odds = draw(st.lists(st.integers(1, 9), min_size=len(chosen), max_size=len(chosen)))
    return {value: odd / sum(odds) for value, odd in zip(chosen, odds, strict=True)}


@st.composite
def likely(draw: st.DrawFn, looks: int) -> Likely:
    """Draw what an object is like, as one of at most `looks` in type and colour, or in type and weight."""
    colours, weights = draw(st.sampled_from([(looks // 2, 1), (1, looks // 2)]))
    return Likely(
        _shares(draw, ("soda", "bottle", "table"), 2),
        _shares(draw, COLOURS, max(colours, 1)),
        _shares(draw, WEIGHTS, max(weights, 1)),
    )


@st.composite
def beliefs(draw: st.DrawFn, strangers: bool = False) -> Open:
    """Draw a belief with few enough worlds to count them; with strangers it has fewer objects."""
    names = NAMES[: draw(st.integers(1, 2 if strangers else 3))]
    pairs = [(one, other) for one in names for other in names if one != other]
    cuts = sorted(draw(st.sets(st.integers(1, 127), max_size=4)))
    few = st.frozensets(st.sampled_from(pairs), max_size=3) if pairs else st.just(frozenset[tuple[str, str]]())
    arrangements = [
        Arrangement(high - low, draw(few), draw(few), draw(st.none() | st.builds(Arrangement, st.just(128), few, few)))
        for low, high in pairwise([0, *cuts, 128])
    ]
    regions = []
    if strangers:
        means, chances = st.floats(LEAST / 4, LEAST), st.sampled_from([0.0, 0.3])
        count = draw(st.integers(1, 2))
        regions = [
            Strangers(support=draw(st.sampled_from(names)), expected=draw(means), overlooked=draw(chances))
            for _ in range(count)
        ]
    exists = {name: draw(st.sampled_from([1.0, 0.9, 0.5])) for name in names}
    return Open({name: draw(likely(4)) for name in names}, exists, arrangements, regions, draw(likely(2)))


@st.composite
def expressions(draw: st.DrawFn, scope: tuple[str, ...], depth: int = 3, near: bool = True) -> Expression:
    """Draw an expression of any construct whose free variables are in `scope`."""
    kinds = ["and", "or", "not", "exists", "every", "count", "was"] if depth else []
    kind = draw(st.sampled_from(["atom", "atom", "same", *kinds]))
    inner = (*scope, f"y{depth}")

    def part(names: tuple[str, ...]) -> Expression:
        return draw(expressions(names, depth - 1, near))

    match kind:
        case "and":
            return And(part(scope), part(scope))
        case "or":
            return Or(part(scope), part(scope))
        case "not":
            return Not(part(scope))
        case "was":
            return Was(part(scope))
        case "exists":
            return Exists(inner[-1], part(inner))
        case "every":
            return Every(inner[-1], part(inner), part(inner))
        case "count":
            how: CountKind = draw(st.sampled_from(list[CountKind](["exactly", "at least", "at most"])))
            return Count(how, draw(st.integers(0, 2)), inner[-1], part(inner))
    objects: st.SearchStrategy[Object] = (
        st.one_of(
            st.sampled_from(scope).map(Variable), st.sampled_from(scope).map(Variable), st.sampled_from(NAMES).map(Name)
        )
        if scope
        else st.sampled_from(NAMES).map(Name)
    )
    if kind == "same":
        return Same(draw(objects), draw(objects))
    word = draw(st.sampled_from([*PROPERTIES, "On", "On", *(["Near", "Near"] if near else []), "HeavierThan"]))
    if word in PROPERTIES:
        return Atom(word, (draw(objects),))
    if word == "HeavierThan":
        return Atom(word, (draw(objects), Number(draw(st.sampled_from([100.0, 300.0, 400.0])))))
    return Atom(word, (draw(objects), draw(objects)))


def renamed(expression: Expression, names: Mapping[str, str]) -> Expression:
    """Return an expression with other names of its free variables, and with a prime at those that it binds."""

    def moved(argument: Argument) -> Argument:
        return Variable(names[argument.name]) if isinstance(argument, Variable) else argument

    match expression:
        case And(left, right):
            return And(renamed(left, names), renamed(right, names))
        case Or(left, right):
            return Or(renamed(left, names), renamed(right, names))
        case Not(body):
            return Not(renamed(body, names))
        case Was(body):
            return Was(renamed(body, names))
        case Same(Variable() | Name() as left, right):
            return Same(*(one for one in map(moved, (left, right)) if not isinstance(one, Number)))
        case Exists(variable, body):
            return Exists(f"{variable}_", renamed(body, {**names, variable: f"{variable}_"}))
        case Every(variable, condition, body):
            inner = {**names, variable: f"{variable}_"}
            return Every(f"{variable}_", renamed(condition, inner), renamed(body, inner))
        case Count(kind, number, variable, body):
            return Count(kind, number, f"{variable}_", renamed(body, {**names, variable: f"{variable}_"}))
        case Atom(word, args):
            return Atom(word, tuple(map(moved, args)))
    raise AssertionError(expression)
