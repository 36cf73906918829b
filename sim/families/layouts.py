"""Layouts of objects on tables, one for each kind of family, with the prior of the objects' types."""

from collections.abc import Mapping
from functools import partial

from numpy.random import Generator

from skolem.sim.families import places
from skolem.sim.families.bodies import CROWD, ROUND, SHORT, STRANGERS, TALL, colour, shares_around, type_of, weight
from skolem.sim.families.draws import Stream, between, pick, poisson
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.families.world import World
from skolem.traces.messages import Pose2

GRASPABLE = ("bottle", "can", "carton", "soda")
DEEPEST, MOST_ROWS = (2, 5), 3
ROW_GAP_M = 0.015  # least gap between objects of rows
CRATE_HSV, CRATE_KG = (0.1, 0.05, 0.9), 5.0
MIDDLE_M = 0.08  # greatest distance of an unreachable object from the middle of its table
HIDDEN_GAP_M = 0.12  # around a hidden object
HIDDEN_X = (-0.12, 0.0)  # range of its x
CROWD_TOLD = 3
CROWD_MEANS = (14.0, 20.0, 26.0)


class Standing:
    """The objects of one attempt at a world, put down one after another.

    Attributes:
        shares: Prior of the type of each object; None for strangers.
    """

    def __init__(self, world: World, words: Words, draws: Mapping[Stream, Generator]) -> None:
        """Begin with a world that has its tables."""
        self._world, self._variant, self._words, self._draws = world, world.variant, words, draws
        self.shares: dict[str, dict[str, float] | None] = {}

    def put(self, source: str, target: str, others: list[str]) -> None:
        """Put objects on tables: those of the prior and, as many as it expects, strangers.

        Args:
            source: The table that the family is about.
            target: The table that the goal is about.
            others: The other tables that objects may stand on.

        Raises:
            NoPlaceError: If an object does not find a place.
        """
        variant = self._variant
        if variant.impossible == "no_room":
            self._crates(target)
        if not variant.room_elsewhere:
            self._crates(others[0])
        if variant.layout == "crowd":
            self._crowd(target if variant.crowded == "target" else source, source)
            return
        strangers = self._numbers_of_strangers()
        count = int(self._draws[Stream.THINGS].integers(variant.things[0], variant.things[1] + 1))
        match variant.layout:
            case "rows":
                self._rows(source)
            case "behind":
                self._groups(source, count)
            case "clutter":
                self._clutter(source, count)
            case "spread":
                self._spread(source, [source, *others], max(1, count - sum(strangers.values())))
        self._strangers(strangers)

    def _thing(self, on: str, at: Pose2, kind: str, shares: dict[str, float] | None) -> Thing:
        """Put an object of a type at a place; with shares, it is in the prior."""
        draw = self._draws[Stream.THINGS]
        number = 1 + sum((self.shares.get(thing.id) is None) == (shares is None) for thing in self._world.things)
        name = f"{'stranger' if shares is None else 'thing'}{number}"
        hsv, kg = colour(draw, self._variant, self._words), weight(draw, self._variant, self._words)
        thing = Thing(name, kind, on, at, hsv, kg)
        self._world.things.append(thing)
        self.shares[name] = shares
        return thing

    def _drawn_type(
        self, likeliest: tuple[str, ...], others: tuple[str, ...] = GRASPABLE
    ) -> tuple[str, dict[str, float]]:
        shares = shares_around(self._draws[Stream.THINGS], likeliest, others)
        return type_of(self._draws[Stream.THINGS], shares), shares

    def _freely(self, on: str, kind: str, whole: bool = False) -> Pose2:
        draw, what = self._draws[Stream.PLACES], self._words.types[kind]
        return places.free_place(
            what,
            on,
            self._world.things,
            self._variant.gap_m[0],
            self._words,
            partial(places.anywhere, draw, what, whole),
        )

    def _spread(self, source: str, tables: list[str], count: int) -> None:
        """Put objects on all tables but the target, the first on the source."""
        draw = self._draws[Stream.THINGS]
        for i in range(count):
            kind, shares = self._drawn_type(GRASPABLE)
            if self._variant.impossible == "nothing_reached":
                on = source if i == 0 else tables[-1]
                at = self._middle(kind) if i == 0 else self._freely(on, kind)
            else:
                on = source if i == 0 else pick(draw, tables)
                at = self._freely(on, kind)
            self._thing(on, at, kind, shares)

    def _middle(self, kind: str) -> Pose2:
        draw = self._draws[Stream.PLACES]
        x, y = (between(draw, -MIDDLE_M, MIDDLE_M) for _ in range(2))
        return x, y, places.turned(draw, self._words.types[kind])

    def _clutter(self, on: str, count: int) -> None:
        draw, variant = self._draws[Stream.PLACES], self._variant
        for i in range(count):
            kind, shares = self._drawn_type(GRASPABLE)
            what, group = self._words.types[kind], [t for t in self._world.things if t.on == on]
            if i == 0:
                at = self._freely(on, kind)
            else:
                at = places.free_place(
                    what,
                    on,
                    self._world.things,
                    variant.gap_m[0],
                    self._words,
                    partial(places.beside, draw, what, group, variant.gap_m, self._words),
                )
            self._thing(on, at, kind, shares)

    def _crowd(self, on: str, source: str) -> None:
        """Put many objects of one kind on a table; the prior has a few of them, and their mean number."""
        draw, (low, high) = self._draws[Stream.THINGS], self._variant.things
        count, mean = poisson(draw, pick(draw, CROWD_MEANS), low - CROWD_TOLD, high - CROWD_TOLD)
        for i in range(CROWD_TOLD + count):
            kind = type_of(draw, CROWD)
            self._thing(on, self._freely(on, kind, whole=True), kind, dict(CROWD) if i < CROWD_TOLD else None)
        self._world.expected = {table.id: 0.0 for table in self._world.tables} | {on: mean}
        if on != source:
            kind, shares = self._drawn_type(GRASPABLE)
            self._thing(source, self._freely(source, kind), kind, shares)

    def _rows(self, on: str) -> None:
        draw = self._draws[Stream.THINGS]
        deepest = int(draw.integers(DEEPEST[0], DEEPEST[1] + 1))
        low, high = self._variant.things
        count = min(high, max(low, deepest * int(draw.integers(1, MOST_ROWS + 1))))
        kinds = [self._drawn_type(ROUND, ROUND) for _ in range(count)]
        widths = [max(self._words.types[kind].size_m[:2]) for kind, _ in kinds]
        spots = places.rows(self._draws[Stream.PLACES], count, deepest, self._variant.gap_m, widths)
        for at, (kind, shares) in zip(spots, kinds, strict=True):
            if not places.is_free(self._words.types[kind], on, at, self._world.things, ROW_GAP_M, self._words):
                raise places.NoPlaceError(on)
            self._thing(on, at, kind, shares)

    def _groups(self, on: str, count: int) -> None:
        """Put short objects on a table with tall ones before them."""
        draw, variant = self._draws[Stream.PLACES], self._variant
        while sum(thing.on == on for thing in self._world.things) < count:
            kind, shares = self._drawn_type(SHORT)
            hidden = self._thing(
                on,
                places.free_place(
                    self._words.types[kind],
                    on,
                    self._world.things,
                    HIDDEN_GAP_M,
                    self._words,
                    partial(self._far_in, kind),
                ),
                kind,
                shares,
            )
            kind, shares = self._drawn_type(TALL)
            what = self._words.types[kind]
            at = places.free_place(
                what,
                on,
                self._world.things,
                variant.gap_m[0] / 2.0,
                self._words,
                partial(places.before, draw, what, hidden, variant.gap_m, self._words),
            )
            self._thing(on, at, kind, shares)

    def _far_in(self, kind: str) -> Pose2:
        draw = self._draws[Stream.PLACES]
        return between(draw, *HIDDEN_X), between(draw, *places.NEAR_Y), places.turned(draw, self._words.types[kind])

    def _crates(self, on: str) -> None:
        crate, table = self._words.types["crate"], self._words.types["table"]
        for at in places.crates(self._draws[Stream.PLACES], crate, table):
            number = 1 + sum(thing.type == "crate" for thing in self._world.things)
            self._world.things.append(Thing(f"crate{number}", "crate", on, at, CRATE_HSV, CRATE_KG))
            self.shares[f"crate{number}"] = {"crate": 1.0}

    def _numbers_of_strangers(self) -> dict[str, int]:
        """Return the number of strangers on each table, and keep the mean number that the prior states."""
        draw, (mean, most) = self._draws[Stream.THINGS], self._variant.strangers
        numbers = {table.id: poisson(draw, mean, 0, most) for table in self._world.tables}
        self._world.expected = {name: expected for name, (_, expected) in numbers.items()}
        return {name: count for name, (count, _) in numbers.items()}

    def _strangers(self, numbers: Mapping[str, int]) -> None:
        """Put the given number of strangers on each table."""
        for name, count in numbers.items():
            for _ in range(count):
                kind = type_of(self._draws[Stream.THINGS], STRANGERS)
                self._thing(name, self._freely(name, kind), kind, None)
