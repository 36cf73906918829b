"""The verdict whether a goal holds in the true world. The truth is queried as a belief that is certain of everything.

So the robot's own denotation is evaluated, with probabilities 0 and 1.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner import Goal, Normal, PlainBelief
from skolem.reasoner.planning.goals import achieved_by, all_achieving
from skolem.reasoner.rulebook.book import Rulebook
from skolem.sim.space.footprints import footprint, overhang
from skolem.traces.messages import (
    Belief,
    ColourMeaning,
    Hand,
    Meaning,
    ObjectType,
    Quantity,
    Relation,
    Strangers,
    TrueObject,
    TrueState,
    TypeIs,
    TypeIsNot,
    Verdict,
    WeightInterval,
)
from skolem.traces.messages.poses import compose4, flat, inverse4, raised


class Truth(PlainBelief):
    """Answers the questions to a belief from the true state; questions about sensors and regions never come.

    The prior may name an object that does not exist: it has no property and stands nowhere.
    """

    def __init__(self, state: TrueState, types: Mapping[str, ObjectType], first: TrueState | None = None) -> None:
        """Answer from a true state.

        Args:
            state: The true state.
            types: Every object type.
            first: The state in which the goal was stated; None if it is this one.
        """
        self._objects = {item.id: item for item in state.objects}
        self._first = self if first is None else Truth(first, types)
        self._types = types
        self._world_T_base = raised(state.world_T_base)
        self._version = state.step

    @property
    def version(self) -> int:
        """The step of the state, which changes whenever the truth may change."""
        return self._version

    def anchors(self) -> tuple[str, ...]:
        """Every true object."""
        return tuple(self._objects)

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """1 if the object has the property."""
        return float(anchor in self._objects and _has(self._objects[anchor], meaning))

    def prob_on(self, anchor: str, support: str) -> float:
        """1 if the object stands wholly on the top of `support`."""
        item, under = self._objects.get(anchor), self._objects.get(support)
        if item is None or under is None or item.in_hand is not None or item.on != support:
            return 0.0
        inner = footprint(self._types[item.type], flat(item.world_T_object))
        outer = footprint(self._types[under.type], flat(under.world_T_object))
        return float(overhang(inner, outer) <= 0.0)

    def support(self, anchor: str) -> str | None:
        """The support of the object."""
        return self._objects[anchor].on if anchor in self._objects else None

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """1 if the centres of two objects are at most `distance_m` apart."""
        if anchor not in self._objects or other not in self._objects:
            return 0.0
        return float(_apart(self._objects[anchor], self._objects[other]) <= distance_m)

    def prob_was_on(self, anchor: str, support: str) -> float:
        """1 if the object stood on `support` when the goal was stated."""
        return self._first.prob_on(anchor, support)

    def prob_was_near(self, anchor: str, other: str, distance_m: float) -> float:
        """1 if the objects were near when the goal was stated."""
        return self._first.prob_near(anchor, other, distance_m)

    def relations(self, asked: Sequence[Relation]) -> "TrueRelations":
        """Whether each relation holds."""
        return TrueRelations(np.array([self.is_so(relation) for relation in asked], dtype=np.bool_))

    def strangers(self) -> tuple[Strangers, ...]:
        """None: every object is known."""
        return ()

    def is_so(self, relation: Relation) -> bool:
        """Return whether a relation holds."""
        if relation.earlier:
            return self._first.is_so(relation.model_copy(update={"earlier": False}))
        match relation:
            case Relation(kind="on", anchors=(one, other)):
                return self.prob_on(one, other) == 1.0
            case Relation(kind="near", anchors=(one, other)):
                return self.prob_near(one, other, relation.distance_m) == 1.0
            case Relation(kind="weighs", anchors=(one,), meaning=WeightInterval() as meaning):
                return self.prob_property(one, meaning) == 1.0
        items = [self._objects.get(anchor) for anchor in relation.anchors]
        if None in items:
            return False
        first, second, *to = [item for item in items if item is not None]
        return _apart(first, to[0]) < _apart(second, to[0]) if to else first.kg > second.kg

    def graspable(self, anchor: str) -> bool:
        """Whether the object's type can be grasped."""
        return anchor in self._objects and self._types[self._objects[anchor].type].graspable

    def held(self, hand: Hand) -> str | None:
        """The object in that hand."""
        return next((name for name, item in self._objects.items() if item.in_hand == hand), None)

    def gaussian(self, quantity: Quantity, anchor: str) -> Normal:
        """The true value, without variance."""
        item = self._objects[anchor]
        if quantity == "pose":
            mean: tuple[float, ...] = flat(compose4(inverse4(self._world_T_base), item.world_T_object))
        else:
            mean = item.hsv if quantity == "colour" else (math.log(item.kg),)
        return Normal(np.array(mean), np.zeros((len(mean), len(mean))))


@dataclass(frozen=True, slots=True)
class TrueRelations:
    """Relations of which each is known to hold or not."""

    holds: NDArray[np.bool_]
    dimension: int = 0

    def settled(self) -> NDArray[np.int8]:
        """1 for a relation that holds, -1 for one that does not, shape (relations,)."""
        return np.where(self.holds, 1, -1).astype(np.int8)

    def truth(self, uniforms: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether each relation holds, shape (n, relations), whatever the numbers, shape (n, any), are."""
        return np.tile(self.holds, (len(uniforms), 1))


def verdict(
    goal: Goal,
    rulebook: Rulebook,
    state: TrueState,
    types: Mapping[str, ObjectType],
    first: TrueState | None = None,
) -> Verdict:
    """Return whether the goal holds in the true state, and for which object; `first` as for `Truth`."""
    witness = achieved_by(goal, rulebook, Truth(state, types, first))
    return Verdict(true=witness is not None, witness=witness or None)


def own_makes_it_true(
    goal: Goal,
    rulebook: Rulebook,
    state: TrueState,
    types: Mapping[str, ObjectType],
    belief: Belief,
    anchor: str | None,
    first: TrueState | None = None,
) -> bool:
    """Return whether the goal is true of the object that the robot chose, and not only of another one.

    In a goal with several variables the first described object counts; a goal without variables only has to be true.

    Args:
        goal: The goal of the run.
        rulebook: The rules.
        state: The true state at the end.
        types: Every object type.
        belief: The last belief of the run.
        anchor: The robot's chosen object; None if it chose none.
        first: As for `Truth`.
    """
    achieving = all_achieving(goal, rulebook, Truth(state, types, first))
    if not goal.variables or "" in achieving:
        return bool(achieving)
    return anchor is not None and meant_by(anchor, belief, state, types) in achieving


def meant_by(anchor: str, belief: Belief, state: TrueState, types: Mapping[str, ObjectType]) -> str | None:
    """Return the true object that an anchor stands for; None if there is none.

    An anchor of the prior stands for the true object of that name. An anchor that the robot made stands for the object
    that can be lifted and is nearest to the believed position.
    """
    names = {item.id for item in state.objects}
    if anchor in names or anchor not in belief.objects:
        return anchor if anchor in names else None
    there = belief.objects[anchor].world_T_object
    movable = [item for item in state.objects if types[item.type].graspable]
    nearest = min(movable, key=lambda item: (math.dist(item.world_T_object[:3], there[:3]), item.id), default=None)
    return None if nearest is None else nearest.id


def _apart(one: TrueObject, other: TrueObject) -> float:
    """Return the distance of the middles of two objects in the plane, metres."""
    (x, y, *_), (u, v, *_) = one.world_T_object, other.world_T_object
    return math.hypot(x - u, y - v)


def _has(item: TrueObject, meaning: Meaning) -> bool:
    if isinstance(meaning, TypeIs):
        return item.type == meaning.type
    if isinstance(meaning, TypeIsNot):
        return item.type != meaning.type
    if isinstance(meaning, ColourMeaning):
        return meaning.contains(item.hsv)
    return meaning.at_least_kg <= item.kg and (meaning.below_kg is None or item.kg < meaning.below_kg)
