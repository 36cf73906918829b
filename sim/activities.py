"""What the reasoner asks about: something to be done from a base pose."""

from dataclasses import dataclass
from typing import Protocol

from skolem.traces.messages import Hand

Question = tuple[str, ...]


class Activity(Protocol):
    """Something to be done from a base pose: look, look_region, pick, place or weigh."""

    @property
    def kind(self) -> str:
        """What is to be done."""
        ...

    @property
    def anchor(self) -> str:
        """The object it is about; the region for look_region."""
        ...

    @property
    def hand(self) -> Hand | None:
        """The hand that does it."""
        ...

    @property
    def support(self) -> str | None:
        """Where to place."""
        ...

    @property
    def clear_of(self) -> "Activity | None":
        """What the object must not stand in the way of when it is placed."""
        ...


@dataclass(frozen=True, slots=True)
class Picking:
    """The picking of an object with a hand."""

    anchor: str
    hand: Hand
    kind: str = "pick"
    support: str | None = None
    clear_of: Activity | None = None


def key_of(activity: Activity) -> Question:
    """Return what tells an activity from all others."""
    nested = () if activity.clear_of is None else key_of(activity.clear_of)
    return (activity.kind, activity.anchor, activity.hand or "", activity.support or "", *nested)
