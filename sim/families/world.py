"""A world while it is drawn: objects, prior, moves and goal, as plain values."""

from dataclasses import dataclass, field

from skolem.sim.families.goals import Clause
from skolem.sim.families.ranges import Variant
from skolem.sim.families.sentences import Sentence
from skolem.sim.families.things import Thing
from skolem.traces.messages import Pose2


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
        sentence: The goal instead, if it has a construct beyond lambda.
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
    sentence: Sentence | None = None
    bound: float = 0.9
    placed: float = 0.9
