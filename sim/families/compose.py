"""Drawing of a whole world: room, objects, prior, moves and goal, repeated until its answer is known."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from skolem.sim.families import places
from skolem.sim.families.answering import answered
from skolem.sim.families.asking import BOUNDS, PLACED, asked
from skolem.sim.families.certificate import Certificate, judged
from skolem.sim.families.draws import Stream, between, pick, stream
from skolem.sim.families.layouts import Standing
from skolem.sim.families.ranges import FAMILIES, Variant
from skolem.sim.families.reaching import Floor
from skolem.sim.families.room import tables
from skolem.sim.families.things import Thing
from skolem.sim.families.wording import said
from skolem.sim.families.words import Words
from skolem.sim.families.world import Move, PriorThing, World

MOST_ATTEMPTS = 1000
MOVES_BEFORE = (2, 14)  # least and greatest action before which an object is moved
MOVED_GAP_M = 0.08


@dataclass(frozen=True, slots=True)
class Drawn:
    """A world with its answer.

    Attributes:
        world: Content of the scenario.
        certificate: The answer.
        retries: Earlier attempts, whose objects found no place or whose answer could not be shown.
    """

    world: World
    certificate: Certificate
    retries: int


def drawn(family: str, seed: int, words: Words, bound: float | None = None) -> Drawn:
    """Return the world of a family and a seed.

    Args:
        family: One of `FAMILIES`.
        seed: Any number from 0.
        words: The vocabulary.
        bound: Bound of the denotations, instead of a drawn one.
    """
    variants = FAMILIES[family]
    variant = variants[seed % len(variants)]
    for attempt in range(MOST_ATTEMPTS):
        try:
            world = _Drawing(family, seed, variant, words, attempt).world()
        except places.NoPlaceError:
            continue
        sentence = world.sentence
        certificate = judged(world, words) if sentence is None else answered(world, sentence, words)
        if certificate is not None and (sentence is not None or certificate.impossible in _answers(variant)):
            if bound is not None:
                world.bound = bound
            return Drawn(world, certificate, attempt)
    raise AssertionError(f"no attempt at family {family}, seed {seed}, gave a world with a known answer")


def _answers(variant: Variant) -> tuple[str | None, ...]:
    """Return the answers that a variant may have; with a freely drawn goal, it may be that no object fits."""
    return (None, "nothing_fits") if variant.impossible is None else (variant.impossible,)


class _Drawing:
    """One attempt at a world, with a stream for each purpose."""

    def __init__(self, family: str, seed: int, variant: Variant, words: Words, attempt: int) -> None:
        self._world = World(family, seed, variant)
        self._variant, self._words = variant, words
        self._draws = {purpose: stream(family, seed, purpose, attempt) for purpose in Stream}

    def world(self) -> World:
        """Return the world.

        Raises:
            NoPlaceError: If its objects do not find places.
        """
        world = self._world
        world.tables = tables(self._draws[Stream.ROOM], self._variant)
        self._floor = Floor(world.tables, self._words)
        standing = Standing(world, self._words, self._draws)
        names = [table.id for table in world.tables]
        order = [str(name) for name in self._draws[Stream.ROOM].permutation(names[:3] if len(names) > 6 else names)]
        if self._variant.impossible == "nothing_reached":
            order = [names[-1], *names[:2]]  # the middle of the block, and the two tables beside
        source, target, *others = order
        standing.put(source, target, others)
        self._set_prior(standing.shares)
        self._move(target)
        if self._variant.construct is not None:
            draw = self._draws[Stream.GOAL]
            world.bound, world.placed = pick(draw, BOUNDS), pick(draw, PLACED)
            world.sentence = said(draw, world, self._words, self._variant.construct, names)
            return world
        hopeless = self._variant.impossible == "nothing_reached"
        reachable = [thing for thing in world.things if hopeless or self._is_reachable(thing)]
        targets = [target] if self._variant.layout != "spread" or self._variant.impossible else [target, *others]
        asked(self._draws[Stream.GOAL], world, self._words, self._about(reachable, source), targets)
        return world

    def _set_prior(self, types: Mapping[str, dict[str, float] | None]) -> None:
        """Set the prior: the tables, and the objects that are no strangers."""
        draw, variant = self._draws[Stream.TOLD], self._variant
        self._world.prior = [
            PriorThing(table.id, {"table": 1.0}, sd_xy_m=0.005, sd_theta_rad=0.01) for table in self._world.tables
        ]
        for thing in self._world.things:
            shares = types[thing.id]
            if shares is None:
                continue
            if variant.off_m > 0.0 and thing.type != "crate":
                direction = between(draw, -math.pi, math.pi)
                x, y, theta = thing.at
                x, y = x + variant.off_m * math.cos(direction), y + variant.off_m * math.sin(direction)
                at = (round(x, 4), round(y, 4), theta)
                self._world.prior.append(PriorThing(thing.id, shares, at, thing.on, variant.sd_xy_m))
            else:
                sd = 0.01 if thing.type == "crate" else variant.sd_xy_m
                self._world.prior.append(PriorThing(thing.id, shares, sd_xy_m=sd))

    def _move(self, target: str) -> None:
        """Set the moves of objects; no object gets onto the target or into another one's place."""
        draw, variant = self._draws[Stream.EVENTS], self._variant
        count = int(draw.integers(variant.moves[0], variant.moves[1] + 1))
        if count == 0:
            return
        steps = sorted(int(step) for step in draw.choice(range(*MOVES_BEFORE), count, replace=False))
        standing = list(self._world.things)
        movable = [thing for thing in standing if thing.on != target]
        only = pick(draw, movable)
        for step in steps:
            thing = only if variant.moved == "witness" else pick(draw, movable)
            on = pick(draw, [table.id for table in self._world.tables if table.id != target])
            what = self._words.types[thing.type]
            at = places.free_place(what, on, standing, MOVED_GAP_M, self._words, partial(places.anywhere, draw, what))
            standing.append(replace(thing, on=on, at=at))
            self._world.moves.append(Move(step, thing.id, on, at))

    def _about(self, reachable: list[Thing], source: str) -> list[Thing]:
        """Return the objects that the goal may be about: the difficult one of the family, if there is one."""
        world, variant = self._world, self._variant
        if variant.moved == "witness" and world.moves:
            return [thing for thing in reachable if thing.id == world.moves[0].id]
        if variant.impossible in ("nothing_reached", "no_room") or variant.layout in ("clutter", "behind", "rows"):
            return [thing for thing in reachable if thing.on == source and thing.type != "crate"]
        if variant.layout == "crowd":
            return [thing for thing in reachable if variant.crowded == "source" or thing.on == source]
        return reachable

    def _is_reachable(self, thing: Thing) -> bool:
        if not self._words.types[thing.type].graspable:
            return False
        table = next(table for table in self._world.tables if table.id == thing.on)
        return self._floor.stand(table, *thing.at[:2]) is not None
