"""The families: the variants of each, taken in turn over the seeds, and their ranges.

docs/families.md shows these numbers. They were fixed before the first run was measured on them; change them only with a
new name, since a family and a seed name a world.
"""

from dataclasses import dataclass, replace
from typing import Literal

Range = tuple[float, float]
Layout = Literal["spread", "clutter", "crowd", "behind", "rows"]
Proof = Literal["nothing_fits", "too_few_fit", "too_many_fit", "nothing_reached", "no_room"]
Construct = Literal["not", "distinct", "the", "together", "at_least", "at_most", "exactly", "every", "not_exists"]


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours of objects: hue, saturation and value, each 0..1 and uniform within its range."""

    hue: Range = (0.0, 1.0)
    saturation: Range = (0.5, 1.0)
    value: Range = (0.4, 1.0)


@dataclass(frozen=True, slots=True)
class Variant:
    """One kind of world.

    Attributes:
        name: Name of the variant within its family.
        about: Its difficulty.
        tables: Number of tables around the robot.
        things: Least and greatest number of objects that hands can lift; with spread strangers included.
        strangers: Mean number per table of objects that are not in the prior, and the greatest number.
        layout: Arrangement of the objects.
        gap_m: Least gap between neighbours and, where they stand in groups, the greatest.
        margin_sd: Range of margins of colours and weights to borders of words, in standard deviations of one reading.
        palette: The colours of objects.
        sd_xy_m: Prior standard deviation of the places of objects, along each axis.
        off_m: Error of the prior places beyond that deviation; 0: they are drawn with the deviation alone.
        noise: Factor on the standard deviations of the sensors and the wheels.
        model_told: Whether the robot knows that factor.
        prior_median: Factor on the prior median of weights.
        prior_hue: Prior mean and standard deviation of the hue; None if the prior leaves it open.
        moves: Least and greatest number of moves of objects from outside.
        moved: Which objects move and to where: the witness alone or any, on its own table or to another one.
        crowded: The table with a crowd.
        room_elsewhere: Whether objects can be put on a table besides source and target.
        impossible: The reason why the goal cannot be achieved, if that is the purpose.
        construct: The construct of the goal; None: descriptions with lambda.
        steps: Limit of actions.
    """

    name: str
    about: str
    tables: int = 3
    things: tuple[int, int] = (3, 5)
    strangers: tuple[float, int] = (0.3, 2)
    layout: Layout = "spread"
    gap_m: Range = (0.08, 0.08)
    margin_sd: Range = (3.0, 99.0)
    palette: Palette = Palette()
    sd_xy_m: float = 0.03
    off_m: float = 0.0
    noise: float = 1.0
    model_told: bool = True
    prior_median: float = 1.0
    prior_hue: Range | None = None
    moves: tuple[int, int] = (0, 0)
    moved: Literal["witness", "anything"] = "anything"
    crowded: Literal["source", "target"] = "source"
    room_elsewhere: bool = True
    impossible: Proof | None = None
    construct: Construct | None = None
    steps: int = 100


_THREE = Variant("three", "Three tables around the robot, as in the paper.")
_MANY = Variant("eight", "Eight things on three tables.", things=(8, 8), steps=150)
_CLUTTER = Variant(
    "clutter",
    "Things on one table stand 5 to 15 cm apart.",
    things=(5, 8),
    strangers=(0.3, 1),
    layout="clutter",
    gap_m=(0.05, 0.15),
    sd_xy_m=0.015,
    steps=150,
)
_CROWD = Variant(
    "crowd", "12 to 30 things of one kind on one table.", things=(12, 30), layout="crowd", gap_m=(0.04, 0.04), steps=200
)
_BORDER = replace(_THREE, margin_sd=(1.0, 3.0), steps=150)
_FAR = replace(_THREE, about="Things are not where the robot is told.", strangers=(0.3, 1), steps=150)
_LANGUAGE: dict[Construct, str] = {
    "not": "Things that are not as a word says.",
    "distinct": "Two different things.",
    "the": "The only such thing; in some worlds there is none, or there are several.",
    "together": "A description and a place in one belief.",
    "at_least": "A least number of things.",
    "at_most": "A greatest number of things.",
    "exactly": "A number of things.",
    "every": "All things of a kind.",
    "not_exists": "No thing of a kind.",
}
_ROWS = Variant(
    "room",
    "Rows of things, up to five deep, with room on a third table.",
    things=(4, 12),
    strangers=(0.0, 0),
    layout="rows",
    gap_m=(0.02, 0.03),
    sd_xy_m=0.01,
    steps=200,
)

FAMILIES: dict[str, tuple[Variant, ...]] = {
    "three": (_THREE,),
    "many": (
        _MANY,
        replace(_MANY, name="twenty", about="Twenty things on six tables.", tables=6, things=(20, 20), steps=200),
    ),
    "clutter": (_CLUTTER,),
    "crowd": (
        _CROWD,
        replace(_CROWD, name="full", about="The crowd is on the table that the goal names.", crowded="target"),
    ),
    "noisy": tuple(
        replace(
            _THREE,
            name=f"x{factor:g}_{'told' if told else 'untold'}",
            about=f"Sensors and wheels err {factor:g} times as much{'' if told else ', which the robot is not told'}.",
            noise=factor,
            model_told=told,
            steps=200,
        )
        for factor in (2.0, 3.0)
        for told in (True, False)
    ),
    "border": (
        replace(_BORDER, name="near", about="Colours and weights 1 to 3 deviations from the border of their word."),
        replace(
            _BORDER,
            name="narrow",
            about="Colours of narrow words, 1 to 3 deviations from their border.",
            palette=Palette(hue=(0.03, 0.27), value=(0.3, 1.0)),
        ),
        replace(
            _BORDER,
            name="pale",
            about="Greys and pastels, 1 to 3 deviations from the border of their word.",
            palette=Palette(saturation=(0.0, 0.55), value=(0.4, 1.0)),
        ),
        replace(
            _BORDER,
            name="dark",
            about="Dark colours, 1 to 3 deviations from the border of their word.",
            palette=Palette(saturation=(0.4, 1.0), value=(0.05, 0.45)),
        ),
        replace(
            _THREE,
            name="prior",
            about="The robot is told wrong priors of colours and weights.",
            prior_median=2.5,
            prior_hue=(0.1, 0.15),
            steps=150,
        ),
    ),
    "far": (
        *(replace(_FAR, name=f"sd{100 * far:.0f}cm", sd_xy_m=far) for far in (0.3, 0.6, 1.0)),
        *(replace(_FAR, name=f"untold{100 * far:.0f}cm", sd_xy_m=0.03, off_m=far) for far in (0.3, 0.6, 1.0)),
    ),
    "disturbed": (
        replace(_THREE, name="moved", about="Somebody moves things about.", moves=(1, 3), steps=150),
        replace(
            _THREE,
            name="witness",
            about="Somebody moves the very thing again and again, out of the hand if it is there.",
            moves=(2, 3),
            moved="witness",
            steps=150,
        ),
    ),
    "behind": (
        Variant(
            "behind",
            "Tall things hide what stands behind them.",
            things=(4, 7),
            layout="behind",
            gap_m=(0.03, 0.08),
            sd_xy_m=0.015,
            steps=150,
        ),
    ),
    "rows": (
        _ROWS,
        replace(
            _ROWS,
            name="no_room",
            about="Rows of things, up to five deep; the third table is full of crates.",
            room_elsewhere=False,
        ),
    ),
    "impossible": (
        replace(_THREE, name="nothing_fits", about="No thing is as the goal says.", impossible="nothing_fits"),
        replace(
            _THREE,
            name="nothing_reached",
            about="What the goal means stands in the middle of nine tables that touch.",
            tables=3,
            strangers=(0.0, 0),
            impossible="nothing_reached",
        ),
        replace(
            _THREE,
            name="no_room",
            about="Crates that nobody can lift fill the table that the goal names.",
            strangers=(0.0, 0),
            impossible="no_room",
        ),
    ),
    "language": tuple(
        replace(_THREE, name=construct, about=about, things=(4, 6), construct=construct, steps=150)
        for construct, about in _LANGUAGE.items()
    ),
}
