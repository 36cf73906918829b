"""Keys of activities, and the other sides from which a target can be seen."""

import math
from collections.abc import Sequence

from skolem.traces.messages import Activity

Question = tuple[str, ...]

OTHER_SIDE_RAD = 0.5  # after a look in vain, the next look is from a direction that differs by so much


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
