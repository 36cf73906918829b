"""Drawing of goals, about existing objects or freely: one or two variables, alternatives, comparisons, bounds."""

from collections.abc import Sequence

from numpy.random import Generator

from skolem.sim.families.certificate import body
from skolem.sim.families.draws import pick
from skolem.sim.families.goals import Clause, Description, Property
from skolem.sim.families.margins import WEIGHT_SD_KG
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words
from skolem.sim.families.world import World

BOUNDS = (0.8, 0.9, 0.9, 0.95)  # of denotations
PLACED = (0.8, 0.9)  # of the object's being on the target
FREELY = 0.15  # share of goals that are drawn without regard to existing objects
TWO = 0.2  # share of goals with two variables
ONLY_KNOW = 0.1  # share of goals that ask only for the denotation
EITHER = 0.25  # share of colours and types that come with an alternative
COMPARED = 0.4  # share of weights that are compared with a number
TOO_PLAIN = frozenset({"black", "grey", "white"})  # in worlds with crates, which have these colours
HEAVIEST_G = 900


def asked(draw: Generator, world: World, words: Words, about: Sequence[Thing], targets: Sequence[str]) -> None:
    """Draw the goal of a world.

    Args:
        draw: Generator of the goal.
        world: The world; it gets the clauses and the bounds.
        words: The vocabulary.
        about: Objects that the goal may be about.
        targets: Tables that the goal may name.
    """
    world.bound, world.placed = pick(draw, BOUNDS), pick(draw, PLACED)
    if world.variant.impossible == "nothing_fits":
        world.clauses = (Clause("o", _of_nothing(draw, world.things, words), pick(draw, targets)),)
        return
    if not about or (world.variant.impossible is None and float(draw.random()) < FREELY):
        world.clauses = (Clause("o", _free(draw, world.things, words), pick(draw, targets)),)
        return
    first = pick(draw, about)
    others = [thing for thing in about if thing.id != first.id]
    chosen = [("o", first)]
    if others and world.variant.impossible is None and len(targets) > 1 and float(draw.random()) < TWO:
        chosen.append(("u", pick(draw, others)))
    free_targets = list(targets)
    clauses = []
    for variable, thing in chosen:
        elsewhere = [target for target in free_targets if target != thing.on] or free_targets
        target = None if len(chosen) == 1 and _only_known(draw, world) else pick(draw, elsewhere)
        free_targets = [name for name in free_targets if name != target]
        clauses.append(Clause(variable, _of(draw, thing, world.things, words, world), target))
    world.clauses = tuple(clauses)


def _only_known(draw: Generator, world: World) -> bool:
    return float(draw.random()) < ONLY_KNOW and world.variant.impossible is None


def _of(draw: Generator, thing: Thing, things: Sequence[Thing], words: Words, world: World) -> Description:
    """Return a description that fits an object: one to three of its type, colour and weight."""
    kinds = [str(kind) for kind in draw.permutation(["colour", "type", "weight"])][: int(draw.integers(1, 4))]
    if world.variant.impossible == "nothing_reached":
        kinds = ["colour", "type"]
    if world.variant.impossible == "no_room" and "type" not in kinds:
        kinds.append("type")
    colour = None if thing.hsv is None else words.colour_of(thing.hsv)
    if colour is None and "colour" in kinds:
        kinds = [kind for kind in kinds if kind != "colour"] or ["type"]
    parts: list[tuple[Property, ...]] = []
    for kind in sorted(kinds):
        if kind == "colour":
            parts.append(_either(draw, str(colour), list(words.colours)))
        elif kind == "type":
            parts.append(_either(draw, thing.type, graspable(words)))
        else:
            parts.append((_weighing(draw, thing, things, words),))
    return Description(tuple(parts))


def _either(draw: Generator, word: str, others: Sequence[str]) -> tuple[Property, ...]:
    """Return a word, sometimes with an alternative."""
    if float(draw.random()) >= EITHER:
        return (Property(word),)
    second = pick(draw, [other for other in others if other != word])
    return tuple(Property(each) for each in sorted((word, second)))


def _weighing(draw: Generator, thing: Thing, things: Sequence[Thing], words: Words) -> Property:
    """Return a word for an object's weight, or a number that it exceeds and that no weight is too near."""
    fitting = [word for word in words.weight_words() if Property(word).holds(body(thing), words)]
    numbers = [grams for grams in _clear_numbers(things) if grams / 1000.0 <= (thing.kg or 0.0)]
    if numbers and (not fitting or float(draw.random()) < COMPARED):
        return Property("heavier_than", pick(draw, numbers))
    return Property(pick(draw, fitting))


def _clear_numbers(things: Sequence[Thing]) -> list[int]:
    """Return round numbers of grams from which every weight is at least three standard deviations away."""
    weights = [thing.kg for thing in things if thing.kg is not None]
    return [
        grams
        for grams in range(100, HEAVIEST_G, 50)
        if all(abs(kg - grams / 1000.0) >= 3.0 * WEIGHT_SD_KG for kg in weights)
    ]


def _free(draw: Generator, things: Sequence[Thing], words: Words) -> Description:
    """Return a description that is drawn without regard to existing objects."""
    parts: list[tuple[Property, ...]] = [_either(draw, pick(draw, list(words.colours)), list(words.colours))]
    if float(draw.random()) < 0.5:
        parts.append((Property(pick(draw, graspable(words))),))
    return Description(tuple(parts))


def _of_nothing(draw: Generator, things: Sequence[Thing], words: Words) -> Description:
    """Return a description that fits no existing object."""
    present = {words.colour_of(thing.hsv) for thing in things if thing.hsv is not None}
    colour = Property(pick(draw, [word for word in words.colours if word not in present and word not in TOO_PLAIN]))
    if float(draw.random()) < 0.5:
        return Description(((colour,),))
    return Description(((colour,), (Property(pick(draw, graspable(words))),)))


def graspable(words: Words) -> list[str]:
    """Return the types that a hand can grasp, in alphabetical order."""
    return sorted(kind for kind, what in words.types.items() if what.graspable)
