"""What the robot displaced without intent, by the true states before and after its actions."""

import math
from collections.abc import Iterable
from typing import Final

from skolem.traces.messages import Displaced, TrueState

LEAST_M: Final = 0.01  # a shorter way is that of an object that settles


def displaced(before: TrueState, after: TrueState) -> tuple[Displaced, ...]:
    """Return every object that an action displaced without intent, in the order of the state.

    An object that a hand holds before or after the action is moved on purpose; any other is not.

    Args:
        before: The true state just before the action, after every disturbance from outside.
        after: The true state just after it.
    """
    earlier = {item.id: item for item in before.objects}
    found = []
    for item in after.objects:
        was = earlier.get(item.id)
        if was is None or was.in_hand or item.in_hand:
            continue
        distance_m = math.dist(was.world_T_object[:3], item.world_T_object[:3])
        if distance_m >= LEAST_M:
            found.append(Displaced(id=item.id, distance_m=distance_m))
    return tuple(found)


def in_all(each: Iterable[Displaced]) -> tuple[Displaced, ...]:
    """Return each displaced object once, sorted by name, with the sum of its ways."""
    ways: dict[str, float] = {}
    for item in each:
        ways[item.id] = ways.get(item.id, 0.0) + item.distance_m
    return tuple(Displaced(id=name, distance_m=way) for name, way in sorted(ways.items()))
