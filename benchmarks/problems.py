"""The paper's illustrative example with any number of objects, for the reasoner and, as PDDL, for its peers.

Objects stand in rows of five on tables; to take one, the robot first takes away those before it. Some are cans, some
are green, and each may be heavy. Unseen regions may hold a heavy green can. In state "a" some known object may be
meant; in state "b" all of them have been found light, and only searching is left.
"""

import math
from dataclasses import dataclass
from typing import Final, Literal

from numpy.random import PCG64, Generator, SeedSequence

State = Literal["a", "b"]
GOAL: Final = "exists o. B(Den(lambda x. Can(x) & Green(x) & Heavy(x), o), 0.9) & B(On(o, desk), 0.9)"
ROW: Final = 5
ROOM_M: Final = 6.0
UNLIKELY: Final = 0.02  # P(can) of a carton, P(green) of a blue object


@dataclass(frozen=True, slots=True)
class Item:
    """A known object: P of each property, its table, and the objects before it, the nearest one last."""

    name: str
    table: str
    before: tuple[str, ...]
    can: float
    green: float
    heavy: float

    @property
    def meant(self) -> float:
        """P(it is a heavy green can)."""
        return self.can * self.green * self.heavy


@dataclass(frozen=True, slots=True)
class Problem:
    """One instance of the example.

    Attributes:
        items: The known objects.
        tables: The tables on which they stand.
        regions: P(a heavy green can is in it), by region; each lies on a support of its own.
        places: Position of the desk and of every table and support, metres.
        home: Position of the robot at the start, metres.
    """

    items: tuple[Item, ...]
    tables: tuple[str, ...]
    regions: dict[str, float]
    places: dict[str, tuple[float, float]]
    home: tuple[float, float]


def problem(n: int, state: State, seed: int) -> Problem:
    """Return the instance with n known objects and max(2, n // 6) regions."""
    draw = Generator(PCG64(SeedSequence([n, seed, "ab".index(state)])))
    row = 3 if n <= 3 else ROW
    tables = tuple(f"table{k + 1}" for k in range(math.ceil(n / row)))
    items: list[Item] = []
    for i in range(n):
        can, green = (i % 3 > 0, i % 3 < 2) if n <= 3 else (draw.random() < 2 / 3, draw.random() < 2 / 3)
        first = i - i % row
        items.append(
            Item(
                name=f"o{i + 1}",
                table=tables[i // row],
                before=tuple(f"o{j + 1}" for j in range(first, i)),
                can=float(draw.uniform(0.7, 0.95)) if can else UNLIKELY,
                green=float(draw.uniform(0.7, 0.95)) if green else UNLIKELY,
                heavy=float(draw.uniform(0.2, 0.5)) if state == "a" else 0.0,
            )
        )
    regions = {f"_reg{k + 1}_": float(draw.uniform(0.05, 0.3)) for k in range(max(2, n // 6))}
    stands = ("desk", *tables, *(support(region) for region in regions))
    places = {name: _somewhere(draw) for name in stands}
    return Problem(tuple(items), tables, regions, places, home=_somewhere(draw))


def support(region: str) -> str:
    """Return the name of the support of a region."""
    return f"shelf{region.removeprefix('_reg').removesuffix('_')}"


def _somewhere(draw: Generator) -> tuple[float, float]:
    return float(draw.uniform(0, ROOM_M)), float(draw.uniform(0, ROOM_M))
