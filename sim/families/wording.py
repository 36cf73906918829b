"""Drawing of goals with one construct: a description that fits a wanted number of objects, and a number to ask for."""

from collections.abc import Sequence
from itertools import combinations

from numpy.random import Generator

from skolem.sim.families.asking import graspable
from skolem.sim.families.draws import pick
from skolem.sim.families.goals import Description, Property
from skolem.sim.families.places import NoPlaceError
from skolem.sim.families.ranges import Construct
from skolem.sim.families.sentences import Sentence
from skolem.sim.families.words import Words
from skolem.sim.families.world import World

FAILS = 0.35  # share of goals for which the world has too few such objects, or too many
SEVERAL = 0.5  # share of failing `the` that have several referents
ANYWHERE = 0.25  # share of goals without a target
NOTHING = 0.1  # share of `every` that are about nothing
KINDS = ("word", "either", "both")  # one type; one of two types; a type and a colour
ON_A_TABLE = ("together", "every")  # constructs that need a target


def said(draw: Generator, world: World, words: Words, construct: Construct, targets: Sequence[str]) -> Sentence:
    """Draw a goal with one construct.

    Args:
        draw: Generator of the goal.
        world: The world.
        words: The vocabulary.
        construct: The construct.
        targets: Tables that the goal may name.

    Raises:
        NoPlaceError: If no description fits the number of objects that was drawn.
    """
    fails = float(draw.random()) < FAILS
    anywhere = float(draw.random()) < ANYWHERE and construct not in ON_A_TABLE
    target = None if anywhere else pick(draw, targets)
    fits = _fits(draw, construct, fails, anywhere)
    drafts = [Sentence(construct, description, 1, target) for description in _descriptions(draw, construct, words)]
    found = {draft: len(draft.fitting(world.things, words)) for draft in drafts}
    usable = [draft for draft, number in found.items() if number in fits]
    if not usable:
        raise NoPlaceError(construct)
    count = pick(draw, sorted({found[draft] for draft in usable}))
    draft = pick(draw, [draft for draft in usable if found[draft] == count])
    return Sentence(construct, draft.description, _number(draw, construct, count, fails, anywhere), target)


def _fits(draw: Generator, construct: Construct, fails: bool, anywhere: bool) -> range:
    """Return the numbers of objects that the description may fit."""
    many = 100
    match construct:
        case "not" | "together":
            return range(1) if fails else range(1, many)
        case "distinct":
            return range(2) if fails else range(2, many)
        case "the":
            return range(1, 2) if not fails else range(2, many) if float(draw.random()) < SEVERAL else range(1)
        case "every":
            return range(1) if float(draw.random()) < NOTHING else range(1, many)
        case "not_exists":
            return range(1, many) if fails or not anywhere else range(1)
        case "at_least" | "exactly" | "at_most":
            return range(1, many)


def _number(draw: Generator, construct: Construct, fits: int, fails: bool, anywhere: bool) -> int:
    """Return a number to ask for; if the goal is to fail, one that the objects which fit cannot make true."""
    match construct:
        case "distinct":
            return 2
        case "at_least":
            return fits + 1 if fails else int(draw.integers(1, fits + 1))
        case "exactly" if anywhere:
            return pick(draw, (fits - 1, fits + 1)) if fails else fits
        case "exactly":
            return fits + 1 if fails else int(draw.integers(0, fits + 1))
        case "at_most" if anywhere:
            return fits - 1 if fails else fits + int(draw.integers(0, 2))
        case "at_most":
            return int(draw.integers(0, fits))
        case _:
            return 1


def _descriptions(draw: Generator, construct: Construct, words: Words) -> list[Description]:
    """Return the descriptions of a kind: with a negation, or of one type, of two types, of a type and a colour."""
    types, colours = graspable(words), list(words.colours)
    if construct == "not":
        pairs = [(first, second) for first in types for second in colours]
        pairs = pairs if float(draw.random()) < 0.5 else [(second, first) for first, second in pairs]
        return [Description(((Property(has),), (Property(lacks, negated=True),))) for has, lacks in pairs]
    match pick(draw, KINDS):
        case "word":
            return [Description(((Property(kind),),)) for kind in types]
        case "either":
            return [Description((tuple(map(Property, pair)),)) for pair in combinations(types, 2)]
        case _:
            return [Description(((Property(colour),), (Property(kind),))) for colour in colours for kind in types]
