"""What the reasoner asks of others: a belief to query and a geometry to consult.

`skolem.estimation.Belief` satisfies `BeliefQueries`; `PlanningWorld` and `SymbolicGeometry` of `skolem.sim` satisfy
`Geometry`. Tests satisfy both with a table.

May import: nothing.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Belief, Command, Hand, Meaning, MoveBase, Quantity


class Gaussian(Protocol):
    """A Gaussian belief on one quantity of one object."""

    @property
    def mean(self) -> NDArray[np.float64]:
        """Shape (n,). pose: x, y, theta of base_T_object (m, rad); colour: hue, saturation, value; weight: ln(kg)."""
        ...

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Shape (n, n), same units squared. pose: tangent space of the mean, object frame."""
        ...

    @property
    def probability(self) -> float:
        """Mixture weight P_b: that the object exists at all."""
        ...


class BeliefQueries(Protocol):
    """Pure questions about the belief; equal `version` means equal answers."""

    @property
    def version(self) -> int:
        """Number of events applied so far."""
        ...

    def anchors(self) -> tuple[str, ...]:
        """Every anchor believed to exist, in order of introduction."""
        ...

    def prob_exists(self, anchor: str) -> float:
        """P(there is such an object); 0 for an unknown anchor."""
        ...

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """P(the object has the property), given that it exists."""
        ...

    def prob_on(self, anchor: str, support: str) -> float:
        """P(the object rests wholly on the top of `support`), given that both exist; 0 while it is held."""
        ...

    def support(self, anchor: str) -> str | None:
        """What the object most likely rests on; None: the floor, nothing known, or a hand."""
        ...

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """P(the middles of two objects are at most so far apart, in the plane), given that both exist."""
        ...

    def prob_property_of_new(self, meaning: Meaning) -> float:
        """P(an arbitrary object that nobody has met yet has the property)."""
        ...

    def regions(self) -> tuple[str, ...]:
        """Every region of space that can be searched, in order of introduction."""
        ...

    def region_support(self, region: str) -> str:
        """The anchor on whose top the region lies."""
        ...

    def prob_contents(self, region: str) -> float:
        """BContents: the part of the region that has been seen, known objects taken out."""
        ...

    def prob_exists_in(self, region: str, match: float) -> float:
        """P(the unseen part of the region holds an object with a property that an arbitrary one has with p = match)."""
        ...

    def graspable(self, anchor: str) -> bool:
        """Whether the most likely type can be grasped by a hand."""
        ...

    def held(self, hand: Hand) -> str | None:
        """The anchor in that hand, or None."""
        ...

    def gaussian(self, quantity: Quantity, anchor: str) -> Gaussian:
        """The present belief on pose (relative to the base), colour or weight (ln kg)."""
        ...

    def observation_covariance(self, quantity: Quantity, anchor: str) -> NDArray[np.float64]:
        """Covariance of one observation of the quantity, in the space of `gaussian`."""
        ...

    def prob_detected(self, anchor: str) -> float:
        """P(a look at the object reports it | it exists and is in view)."""
        ...

    def prob_type_right(self) -> float:
        """P(a look reports the true type | it reports the object)."""
        ...

    def prob_favourable(self, anchor: str, meaning: Meaning, p: float) -> float:
        """P(one observation lifts the belief in the property to at least `p` | the object has the property)."""
        ...


@dataclass(frozen=True, slots=True)
class Activity:
    """Something to be done from a base pose.

    Attributes:
        kind: "look", "look_region", "pick", "place" or "weigh".
        anchor: The object it is about; the region for look_region.
        hand: The hand that does it; None for a look.
        support: Where to place; None otherwise.
        clear_of: What the object must not stand in the way of when it is placed; None if that does not matter.
        elsewhere: Whether it was done from here in vain: only if there is nowhere else is it to be done from here.
    """

    kind: str
    anchor: str
    hand: Hand | None = None
    support: str | None = None
    clear_of: "Activity | None" = None
    elsewhere: bool = False

    def __str__(self) -> str:
        """Return `pick(right, o2)` and the like."""
        arguments = (self.hand, self.anchor, self.support, self.clear_of)
        told = f"{self.kind}({', '.join(str(x) for x in arguments if x is not None)})"
        return f"{told} from elsewhere" if self.elsewhere else told


class Geometry(Protocol):
    """Answers computed on the belief it was last given; pure in (belief, question, run seed)."""

    def sync(self, belief: Belief) -> None:
        """Take over the believed world; every later answer is about it."""
        ...

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from where the robot stands, or None if there is none."""
        ...

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a drive to a base pose from which `activity` can be done (pick and place: and its object seen)."""
        ...

    def blockers(self, activity: Activity) -> tuple[str, ...]:
        """Return the movable anchors to take away before `activity` can be done from anywhere; empty if it is free."""
        ...
