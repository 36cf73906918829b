"""Bounds and quantities of recorded terms in words: probabilities, lengths, angles, colours and weights.

Terms hold whole numbers: probabilities as -ln p in millionths, everything else in thousandths.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Final

from skolem.traces.messages import ColourMeaning
from skolem.traces.wording.recorded import Recorded

_DEGREES_OF_A_TURN: Final = 360.0
_ALIKE: Final = 0.3  # a larger standard deviation of ln(kg) is given as a factor, a smaller one in percent


def probability(micronats: int) -> str:
    """Return the probability with -ln p = `micronats` millionths, to two digits of p or of 1 - p: `.9`, `.068`."""
    p = math.exp(-micronats / 1e6)
    if p in (0.0, 1.0):
        return f"{p:.0f}"
    least = min(p, 1.0 - p)
    digits = 1 - math.floor(math.log10(least))
    text = f"{p:.1e}" if p < 1e-4 else f"{p:.{digits}f}".rstrip("0")
    return text.removeprefix("0") if p < 1.0 else text


def pose_spread(sd: Sequence[Recorded]) -> str:
    """Return the uncertainty of a pose: `8 mm and 9 degrees`; `sd` has standard deviations of x, y and the heading."""
    x, y, heading = (each.number for each in sd)
    parts = [f"{x} mm"] if x is not None and x == y else []
    if not parts:
        parts = [f"{value} mm in {axis}" for value, axis in ((x, "x"), (y, "y")) if value is not None]
    if heading is not None:
        parts.append(f"{math.degrees(heading / 1000.0):.0f} degrees")
    return listed(parts)


def pose_place(mean: Sequence[Recorded]) -> str:
    """Return the values of a pose: `x 1.20 m, y 0.10 m, 90 degrees`."""
    x, y, heading = (each.number or 0 for each in mean)
    return f"x {x / 1000.0:.2f} m, y {y / 1000.0:.2f} m, {math.degrees(heading / 1000.0):.0f} degrees"


def colour_spread(sd: Sequence[Recorded]) -> str:
    """Return the uncertainty of a colour, in degrees of hue and percent of saturation and value."""
    hue, saturation, value = (each.number for each in sd)
    parts = [] if hue is None else [f"{hue / 1000.0 * _DEGREES_OF_A_TURN:.0f} degrees of hue"]
    parts += [] if saturation is None else [f"{saturation / 10.0:.0f} % of saturation"]
    parts += [] if value is None else [f"{value / 10.0:.0f} % of value"]
    return listed(parts)


def colour_place(mean: Sequence[Recorded], colours: Mapping[str, ColourMeaning]) -> str:
    """Return a colour as the first word by alphabet that contains it, otherwise in numbers."""
    hue, saturation, value = ((each.number or 0) / 1000.0 for each in mean)
    for word, volume in sorted(colours.items()):
        if volume.contains((hue % 1.0, saturation, value)):
            return spaced(word)
    turn = hue % 1.0 * _DEGREES_OF_A_TURN
    return f"hue {turn:.0f} degrees, saturation {100.0 * saturation:.0f} %, value {100.0 * value:.0f} %"


def weight(log_kg: Recorded) -> str:
    """Return a weight."""
    return _weight((log_kg.number or 0) / 1000.0)


def weight_spread(sd: Recorded) -> str:
    """Return the uncertainty of a weight, in percent, or as a factor if it is large."""
    spread = (sd.number or 0) / 1000.0
    return f"{100.0 * spread:.0f} %" if spread < _ALIKE else f"a factor of {math.exp(spread):.1f}"


def weight_range(mean: Recorded, tolerance: Recorded) -> str:
    """Return a range of weights."""
    middle, around = (mean.number or 0) / 1000.0, (tolerance.number or 0) / 1000.0
    return f"{_weight(middle - around)} and {_weight(middle + around)}"


def _weight(log_kg: float) -> str:
    kg = math.exp(log_kg)
    return f"{kg:.1f} kg" if kg >= 1.0 else f"{1000.0 * kg:.0f} g"


def listed(parts: Sequence[str]) -> str:
    """Return several texts as one list: `a`, `a and b`, `a, b and c`."""
    return " and ".join(filter(None, (", ".join(parts[:-1]), parts[-1]))) if parts else ""


def spaced(word: str) -> str:
    """Return a name of the rules, `soda_box`, or of goals, `SodaBox`, as words: `soda box`."""
    return "".join(f" {c.lower()}" if c.isupper() else c for c in word).replace("_", " ").strip()
