"""The known answer of a world: witnesses that make its goal true, or a proof that no object can.

It comes from the true world alone, by the geometry of `reaching` and `rooms`, never from a run of the product. If
neither can be shown, the world is drawn again.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from skolem.sim.families.goals import Body, Clause
from skolem.sim.families.places import is_free
from skolem.sim.families.ranges import Proof
from skolem.sim.families.reaching import Floor, in_the_way
from skolem.sim.families.rooms import GAP_M, never_room, spots, spread
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.families.world import World
from skolem.traces.messages import Pose2

MOST_CLEARED = 12  # objects that are put aside for one witness


@dataclass(frozen=True, slots=True)
class Witness:
    """An object for one variable of the goal.

    Attributes:
        variable: Variable of the goal.
        thing: Name of the object.
        margin_sd: Least margin by which it fits the description, in standard deviations of one reading.
        stand: world_T_base from which an arm reaches it.
        cleared: Objects to remove before from its way, or from its place on the target, in this order.
        room: Its place on the target; None if it is there already or the goal has no target.
        on: The table of that place, if the goal does not say it of the variable.
    """

    variable: str
    thing: str
    margin_sd: float
    stand: Pose2
    cleared: tuple[str, ...]
    room: Pose2 | None
    on: str | None = None


@dataclass(frozen=True, slots=True)
class Certificate:
    """The answer: a witness for each variable, or the reason why there is none."""

    witnesses: tuple[Witness, ...] = ()
    impossible: Proof | None = None


def judged(world: World, words: Words) -> Certificate | None:
    """Return the certificate that holds before and after all moves; None if none can be shown."""
    floor = Floor(world.tables, words)
    first = Judge(world, world.things, floor, words).certificate()
    moved = {move.id: (move.on, move.at) for move in world.moves}
    if first is None or not moved:
        return first
    after = [replace(t, on=moved[t.id][0], at=moved[t.id][1]) if t.id in moved else t for t in world.things]
    second = Judge(world, after, floor, words).certificate()
    return first if second is not None and second.impossible == first.impossible else None


def body(thing: Thing) -> Body:
    """Return the values of an object that descriptions are about."""
    return thing.type, thing.hsv, thing.kg


class Judge:
    """One arrangement of objects, for which witnesses or a proof are sought."""

    def __init__(self, world: World, things: Sequence[Thing], floor: Floor, words: Words) -> None:
        self._world, self._words = world, words
        self._tables = {table.id: table for table in world.tables}
        self._things = list(things)
        self._floor = floor

    def certificate(self) -> Certificate | None:
        """Return the certificate of the arrangement; None if none can be shown."""
        clauses = self._world.clauses
        options = [[w for t in self._fitting(clause) if (w := self._witness(clause, t))] for clause in clauses]
        for chosen in product(*options):
            if len({witness.thing for witness in chosen}) == len(chosen):
                return Certificate(witnesses=chosen)
        proofs = [proof for clause in clauses if (proof := self._proof(clause)) is not None]
        return Certificate(impossible=proofs[0]) if proofs else None

    def _fitting(self, clause: Clause) -> list[Thing]:
        """Return the objects that fit a description and can be lifted or are on the target already."""
        return [
            thing
            for thing in self._things
            if clause.description.fits(body(thing), self._words)
            and (self._words.types[thing.type].graspable or thing.on == clause.target)
        ]

    def _witness(self, clause: Clause, thing: Thing) -> Witness | None:
        margin = clause.description.margin(body(thing), self._words)
        if margin < self._world.variant.margin_sd[0] or not self.movable(thing):
            return None
        way = in_the_way(thing, self._things, self._words)
        room: Pose2 | None = None
        if clause.target is not None and thing.on != clause.target:
            found = self._room(clause.target, thing)
            if found is None:
                return None
            room, taken = found
            way += [other for other in taken if other not in way]
        if (
            len(way) > MOST_CLEARED
            or not all(map(self.movable, way))
            or not self.can_put_aside(way, clause.target, thing)
        ):
            return None
        stand = self.stand(thing)
        assert stand is not None, "what can be moved is stood at"
        return Witness(clause.variable, thing.id, margin, stand, tuple(t.id for t in way), room)

    def stand(self, thing: Thing) -> Pose2 | None:
        """Return world_T_base from which an object is reached; None if there is none."""
        return self._floor.stand(self._tables[str(thing.on)], *thing.at[:2])

    def movable(self, thing: Thing) -> bool:
        """Return whether an object can be lifted and a base can stand before it."""
        return self._words.types[thing.type].graspable and self.stand(thing) is not None

    def free_spot(self, target: str, thing: Thing) -> Pose2 | None:
        """Return the first free place on a table for an object; None if there is none."""
        kind = self._words.types[thing.type]
        return next(spots(self._tables[target], kind, self._things, self._floor, self._words), None)

    def _room(self, target: str, thing: Thing) -> tuple[Pose2, list[Thing]] | None:
        """Return a place on the target and the fewest objects that must leave it before."""
        kind, table = self._words.types[thing.type], self._tables[target]
        free = self.free_spot(target, thing)
        if free is not None:
            return free, []
        there = [other for other in self._things if other.on == target]
        movable = [other for other in there if self.movable(other)]
        fixed = [other for other in there if other not in movable]
        makeable = spots(table, kind, fixed, self._floor, self._words)
        return min(
            ((at, self._taking(at, thing, movable)) for at in makeable), key=lambda made: len(made[1]), default=None
        )

    def _taking(self, at: Pose2, thing: Thing, others: Sequence[Thing]) -> list[Thing]:
        """Return the objects that stand too near to a place, with those in the way to them."""
        kind, spot = self._words.types[thing.type], (at[0], at[1], math.pi / 2)
        near = [other for other in others if not is_free(kind, str(other.on), spot, [other], GAP_M, self._words)]
        found = {
            other.id: other for near_one in near for other in [*in_the_way(near_one, others, self._words), near_one]
        }
        return list(found.values())

    def can_put_aside(self, way: Sequence[Thing], target: str | None, thing: Thing) -> bool:
        """Return whether there are places for all removed objects and for the object itself."""
        if not way:
            return True
        gone = {*(other.id for other in way), thing.id}
        left = [other for other in self._things if other.id not in gone]
        sources = {other.on for other in (*way, thing)}
        widest = self._words.types["carton"]
        places = 0
        for name, table in self._tables.items():
            if name in sources:
                continue
            places += len(spread(spots(table, widest, left, self._floor, self._words)))
        needed = len(way) + (target is not None and target not in sources)
        return places >= needed

    def _proof(self, clause: Clause) -> Proof | None:
        """Return the reason why no object makes a clause true; None if that cannot be shown."""
        fitting = self._fitting(clause)
        if not fitting:
            return "nothing_fits"
        words = self._words
        if all(self._floor.out_of_reach(self._tables[str(t.on)], *t.at[:2]) for t in fitting):
            return "nothing_reached"
        if clause.target is None or any(t.on == clause.target for t in fitting):
            return None
        table = self._tables[clause.target]
        if all(never_room(table, words.types[t.type], self._things, words) for t in fitting):
            return "no_room"
        return None
