"""The activity that the reasoner asks a geometry about. A trace records it only as text, in questions of /geometry.

So it is a dataclass without canonical bytes and checks on reading: a model takes twice as long to make.
"""

from dataclasses import dataclass

from skolem.traces.messages.base import Hand


@dataclass(frozen=True, slots=True)
class Activity:
    """An activity of the robot at a base pose.

    Attributes:
        kind: "look", "look_region", "pick", "place" or "weigh".
        anchor: The object of the activity; the region for look_region.
        hand: The hand of a pick, place or weigh; None for a look.
        support: The support of a place; None otherwise.
        clear_of: An activity that the placed object must not stand in the way of; None if there is none.
        elsewhere: Whether the activity was done from here in vain, so that other base poses are to be preferred.
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
        text = f"{self.kind}({', '.join(str(x) for x in arguments if x is not None)})"
        return f"{text} from elsewhere" if self.elsewhere else text
