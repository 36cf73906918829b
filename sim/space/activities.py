"""Activities: the subject of the reasoner's questions to the geometry."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from skolem.traces.messages import Hand

Question = tuple[str, ...]

OTHER_SIDE_RAD = 0.5  # after a look in vain, the next look is from a direction that differs by so much


class Activity(Protocol):
    """An activity of the robot at a base pose: look, look_region, pick, place or weigh."""

    @property
    def kind(self) -> str:
        """The kind of activity."""
        ...

    @property
    def anchor(self) -> str:
        """The object of the activity; the region for look_region."""
        ...

    @property
    def hand(self) -> Hand | None:
        """The hand of the activity."""
        ...

    @property
    def support(self) -> str | None:
        """The support of a place."""
        ...

    @property
    def clear_of(self) -> "Activity | None":
        """An activity that the placed object must not stand in the way of."""
        ...

    @property
    def elsewhere(self) -> bool:
        """Whether the activity was done from here in vain."""
        ...


@dataclass(frozen=True, slots=True)
class Picking:
    """The picking of an object with a hand."""

    anchor: str
    hand: Hand
    kind: str = "pick"
    support: str | None = None
    clear_of: Activity | None = None
    elsewhere: bool = False


def key_of(activity: Activity) -> Question:
    """Return the key that identifies an activity."""
    nested = () if activity.clear_of is None else key_of(activity.clear_of)
    where = "elsewhere" if activity.elsewhere else ""
    return (activity.kind, activity.anchor, activity.hand or "", activity.support or "", where, *nested)


def is_other_side(position: Sequence[float], here: Sequence[float], target: Sequence[float]) -> bool:
    """Return whether a target is seen from another side at `position` than from `here`; only x and y count."""
    seen = math.atan2(position[1] - target[1], position[0] - target[0])
    turn = seen - math.atan2(here[1] - target[1], here[0] - target[0])
    return abs(math.remainder(turn, 2.0 * math.pi)) >= OTHER_SIDE_RAD
