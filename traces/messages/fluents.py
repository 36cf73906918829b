"""Fluents as people read them."""

import math
import re

_BELIEF = re.compile(r"^b\((.*),(\d+)\)$")


def readable(fluent: str) -> str:
    """Return a fluent with its bound as a probability: `b(krd(o2),105361)` becomes `B(krd(o2), .900)`."""
    belief = _BELIEF.match(fluent)
    if belief is None:
        return fluent
    p = math.exp(-int(belief[2]) / 1e6)
    return f"B({belief[1]}, {f'{p:.3f}'.removeprefix('0')})"
