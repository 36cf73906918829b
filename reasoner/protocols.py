"""What the reasoner asks of others: a belief to query and a geometry to consult.

`skolem.estimation.Belief` satisfies `BeliefQueries`; `skolem.sim.planning` and `skolem.sim.symbolic` satisfy
`Geometry`. Tests satisfy both with a table.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Belief, Command, Hand, Meaning, MoveBase, Quantity


@dataclass(frozen=True, slots=True)
class Gaussian:
    """A Gaussian belief on one quantity of one object.

    Attributes:
        mean: Shape (n,). pose: x, y, theta of base_T_object (m, rad); colour: hue, saturation, value (0..1);
            weight: ln(kg).
        covariance: Shape (n, n), same units squared. pose: tangent space of the mean, object frame.
        probability: Mixture weight P_b: that the object exists at all.
    """

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    probability: float


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
        """P(the object rests wholly on the top of `support`); 0 while it is held."""
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
        kind: "look", "pick", "place" or "weigh".
        anchor: The object it is about.
        hand: The hand that does it; None for a look.
        support: Where to place; None otherwise.
    """

    kind: str
    anchor: str
    hand: Hand | None = None
    support: str | None = None

    def __str__(self) -> str:
        """Return `pick(right, o2)` and the like."""
        return f"{self.kind}({', '.join(x for x in (self.hand, self.anchor, self.support) if x)})"


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
