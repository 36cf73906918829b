"""A world while it is drawn: objects, prior, moves and goal, as plain values."""

from dataclasses import dataclass, field

from skolem.sim.families.goals import Clause
from skolem.sim.families.ranges import Variant
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


@dataclass(frozen=True, slots=True)
class PriorThing:
    """The prior of one object: its place is drawn around the truth by the run or, with `at`, is wrong."""

    id: str
    types: dict[str, float]
    at: Pose2 | None = None
    on: str | None = None
    sd_xy_m: float | None = None
    sd_theta_rad: float | None = None


@dataclass(frozen=True, slots=True)
class Move:
    """A move of an object from outside, just before an action of the robot."""

    before_step: int
    id: str
    on: str
    at: Pose2


@dataclass(slots=True)
class World:
    """The content of a scenario of a family.

    Attributes:
        family: Its name.
        seed: Its number.
        variant: The ranges it is drawn from.
        tables: Tables on the floor, in order.
        things: Objects on the tables, in order.
        prior: Priors of all objects, tables first.
        expected: Prior mean number of strangers per table.
        moves: The moves in order of time.
        clauses: The clauses of the goal.
    """

    family: str
    seed: int
    variant: Variant
    tables: list[Thing] = field(default_factory=list)
    things: list[Thing] = field(default_factory=list)
    prior: list[PriorThing] = field(default_factory=list)
    expected: dict[str, float] = field(default_factory=dict)
    moves: list[Move] = field(default_factory=list)
    clauses: tuple[Clause, ...] = ()
    bound: float = 0.9
    placed: float = 0.9
