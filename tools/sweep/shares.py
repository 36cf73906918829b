"""Shares with their intervals."""

import math
import statistics
from typing import Final

CONFIDENCE: Final = 0.95  # level of the intervals


def wilson(hits: int, of: int) -> tuple[float, float]:
    """Return Wilson's score interval of a share, at `CONFIDENCE` (J. Am. Stat. Assoc. 22, 1927)."""
    if of == 0:
        return (0.0, 1.0)
    z = statistics.NormalDist().inv_cdf((1.0 + CONFIDENCE) / 2.0)
    share, scale = hits / of, 1.0 + z * z / of
    middle = (share + z * z / (2 * of)) / scale
    reach = z / scale * math.sqrt(share * (1.0 - share) / of + z * z / (4 * of * of))
    return (max(0.0, middle - reach), min(1.0, middle + reach))
