"""The questions that the reasoner asks of the belief and of the geometry.

`skolem.estimation.Belief` satisfies `BeliefQueries`; `PlanningWorld` and `SymbolicGeometry` of `skolem.sim` satisfy
`Geometry`. Tests satisfy both with a table.

May import: nothing.
"""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from skolem.traces.messages import Activity, Belief, Command, Hand, Meaning, MoveBase, Quantity, Relation, Strangers


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


class GroundBeliefs(Protocol):
    """The questions about known objects; denotation needs no others."""

    @property
    def version(self) -> int:
        """Number of events applied so far."""
        ...

    def anchors(self) -> tuple[str, ...]:
        """Every anchor believed to exist, in order of introduction."""
        ...

    def prob_exists(self, anchor: str) -> float:
        """P(the object exists); 0 for an unknown anchor."""
        ...

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """P(the object has the property), given that it exists."""
        ...

    def prob_on(self, anchor: str, support: str) -> float:
        """P(the object rests wholly on the top of `support`), given that both exist; 0 while a hand holds it."""
        ...

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """P(the middles of two objects are at most `distance_m` apart in the plane), given that both exist."""
        ...


class OpenBeliefs(GroundBeliefs, Protocol):
    """Beliefs about known objects and about objects that are not met yet."""

    def prob_property_of_new(self, meaning: Meaning) -> float:
        """P(an arbitrary object that is not met yet has the property)."""
        ...

    def region_support(self, region: str) -> str:
        """The anchor on whose top the region lies."""
        ...


class RelationModel(Protocol):
    """The joint distribution of the truth of several relations, as a function of independent uniform numbers."""

    @property
    def dimension(self) -> int:
        """The number of uniform numbers."""
        ...

    def settled(self) -> NDArray[np.int8]:
        """1 for a relation that surely holds, -1 for one that surely does not, 0 for any other, shape (relations,).

        Sure is what fails with a chance of 1e-9 at most.
        """
        ...

    def truth(self, uniforms: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether each relation holds, shape (n, relations), for numbers in (0, 1), shape (n, dimension)."""
        ...


@runtime_checkable
class WorldBeliefs(Protocol):
    """What only the evaluation by possible worlds asks; a belief without it has independent relations."""

    def relations(self, asked: Sequence[Relation]) -> RelationModel:
        """The joint distribution of relations between objects that exist."""
        ...

    def strangers(self) -> tuple[Strangers, ...]:
        """The objects that nobody has met, for each region, in order of introduction."""
        ...

    def prob_property_of_new(self, meaning: Meaning) -> float:
        """P(an arbitrary object that is not met yet has the property)."""
        ...


@runtime_checkable
class EarlierBeliefs(Protocol):
    """What only goals about the start of a run ask; in a belief without it nothing was moved since."""

    def prob_was_on(self, anchor: str, support: str) -> float:
        """`prob_on` of the time before the robot first moved the objects."""
        ...

    def prob_was_near(self, anchor: str, other: str, distance_m: float) -> float:
        """`prob_near` of the time before the robot first moved the objects."""
        ...


class BeliefQueries(OpenBeliefs, Protocol):
    """Pure questions about the belief; equal `version` means equal answers."""

    def support(self, anchor: str) -> str | None:
        """The most likely support of the object; None for the floor, for a hand, and if nothing is known."""
        ...

    def regions(self) -> tuple[str, ...]:
        """Every region of space that can be searched, in order of introduction."""
        ...

    def prob_contents(self, region: str) -> float:
        """BContents: the seen share of the region, without the space of known objects."""
        ...

    def prob_exists_in(self, region: str, match: float) -> float:
        """P(the unseen part of the region holds an object of some kind); `match` is P(an arbitrary object is of it)."""
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

    def observation_covariance(
        self, quantity: Quantity, anchor: str, at: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Covariance of one observation of the quantity, in the space of `gaussian`, if its value is `at`.

        None: at the mean of the belief. A pose is always observed at the mean.
        """
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


class Geometry(Protocol):
    """Answers about the belief of the last `sync`; each is a pure function of (belief, question, run seed)."""

    def sync(self, belief: Belief) -> None:
        """Take over the believed world; every later answer is about it."""
        ...

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from where the robot stands, or None if there is none."""
        ...

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a drive to a base pose from which `activity` can be done; for pick and place, its object is seen."""
        ...

    def tried(self, activity: Activity) -> int:
        """Return at how many stances motions were sought in vain before `approach` gave up; its budget is spent.

        0 if it found a drive, or showed that none of its stances can serve.
        """
        ...

    def blockers(self, activity: Activity) -> tuple[str, ...] | None:
        """Return the movable anchors that block `activity` from every base pose; empty if nothing blocks it.

        The object of a place need not be in a hand; None: there is no room for it, whatever is taken away.
        """
        ...
