"""The belief as the paper prints it: anchor, type d, pose d, color d, weight d, where d is for distribution.

The words low, med and high describe the variance: low is well known. A colour or weight that is neither given in the
prior nor measured is printed as `prior`, and the pose of a held object as `in hand`.
"""

import math
from collections.abc import Mapping

from skolem.traces.messages import Belief, ColourMeaning, HsvBelief, Meaning, ObjectBelief
from skolem.traces.messages.likeliest import likeliest

COLUMNS = ("anchor", "type d", "pose d", "color d", "weight d")
POSE_SD_M = (0.01, 0.05)  # below the first a variance is low, above the second high
COLOUR_SD = (0.05, 0.15)  # sd of the hue
WEIGHT_SD = (0.12, 0.40)  # sd of ln(kg): about that share of the weight


def belief_rows(belief: Belief, meanings: Mapping[str, Meaning]) -> list[tuple[str, ...]]:
    """Return one row per anchor, in order of introduction, with cells in the order of `COLUMNS`."""
    return [(anchor, *object_cells(belief.objects[anchor], meanings)) for anchor in belief.anchors]


def object_cells(known: ObjectBelief, meanings: Mapping[str, Meaning]) -> tuple[str, str, str, str]:
    """Return the cells of one object: all columns but the anchor."""
    return _type(known), _pose(known), _colour(known, meanings), _weight(known)


def table_lines(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    """Return a table as lines of text, each column as wide as its widest cell."""
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in (heads, *rows)]


def size_of(sd: float, bounds: tuple[float, float]) -> str:
    """Return low, med or high for the variance with a standard deviation."""
    return "low" if sd < bounds[0] else "med" if sd <= bounds[1] else "high"


def colour_name(colour: HsvBelief, meanings: Mapping[str, Meaning]) -> str:
    """Return the first colour word by alphabet that contains the mean; otherwise the mean in degrees and percent."""
    h, s, v = colour.mean
    for word, meaning in sorted(meanings.items()):
        if isinstance(meaning, ColourMeaning) and meaning.contains((h % 1.0, s, v)):
            return word
    return f"hsv {360.0 * (h % 1.0):.0f} {100.0 * s:.0f}% {100.0 * v:.0f}%"


def probability(p: float) -> str:
    """Return a probability with two digits and without the leading zero."""
    return f"{p:.2f}".replace("0.", ".")


def _type(known: ObjectBelief) -> str:
    name = likeliest(known.type)
    return f"{name}, {probability(known.type[name])}"


def _pose(known: ObjectBelief) -> str:
    if known.in_hand is not None:
        return "in hand"
    x, y = (round(value, 2) + 0.0 for value in known.world_T_object[:2])  # + 0.0: no minus before a zero
    a, b, _, c, _, _ = known.covariance
    largest = (a + c) / 2.0 + math.hypot((a - c) / 2.0, b)
    return f"({x:.2f}, {y:.2f}), {size_of(math.sqrt(max(0.0, largest)), POSE_SD_M)}"


def _colour(known: ObjectBelief, meanings: Mapping[str, Meaning]) -> str:
    if not known.colour_seen:
        return "prior"
    return f"{colour_name(known.colour, meanings)}, {size_of(math.sqrt(known.colour.variance[0]), COLOUR_SD)}"


def _weight(known: ObjectBelief) -> str:
    if not known.weighed:
        return "prior"
    mean, variance = known.log_weight
    return f"{1000.0 * math.exp(mean):.0f} g, {size_of(math.sqrt(variance), WEIGHT_SD)}"
