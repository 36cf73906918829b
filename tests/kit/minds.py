"""Test doubles for the reasoner: a belief and a geometry that are tables, changed by hand between turns."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.plain import Normal, PlainBelief
from skolem.traces.messages import (
    Activity,
    Belief,
    Command,
    Hand,
    HsvUnion,
    HsvVolume,
    LookAt,
    Meaning,
    MoveBase,
    Pick,
    Place,
    Quantity,
    TypeIs,
    TypeIsNot,
    Weigh,
    WeightInterval,
)

_STILL = ((0.0,) * 7,)


@dataclass
class Region:
    """The belief on a region: its support, expected number of unmet objects, and seen share."""

    support: str
    objects: float = 0.3
    seen: float = 0.0


@dataclass
class Thing:
    """The belief on one anchor, as plain numbers."""

    types: dict[str, float]
    on: str | None = None
    hand: Hand | None = None
    colours: dict[tuple[float, float], float] = field(default_factory=dict)  # hue interval -> probability
    hsv: tuple[float, float, float] = (0.5, 0.6, 0.6)
    hsv_sd: float = 0.4
    ln_kg: tuple[float, float] = (math.log(0.3), 0.6)
    pose_sd: float = 0.03
    exists: float = 1.0


class TableBelief(PlainBelief):
    """A belief as a table; call `changed()` after every edit."""

    def __init__(self, things: dict[str, Thing], regions: dict[str, Region] | None = None) -> None:
        self.things = things
        self.spaces = regions or {}
        self.new = Thing({"soda": 0.5, "bottle": 0.5})
        self._version = 0

    def changed(self) -> None:
        self._version += 1

    @property
    def version(self) -> int:
        return self._version

    def anchors(self) -> tuple[str, ...]:
        return tuple(a for a, t in self.things.items() if t.exists >= 0.5)

    def prob_exists(self, anchor: str) -> float:
        return self.things[anchor].exists if anchor in self.things else 0.0

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        return self._prob(self.things[anchor], meaning)

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        del distance_m
        return float(self.things[anchor].on is not None and self.things[anchor].on == self.things[other].on)

    def prob_property_of_new(self, meaning: Meaning) -> float:
        return self._prob(self.new, meaning)

    def regions(self) -> tuple[str, ...]:
        return tuple(self.spaces)

    def region_support(self, region: str) -> str:
        return self.spaces[region].support

    def prob_contents(self, region: str) -> float:
        return self.spaces[region].seen

    def prob_exists_in(self, region: str, match: float) -> float:
        space = self.spaces[region]
        return 1.0 - math.exp(-space.objects * (1.0 - space.seen) * match)

    def _prob(self, thing: Thing, meaning: Meaning) -> float:
        match meaning:
            case TypeIs(type=name):
                return thing.types.get(name, 0.0)
            case TypeIsNot(type=name):
                return 1.0 - thing.types.get(name, 0.0)
            case HsvUnion(boxes=boxes):
                _, s, v = thing.hsv  # taken as exact
                return sum(self._prob(thing, box) for box in boxes if box.contains((box.hue[0], s, v)))
            case HsvVolume(hue=hue):
                width = (hue[1] - hue[0]) % 1.0
                offset = abs((thing.hsv[0] - hue[0] - width / 2 + 0.5) % 1.0 - 0.5)
                return _normal_cdf((width / 2 - offset) / thing.hsv_sd) - _normal_cdf(
                    (-width / 2 - offset) / thing.hsv_sd
                )
            case WeightInterval(at_least_kg=low, below_kg=high):
                mean, sd = thing.ln_kg
                upper = 1.0 if high is None else _normal_cdf((math.log(high) - mean) / sd)
                return upper - (_normal_cdf((math.log(low) - mean) / sd) if low > 0 else 0.0)

    def prob_on(self, anchor: str, support: str) -> float:
        thing = self.things[anchor]
        return 0.98 if thing.on == support and thing.hand is None else 0.0

    def support(self, anchor: str) -> str | None:
        thing = self.things[anchor]
        return thing.on if thing.hand is None else None

    def graspable(self, anchor: str) -> bool:
        return "table" not in self.things[anchor].types

    def held(self, hand: Hand) -> str | None:
        return next((a for a, t in self.things.items() if t.hand == hand), None)

    def gaussian(self, quantity: Quantity, anchor: str) -> Normal:
        thing = self.things[anchor]
        if quantity == "weight":
            return Normal(np.array([thing.ln_kg[0]]), np.array([[thing.ln_kg[1] ** 2]]), thing.exists)
        if quantity == "colour":
            return Normal(np.array(thing.hsv), np.eye(3) * thing.hsv_sd**2, thing.exists)
        yaw = thing.pose_sd if "table" in thing.types else 2.0
        return Normal(np.zeros(3), np.diag([thing.pose_sd, thing.pose_sd, yaw]) ** 2, thing.exists)

    def observation_covariance(
        self, quantity: Quantity, anchor: str, at: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        if quantity == "weight":
            return np.array([[0.1**2]])
        if quantity == "colour":
            return np.diag([0.01, 0.03, 0.03]) ** 2
        return np.diag([0.005, 0.005, 0.01 if "table" in self.things[anchor].types else 2.0]) ** 2

    def prob_detected(self, anchor: str) -> float:
        del anchor
        return 0.95

    def prob_type_right(self) -> float:
        return 0.95

    def prob_favourable(self, anchor: str, meaning: Meaning, p: float) -> float:
        del anchor, meaning, p
        return 0.9


class TableGeometry:
    """A geometry in which each activity has one stance; `at` names the activities possible from the present stance."""

    def __init__(self) -> None:
        self.at: set[str] = set()
        self.impossible: set[str] = set()
        self.spent: dict[str, int] = {}  # stances tried, for each of `impossible` whose budget was spent
        self.in_the_way: dict[str, tuple[str, ...]] = {}
        self.asked: list[str] = []

    def sync(self, belief: Belief) -> None:
        del belief

    def drive(self, activity: str) -> None:
        """Drive to the stance of `activity`; an object can also be looked at from the stance of its pick or place."""
        activity = activity.removesuffix(" from elsewhere")
        self.at = {activity}
        kind, _, arguments = activity.removesuffix(")").partition("(")
        if kind in ("pick", "place"):
            self.at.add(f"look({arguments.split(', ')[1 if kind == 'pick' else 2]})")

    def ready(self, activity: Activity) -> Command | None:
        self.asked.append(f"ready {activity}")
        if activity.kind == "weigh":
            return Weigh(hand=activity.hand or "right")
        if str(activity) not in self.at:
            return None
        return _command(activity)

    def tried(self, activity: Activity) -> int:
        return self.spent.get(str(activity), 0)

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        self.asked.append(f"blockers {activity}")
        return self.in_the_way.get(str(activity), ())

    def approach(self, activity: Activity) -> MoveBase | None:
        self.asked.append(f"approach {activity}")
        return (
            None if str(activity) in self.impossible else MoveBase(start_T_waypoint=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
        )


def _command(activity: Activity) -> Command:
    hand: Hand = activity.hand or "right"
    if activity.kind in ("look", "look_region"):
        return LookAt(pan=0.0, tilt=0.5)
    if activity.kind == "pick":
        return Pick(
            hand=hand, approach=_STILL, reach=_STILL, lift=_STILL, carry=_STILL, tool_T_object=(0.0, 0.0, -0.05, 0.0)
        )
    return Place(hand=hand, approach=_STILL, lower=_STILL, retreat=_STILL, carry=_STILL)


def _normal_cdf(x: float) -> float:
    return 0.5 * (1.0 + math.erf(x / math.sqrt(2.0)))
