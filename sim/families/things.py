"""A true object of a world while it is drawn."""

from dataclasses import dataclass

from skolem.sim.families.words import Hsv
from skolem.traces.messages import Pose2


@dataclass(frozen=True, slots=True)
class Thing:
    """One true object.

    Attributes:
        id: Its name.
        type: Name of its object type.
        on: The table it stands on; None: the floor.
        at: x, y [m], theta [rad], from the middle of that table's top or, with None, in the world.
        hsv: Colour; None for tables.
        kg: Mass; None for tables.
    """

    id: str
    type: str
    on: str | None
    at: Pose2
    hsv: Hsv | None = None
    kg: float | None = None
