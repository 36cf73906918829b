"""The verdict of the simulator in words."""

from collections.abc import Iterable

from skolem.traces.messages import Displaced


def displaced_text(displaced: Iterable[Displaced]) -> str:
    """Return what the robot displaced without intent and how far each object was moved; empty if there is nothing."""
    return ", ".join(f"{item.id} by {item.distance_m:.2f} m" for item in displaced)
