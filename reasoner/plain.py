"""A belief with a neutral answer to every question. May import: protocols.

One's own belief derives from `PlainBelief` and overrides what it knows better.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from skolem.reasoner.protocols import Gaussian
from skolem.traces.messages import Hand, Meaning, Quantity

DIMENSIONS: Final[dict[Quantity, int]] = {"pose": 3, "colour": 3, "weight": 1}


@dataclass(frozen=True, slots=True)
class Normal:
    """A Gaussian given by its numbers, with the units of `Gaussian`. Satisfies `Gaussian`.

    Attributes:
        mean: Shape (n,).
        covariance: Shape (n, n).
        probability: That the object exists at all.
    """

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    probability: float = 1.0


class PlainBelief:
    """A belief in an empty, completely known world, with sensors that never err. Satisfies `BeliefQueries`.

    Some answers follow from others, so that one override serves several questions: existence follows from `anchors`,
    `prob_on` from `support`.
    """

    @property
    def version(self) -> int:
        """0; a belief that changes returns another number after each change."""
        return 0

    def anchors(self) -> tuple[str, ...]:
        """No object."""
        return ()

    def prob_exists(self, anchor: str) -> float:
        """1 for every anchor, 0 for anything else."""
        return float(anchor in self.anchors())

    def prob_property(self, anchor: str, meaning: Meaning) -> float:
        """0: the object has no property."""
        return 0.0

    def support(self, anchor: str) -> str | None:
        """None: the object stands on the floor."""
        return None

    def prob_on(self, anchor: str, support: str) -> float:
        """1 for what `support` names, 0 for anything else."""
        return float(self.support(anchor) == support)

    def prob_near(self, anchor: str, other: str, distance_m: float) -> float:
        """1 for an object and itself, 0 for two objects."""
        return float(anchor == other)

    def prob_property_of_new(self, meaning: Meaning) -> float:
        """0: every object is known already."""
        return 0.0

    def regions(self) -> tuple[str, ...]:
        """No region: nothing has to be searched."""
        return ()

    def region_support(self, region: str) -> str:
        """Refuse the region, since there is none.

        Raises:
            KeyError: Always.
        """
        raise KeyError(region)

    def prob_contents(self, region: str) -> float:
        """1: everything has been seen."""
        return 1.0

    def prob_exists_in(self, region: str, match: float) -> float:
        """0: no object is left to be found."""
        return 0.0

    def graspable(self, anchor: str) -> bool:
        """True for every anchor, False for anything else."""
        return anchor in self.anchors()

    def held(self, hand: Hand) -> str | None:
        """None: the hand is empty."""
        return None

    def gaussian(self, quantity: Quantity, anchor: str) -> Gaussian:
        """The value 0 without variance; shapes (n,) and (n, n), n = 3 for pose and colour, 1 for weight."""
        n = DIMENSIONS[quantity]
        return Normal(np.zeros(n), np.zeros((n, n)), self.prob_exists(anchor))

    def observation_covariance(
        self, quantity: Quantity, anchor: str, at: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Zero, shape (n, n) as for `gaussian`: an observation has no error."""
        return np.zeros((DIMENSIONS[quantity], DIMENSIONS[quantity]))

    def prob_detected(self, anchor: str) -> float:
        """1: a look reports every object in view."""
        return 1.0

    def prob_type_right(self) -> float:
        """1: a look reports the true type."""
        return 1.0

    def prob_favourable(self, anchor: str, meaning: Meaning, p: float) -> float:
        """1: one observation of a property is proof of it."""
        return 1.0
