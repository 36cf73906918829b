"""The known answer of a goal with one construct: the fewest moves of objects that make it true, or the proof of none.

A goal is impossible if it is false wherever the objects that a hand can lift are put. This is found by trying: each
object that is as described stays, or goes to the target, or leaves it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

from skolem.sim.families.certificate import Certificate, Judge, Witness
from skolem.sim.families.ranges import Proof
from skolem.sim.families.reaching import Floor, in_the_way
from skolem.sim.families.sentences import Sentence
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.families.world import World

ELSEWHERE = "elsewhere"  # any table but the target


def answered(world: World, sentence: Sentence, words: Words) -> Certificate | None:
    """Return the certificate of a goal with one construct; None if none can be shown."""
    floor = Floor(world.tables, words)
    possible = [moved for moved in _choices(world, sentence, words) if sentence.true(moved, words)]
    if not possible:
        return Certificate(impossible=_proof(world, sentence, words))
    for moved in possible:
        witnesses = _Moves(world, sentence, floor, words).witnesses(moved)
        if witnesses is not None:
            return Certificate(witnesses=witnesses)
    return None


def _choices(world: World, sentence: Sentence, words: Words) -> Iterator[list[Thing]]:
    """Yield the objects where they may end, fewest moves first."""
    fitting = [t.id for t in sentence.fitting(world.things, words) if words.types[t.type].graspable]
    for count in range(len(fitting) + 1 if sentence.target else 1):
        for chosen in combinations(fitting, count):
            yield [replace(t, on=_other(t, sentence)) if t.id in chosen else t for t in world.things]


def _other(thing: Thing, sentence: Sentence) -> str | None:
    return ELSEWHERE if thing.on == sentence.target else sentence.target


def _proof(world: World, sentence: Sentence, words: Words) -> Proof:
    fits = len(sentence.fitting(world.things, words))
    if fits == 0:
        return "nothing_fits"
    return "too_few_fit" if fits < sentence.number and sentence.construct != "at_most" else "too_many_fit"


class _Moves:
    """The moves of objects, one after another, each with a stand of the base and a free place."""

    def __init__(self, world: World, sentence: Sentence, floor: Floor, words: Words) -> None:
        self._world, self._sentence, self._floor, self._words = world, sentence, floor, words

    def witnesses(self, moved: Sequence[Thing]) -> tuple[Witness, ...] | None:
        """Return a witness for each object that is moved or meant; None if a stand or a place cannot be shown."""
        ends = {thing.id: thing.on for thing in moved}
        things, found = list(self._world.things), list[Witness]()
        of_objects = self._sentence.construct not in ("at_most", "every", "not_exists")
        meant = {thing.id for thing in self._sentence.meant(moved, self._words)} if of_objects else set()
        kept = sorted(meant)[: self._sentence.number] if self._sentence.construct != "exactly" else sorted(meant)
        for thing in self._world.things:
            if thing.id not in kept and ends[thing.id] == thing.on:
                continue
            variable = self._sentence.variables[min(len(found), len(self._sentence.variables) - 1)]
            witness = self._witness(thing, variable, ends[thing.id], things)
            if witness is None:
                return None
            found.append(witness)
            if witness.room is not None:
                things = [replace(t, on=witness.on, at=witness.room) if t.id == thing.id else t for t in things]
        return tuple(found)

    def _witness(self, thing: Thing, variable: str, end: str | None, things: Sequence[Thing]) -> Witness | None:
        judge = Judge(self._world, things, self._floor, self._words)
        body = (thing.type, thing.hsv, thing.kg)
        margin, stand = self._sentence.description.margin(body, self._words), judge.stand(thing)
        way = in_the_way(thing, things, self._words)
        fits = {other.id for other in self._sentence.fitting(things, self._words)}
        if stand is None or not all(judge.movable(other) and other.id not in fits for other in way):
            return None
        target = None if thing.on == end else end
        if not judge.can_put_aside(way, target, thing):
            return None
        cleared = tuple(other.id for other in way)
        if target is None:
            return Witness(variable, thing.id, margin, stand, cleared, None)
        names = [target] if target != ELSEWHERE else [t.id for t in self._world.tables if t.id != thing.on]
        for name in names:
            room = judge.free_spot(name, thing)
            if room is not None:
                return Witness(variable, thing.id, margin, stand, cleared, room, name)
        return None
