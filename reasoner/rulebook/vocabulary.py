"""The words of goals and their meanings, read from the facts of `vocabulary.lp` and of a user's own rule files."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from skolem.reasoner.language.descriptions import SPATIAL, word_of
from skolem.reasoner.language.expressions import RESERVED_WORDS
from skolem.reasoner.language.remedies import KEYWORDS
from skolem.reasoner.rulebook.arguments import Position, Range, integers
from skolem.reasoner.rulebook.colours import colour_boxes, gaps, meaning_of, overlaps
from skolem.reasoner.terms import ANY, Compound
from skolem.traces.errors import Fault
from skolem.traces.messages import Meaning, ObjectType, Quantity, TypeIs, WeightInterval

# Every predicate that defines a word, with its number of arguments; the word is the first.
WORD_FACTS: Final = {
    "type": 1,
    "graspable": 1,
    "box": 4,
    "cylinder": 4,
    "table": 4,
    "colour": 7,
    "weight": 3,
    "near": 2,
    "exceeds": 2,
}
GRAMS_PER_KG: Final = 1000
SHAPES: Final = ("box", "cylinder", "table")
_ANOTHER: Final = "choose another word"
_WORD: Final = re.compile(r"[a-z][a-z0-9]*(_[a-z][a-z0-9]*)*")


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The words and their meanings.

    Attributes:
        types: The object types by word, sorted.
        meanings: The properties by word, sorted; types are properties too.
        near_m: The relations of two close objects by word, with the greatest distance in metres, sorted.
        exceeds: The relations of an object and a number that a quantity exceeds, by word, with the quantity, sorted.
    """

    types: Mapping[str, ObjectType]
    meanings: Mapping[str, Meaning]
    near_m: Mapping[str, float] = field(default_factory=dict)
    exceeds: Mapping[str, Quantity] = field(default_factory=dict)

    def words(self) -> dict[str, int]:
        """Return every relation word of the goal language with its number of arguments."""
        pairs = [word_of(word) for word in (*self.near_m, *self.exceeds)]
        return {word_of(word): 1 for word in self.meanings} | dict.fromkeys([*SPATIAL, *pairs], 2)

    def exceeding(self, relation: str, thousandths: int) -> Meaning:
        """Return the property of an object whose quantity exceeds a number (weight: grams), given in thousandths."""
        match self.exceeds[relation]:
            case "weight":
                return WeightInterval(at_least_kg=max(0.0, thousandths / 1000 / GRAMS_PER_KG))
            case quantity:
                raise AssertionError(quantity)


def comparison(relation: str, thousandths: int) -> str:
    """Return the name of the property that a comparison gives: `heavier_than_400`, which is no word."""
    number = f"{abs(thousandths) / 1000:.3f}".rstrip("0").rstrip(".").replace(".", "_")
    return f"{relation}_{'minus_' if thousandths < 0 else ''}{number}"


def read_vocabulary(
    facts: Iterable[tuple[Compound, Position]], whole: bool = True
) -> tuple[Vocabulary, list[Fault], list[Fault]]:
    """Return the vocabulary, every fault and every warning.

    Args:
        facts: The atoms of the predicates in `WORD_FACTS`, with their positions.
        whole: Whether these are all; if not, missing facts are no faults.
    """
    faults: list[Fault] = []
    chosen, colours = _replaced(sorted(facts, key=lambda fact: str(fact[0])), faults)
    types = _types(chosen, faults, whole)
    meanings: dict[str, Meaning] = {word: TypeIs(type=word) for word in types}
    boxes = {word: colour_boxes(stated, faults) for word, stated in colours.items()}
    for word, (fact, position) in (chosen["colour"] | chosen["weight"]).items():
        if word in meanings or (fact.name == "weight" and word in colours):
            quantity = meanings[word].quantity if word in meanings else "colour"
            faults.append(position.fault(f"{word!r} already names a {quantity}; {_ANOTHER}", 0))
        meaning = _weight(fact, position, faults) if fact.name == "weight" else meaning_of(boxes[word])
        if meaning is not None:
            meanings[word] = meaning
    warnings = overlaps(boxes) + (gaps(boxes) if whole and not faults else [])
    near_m, exceeds = _distances(chosen["near"], faults), _comparisons(chosen["exceeds"], faults)
    for word, (_, position) in sorted((chosen["near"] | chosen["exceeds"]).items()):
        if word in meanings or (word in near_m and word in exceeds):
            faults.append(position.fault(f"{word!r} already has another meaning; {_ANOTHER}", 0))
    return Vocabulary(dict(sorted(types.items())), dict(sorted(meanings.items())), near_m, exceeds), faults, warnings


_Chosen = dict[str, dict[str, tuple[Compound, Position]]]
_Stated = dict[str, list[tuple[Compound, Position]]]


def _replaced(facts: Sequence[tuple[Compound, Position]], faults: list[Fault]) -> tuple[_Chosen, _Stated]:
    """Return the fact in force by predicate and word, of a colour the last one, and all in force of each colour."""
    chosen: _Chosen = {name: {} for name in WORD_FACTS}
    colours: _Stated = {}
    for fact, position in sorted(facts, key=lambda item: item[1].own):
        word = fact.args[0]
        if not isinstance(word, str) or not _WORD.fullmatch(word):
            faults.append(position.fault(f"expected a word in lower case such as soda_box, found {word}", 0))
        elif word_of(word) in RESERVED_WORDS or word in KEYWORDS:
            faults.append(position.fault(f"{word!r} cannot be a word: the goal language uses it; {_ANOTHER}", 0))
        elif fact.name == "colour":
            before = colours.get(word, [])
            colours[word] = [*(each for each in before if each[1].own == position.own), (fact, position)]
            chosen[fact.name][word] = (fact, position)
        elif word in chosen[fact.name] and chosen[fact.name][word][1].own == position.own:
            other, there = chosen[fact.name][word]
            faults.append(position.fault(f"{fact} contradicts {other} in {there}; leave one of them out"))
        else:
            chosen[fact.name][word] = (fact, position)
    return chosen, colours


def _types(chosen: _Chosen, faults: list[Fault], whole: bool) -> dict[str, ObjectType]:
    types: dict[str, ObjectType] = {}
    for word, (_, position) in chosen["type"].items():
        shapes = [name for name in SHAPES if word in chosen[name]]
        own = [name for name in shapes if chosen[name][word][1].own]
        if len(own or shapes) != 1:
            found = f"found {' and '.join(own or shapes)}" if shapes else f"found none; state {_size_of(word)}"
            if whole or shapes:
                faults.append(position.fault(f"type {word!r} needs exactly one of {', '.join(SHAPES)}; {found}"))
            continue
        shape = (own or shapes)[0]
        object_type = _shape(*chosen[shape][word], word in chosen["graspable"], faults)
        if object_type is not None:
            types[word] = object_type
    for name in (*SHAPES, "graspable") if whole else ():
        for word, (_, position) in chosen[name].items():
            if word not in chosen["type"]:
                faults.append(position.fault(f"{word!r} is not a type; state type({word}).", 0))
    return types


def _size_of(word: str) -> str:
    """Return an example of a size in the notation of rule files."""
    return f"for example cylinder({word}, 66, 66, 115). (width, depth and height in mm)"


def _shape(fact: Compound, position: Position, graspable: bool, faults: list[Fault]) -> ObjectType | None:
    size = integers(fact, position, faults, [Range("a size", 1, 10_000, "mm")] * 3)
    if size is None:
        return None
    x, y, z = (value / 1000 for value in size)
    if fact.name == "cylinder" and x != y:
        remedy = f"write {fact.args[1]} twice, or state a box"
        faults.append(position.fault(f"a cylinder is as wide as it is deep; {fact} is not: {remedy}", 2))
        return None
    match fact.name:
        case "box" | "cylinder" | "table" as shape:
            return ObjectType(shape=shape, size_m=(x, y, z), graspable=graspable)
    raise AssertionError(fact)


def _weight(fact: Compound, position: Position, faults: list[Fault]) -> WeightInterval | None:
    open_ended = fact.args[2] == ANY
    limits = Compound(fact.name, fact.args[:2]) if open_ended else fact
    grams = integers(limits, position, faults, [_GRAMS, _GRAMS_OR_ANY])
    if grams is None:
        return None
    if not open_ended and grams[0] >= grams[1]:
        remedy = f"let it end above {grams[0]}, or write any for no end"
        faults.append(position.fault(f"weight {fact.args[0]}: from {grams[0]} to {grams[1]} g is empty; {remedy}", 2))
        return None
    return WeightInterval(at_least_kg=grams[0] / 1000, below_kg=None if open_ended else grams[1] / 1000)


def _distances(facts: Mapping[str, tuple[Compound, Position]], faults: list[Fault]) -> dict[str, float]:
    """Return the greatest distance in metres by relation."""
    found = {
        word: integers(fact, position, faults, [Range("a distance", 1, 100_000, "mm")])
        for word, (fact, position) in sorted(facts.items())
    }
    return {word: values[0] / 1000 for word, values in found.items() if values}


def _comparisons(facts: Mapping[str, tuple[Compound, Position]], faults: list[Fault]) -> dict[str, Quantity]:
    """Return the compared quantity by relation."""
    found: dict[str, Quantity] = {}
    for word, (fact, position) in sorted(facts.items()):
        if fact.args[1] == "weight":
            found[word] = "weight"
        else:
            faults.append(position.fault(f"exceeds {word}: expected weight, found {fact.args[1]}; write weight", 1))
    return found


_GRAMS: Final = Range("a weight", 0, None, "grams")
_GRAMS_OR_ANY: Final = Range("a weight", 0, None, "grams", ", or any for no end")
