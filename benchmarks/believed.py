"""A problem for the reasoner alone: belief and geometry answer from stored values, and every action succeeds.

These answers take almost no time, so that the reasoner alone is measured.
"""

import math
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from benchmarks.problems import Problem, support
from skolem.reasoner.plain import Normal, PlainBelief
from skolem.traces.messages import (
    Action,
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
)

GREEN, BLUE = 0.35, 0.63  # hues
HEAVY_LN_KG = math.log(0.4)
LIGHT_LN_KG, SURE_LN = math.log(0.1), 0.05
WEIGHT_SD = 0.6  # of ln(kg) of an arbitrary object
SEEN_SD_M, TOLD_SD_M, DRIVEN_SD_M = 0.004, 0.03, 0.03
_STILL = ((0.0,) * 7,)


@dataclass(frozen=True, slots=True)
class Thing:
    """The belief about one anchor."""

    on: str | None
    at: tuple[float, float]
    table: bool = False
    can: float = 0.0
    green: float = 0.0
    ln_kg: tuple[float, float] = (LIGHT_LN_KG, SURE_LN)
    hue_known: bool = False
    pose_sd: float = TOLD_SD_M
    hand: Hand | None = None


class Imagined(PlainBelief):
    """The belief and the geometry of a problem; `carry_out` makes the outcome true that a plan expects."""

    def __init__(self, given: Problem) -> None:
        self._given = given
        self.things: dict[str, Thing] = {
            name: Thing(on=None, at=at, table=True, pose_sd=SEEN_SD_M) for name, at in given.places.items()
        }
        for item in given.items:
            ln_kg = (LIGHT_LN_KG, SURE_LN)
            if item.heavy > 0.0:
                ln_kg = (NormalDist(HEAVY_LN_KG, WEIGHT_SD).inv_cdf(item.heavy), WEIGHT_SD)
            self.things[item.name] = Thing(item.table, given.places[item.table], False, item.can, item.green, ln_kg)
        self._before = {item.name: item.before for item in given.items}
        self._unseen = dict(given.regions)
        self._held: dict[Hand, str] = {}
        self._put: set[str] = set()  # what was put down stands in no row any more, even on the table it came from
        self._at: set[str] = set()
        self._approached = ""
        self._version = 0

    # ------------------------------------------------------------ belief

    @property
    def version(self) -> int:
        """Number of events applied so far."""
        return self._version

    def anchors(self) -> tuple[str, ...]:
        """Every anchor believed to exist, in order of introduction."""
        return tuple(self.things)

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """P(the object has the property), given that it exists."""
        thing = self.things[anchor]
        match meaning:
            case TypeIs(type="can"):
                return thing.can
            case TypeIs(type="table"):
                return float(thing.table)
            case TypeIs(type="carton"):
                return 0.0 if thing.table else 1.0 - thing.can
            case TypeIs():
                return 0.0
            case TypeIsNot(type=kind):
                return 1.0 - self.prob_property(anchor, TypeIs(type=kind))
            case HsvUnion(boxes=boxes):
                return max(self.prob_property(anchor, box) for box in boxes)
            case HsvVolume(hue=(low, high)):
                return thing.green if low < GREEN < high else 0.0
        mean, sd = thing.ln_kg
        heavy = NormalDist(HEAVY_LN_KG, sd).cdf(mean)
        return heavy if meaning.at_least_kg > 0 else 1.0 - heavy

    def prob_on(self, anchor: str, support: str) -> float:
        """P(the object rests wholly on the top of `support`); 0 while it is held."""
        thing = self.things[anchor]
        return 0.98 if thing.on == support and thing.hand is None else 0.0

    def support(self, anchor: str) -> str | None:
        """The likeliest support of the object; None: the floor, unknown, or a hand."""
        return self.things[anchor].on

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """P(the centres of two objects are at most `distance_m` apart in the plane)."""
        return float(math.dist(self.things[anchor].at, self.things[other].at) <= distance_m)

    def prob_property_of_new(self, meaning: Meaning) -> float:
        """P(an arbitrary object that is not met yet has the property)."""
        return 0.5

    def regions(self) -> tuple[str, ...]:
        """Every region of space that can be searched, in order of introduction."""
        return tuple(self._given.regions)

    def region_support(self, region: str) -> str:
        """The anchor on whose top the region lies."""
        return support(region)

    def prob_contents(self, region: str) -> float:
        """BContents: the share of the region that has been seen, without known objects."""
        return 0.0 if region in self._unseen else 0.95

    def prob_exists_in(self, region: str, match: float) -> float:
        """P(the unseen part of the region holds an object with a property that has the prior p = match)."""
        return self._unseen.get(region, 0.0)

    def graspable(self, anchor: str) -> bool:
        """Whether the most likely type can be grasped by a hand."""
        return not self.things[anchor].table

    def held(self, hand: Hand) -> str | None:
        """The anchor in that hand, or None."""
        return self._held.get(hand)

    def gaussian(self, quantity: Quantity, anchor: str) -> Normal:
        """The present belief about pose (relative to the base), colour or weight (ln kg)."""
        thing = self.things[anchor]
        if quantity == "weight":
            return Normal(np.array([thing.ln_kg[0]]), np.array([[thing.ln_kg[1] ** 2]]))
        if quantity == "colour":
            hue = GREEN if thing.green > 0.5 else BLUE
            return Normal(np.array([hue, 0.8, 0.8]), np.diag([(0.01 if thing.hue_known else 0.04) ** 2] * 3))
        yaw = thing.pose_sd if thing.table else 2.0
        return Normal(np.array([*thing.at, 0.0]), np.diag([thing.pose_sd, thing.pose_sd, yaw]) ** 2)

    def observation_covariance(
        self, quantity: Quantity, anchor: str, at: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Covariance of one observation of the quantity, in the space of `gaussian`."""
        if quantity == "weight":
            return np.array([[0.1**2]])
        if quantity == "colour":
            return np.diag([0.01, 0.03, 0.03]) ** 2
        return np.diag([SEEN_SD_M, SEEN_SD_M, 0.01 if self.things[anchor].table else 2.0]) ** 2

    def prob_detected(self, anchor: str) -> float:
        """P(a look at the object reports it | it exists and is in view)."""
        return 0.95

    def prob_type_right(self) -> float:
        """P(a look reports the true type | it reports the object)."""
        return 0.95

    def prob_favourable(self, anchor: str, meaning: Meaning, p: float) -> float:
        """P(one observation lifts the belief in the property to at least `p` | the object has the property)."""
        return 0.9

    # ------------------------------------------------------------ geometry

    def sync(self, belief: Belief) -> None:
        """Do nothing: belief and geometry are one object here."""

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from where the robot stands, or None if there is none."""
        hand: Hand = activity.hand or "right"
        if activity.kind == "weigh":
            return Weigh(hand=hand)
        if str(activity) not in self._at:
            return None
        if activity.kind == "pick":
            tool_T_object = (0.0, 0.0, -0.05, 0.0)
            return Pick(
                hand=hand, approach=_STILL, reach=_STILL, lift=_STILL, carry=_STILL, tool_T_object=tool_T_object
            )
        if activity.kind == "place":
            return Place(hand=hand, approach=_STILL, lower=_STILL, retreat=_STILL, carry=_STILL)
        return LookAt(pan=0.0, tilt=0.5)

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a drive to a base pose from which `activity` can be done (pick and place: and its object seen)."""
        self._approached = str(activity)
        return MoveBase(start_T_waypoint=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))

    def tried(self, activity: Activity) -> int:
        """Return 0: every drive is found."""
        del activity
        return 0

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        """Return the movable anchors that block `activity` from everywhere; empty if it is free."""
        if activity.kind != "pick":
            return ()
        row = self.things[activity.anchor].on
        before = self._before.get(activity.anchor, ())
        return tuple(b for b in before if self.things[b].on == row and b not in self._put)

    # ------------------------------------------------------------ outcomes

    def carry_out(self, action: Action) -> None:
        """Update the belief as if an action had the outcome that a plan expects."""
        self._version += 1
        command = action.command
        match command:
            case MoveBase():
                self._drive()
            case LookAt() if action.args[0] in self._given.regions:
                self._search(action.args[0])
            case LookAt():
                self._see(action.args[0])
            case Pick():
                self.tell(action.args[0], hand=command.hand, on=None)
                self._held[command.hand] = action.args[0]
            case Place():
                to = action.args[1]
                del self._held[command.hand]
                self._put.add(action.args[0])
                self.tell(action.args[0], hand=None, on=to, at=self.things[to].at, pose_sd=TOLD_SD_M)
            case Weigh():
                self.tell(action.args[0], ln_kg=(math.log(0.6), SURE_LN))

    def _drive(self) -> None:
        kind, _, arguments = self._approached.removesuffix(")").partition("(")
        self._at = {self._approached}
        if kind in ("pick", "place"):
            self._at.add(f"look({arguments.split(', ')[1 if kind == 'pick' else 2]})")
        for name, thing in self.things.items():
            if thing.pose_sd < DRIVEN_SD_M:
                self.tell(name, pose_sd=DRIVEN_SD_M)

    def _see(self, anchor: str) -> None:
        for name in (anchor, self.things[anchor].on):
            if name is not None:
                self.tell(name, pose_sd=SEEN_SD_M)
        if not self.things[anchor].table:
            thing = self.things[anchor]
            self.tell(anchor, can=0.997 if thing.can > 0.5 else 0.003, hue_known=True, green=round(thing.green))

    def _search(self, region: str) -> None:
        del self._unseen[region]
        at, on = self._given.places[support(region)], support(region)
        found = f"_o{len(self.things)}_"
        self.things[found] = Thing(on, at, False, 0.997, 1.0, (HEAVY_LN_KG, WEIGHT_SD), True, SEEN_SD_M)

    def tell(self, anchor: str, **fields: object) -> None:
        """Change the belief about an anchor: fields of `Thing`."""
        self.things[anchor] = replace(self.things[anchor], **fields)  # type: ignore[arg-type]
