"""The words of goals and what they mean, read from the facts of `vocabulary.lp` and of a user's own rule files."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Final

from skolem.reasoner.cursor import REFUSED
from skolem.reasoner.expressions import RESERVED_WORDS, SPATIAL, word_of
from skolem.reasoner.terms import ANY, Compound, Term
from skolem.traces.errors import Fault
from skolem.traces.messages import HsvVolume, Meaning, ObjectType, Quantity, TypeIs, WeightInterval

# Every predicate that gives a word, with its number of arguments; the word is the first.
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
SHAPES: Final = ("box", "cylinder", "table")
_WORD: Final = re.compile(r"[a-z][a-z0-9]*(_[a-z][a-z0-9]*)*")


@dataclass(frozen=True, slots=True)
class Place:
    """Where a fact stands.

    Attributes:
        file: Name of the file.
        line: Line, from 1.
        column: Column, from 1.
        own: Whether it is a user's own file, whose facts replace those that ship.
    """

    file: str
    line: int
    column: int
    own: bool

    def fault(self, message: str) -> Fault:
        """Return a fault at this place."""
        return Fault(self.file, self.line, self.column, message)


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What words mean.

    Attributes:
        types: Every object type by its word, sorted.
        meanings: Every property by its word, sorted; types are properties too.
        near_m: Every relation of two objects that are close, with the greatest distance, sorted.
        exceeds: Every relation of an object and a number that its quantity exceeds, with that quantity, sorted.
    """

    types: Mapping[str, ObjectType]
    meanings: Mapping[str, Meaning]
    near_m: Mapping[str, float] = field(default_factory=dict)
    exceeds: Mapping[str, Quantity] = field(default_factory=dict)

    def words(self) -> dict[str, int]:
        """Return every relation word of the goal language with its number of arguments."""
        pairs = [word_of(word) for word in (*self.near_m, *self.exceeds)]
        return {word_of(word): 1 for word in self.meanings} | dict.fromkeys([*SPATIAL, *pairs], 2)


def read_vocabulary(facts: Iterable[tuple[Compound, Place]]) -> tuple[Vocabulary, list[Fault], list[Fault]]:
    """Return the vocabulary, every fault and every warning.

    Args:
        facts: The atoms of the predicates in `WORD_FACTS`, with the places where they are stated.
    """
    faults: list[Fault] = []
    chosen = _replaced(sorted(facts, key=lambda fact: str(fact[0])), faults)
    types = _types(chosen, faults)
    meanings: dict[str, Meaning] = {word: TypeIs(type=word) for word in types}
    for name, read in (("colour", _colour), ("weight", _weight)):
        for word, (fact, place) in chosen[name].items():
            if word in meanings:
                faults.append(place.fault(f"{word!r} already names a {meanings[word].quantity}"))
            meaning = read(fact, place, faults)
            if meaning is not None:
                meanings[word] = meaning
    warnings = _overlaps(chosen["colour"], meanings) + _gaps(chosen["colour"], meanings)
    near_m, exceeds = _distances(chosen["near"], faults), _comparisons(chosen["exceeds"], faults)
    for word, (_, place) in sorted((chosen["near"] | chosen["exceeds"]).items()):
        if word in meanings or (word in near_m and word in exceeds):
            faults.append(place.fault(f"{word!r} already has another meaning"))
    return Vocabulary(dict(sorted(types.items())), dict(sorted(meanings.items())), near_m, exceeds), faults, warnings


_Chosen = dict[str, dict[str, tuple[Compound, Place]]]


def _replaced(facts: Sequence[tuple[Compound, Place]], faults: list[Fault]) -> _Chosen:
    """Return the fact that counts, by predicate and word."""
    chosen: _Chosen = {name: {} for name in WORD_FACTS}
    for fact, place in sorted(facts, key=lambda item: item[1].own):
        word = fact.args[0]
        if not isinstance(word, str) or not _WORD.fullmatch(word):
            faults.append(place.fault(f"expected a word in lower case such as soda_box, found {word}"))
        elif word_of(word) in RESERVED_WORDS or word == ANY or word in REFUSED:
            faults.append(place.fault(f"{word!r} cannot be a word: the goal language uses it"))
        elif word in chosen[fact.name] and chosen[fact.name][word][1].own == place.own:
            before = chosen[fact.name][word]
            faults.append(place.fault(f"{fact} contradicts {before[0]} in {before[1].file}:{before[1].line}"))
        else:
            chosen[fact.name][word] = (fact, place)
    return chosen


def _types(chosen: _Chosen, faults: list[Fault]) -> dict[str, ObjectType]:
    types: dict[str, ObjectType] = {}
    for word, (_, place) in chosen["type"].items():
        shapes = [name for name in SHAPES if word in chosen[name]]
        own = [name for name in shapes if chosen[name][word][1].own]
        if len(own or shapes) != 1:
            found = f"found {' and '.join(own or shapes)}" if shapes else "found none"
            faults.append(place.fault(f"type {word!r} needs exactly one of {', '.join(SHAPES)}; {found}"))
            continue
        shape = (own or shapes)[0]
        object_type = _shape(*chosen[shape][word], word in chosen["graspable"], faults)
        if object_type is not None:
            types[word] = object_type
    for name in (*SHAPES, "graspable"):
        for word, (_, place) in chosen[name].items():
            if word not in chosen["type"]:
                faults.append(place.fault(f"{word!r} is not a type; state type({word})."))
    return types


def _shape(fact: Compound, place: Place, graspable: bool, faults: list[Fault]) -> ObjectType | None:
    size = _integers(fact, place, faults, lambda v: 1 <= v <= 10_000, "a size from 1 to 10000 mm")
    if size is None:
        return None
    x, y, z = (value / 1000 for value in size)
    if fact.name == "cylinder" and x != y:
        faults.append(place.fault(f"a cylinder is as wide as it is deep; {fact} is not"))
        return None
    match fact.name:
        case "box" | "cylinder" | "table" as shape:
            return ObjectType(shape=shape, size_m=(x, y, z), graspable=graspable)
    raise AssertionError(fact)


def _colour(fact: Compound, place: Place, faults: list[Fault]) -> HsvVolume | None:
    values = _integers(fact, place, faults, lambda v: 0 <= v <= 360, "degrees or percent")
    if values is None:
        return None
    hue, rest = values[:2], values[2:]
    problems = [f"hue from {hue[0]} to {hue[1]} is empty"] if hue[0] == hue[1] else []
    for name, (low, high) in (("saturation", rest[:2]), ("value", rest[2:])):
        if not low < high <= 100:
            problems.append(f"{name} must rise and end at 100 percent at most, found {low} to {high}")
    faults += [place.fault(f"colour {fact.args[0]}: {problem}") for problem in problems]
    if problems:
        return None
    s, s2, v, v2 = (value / 100 for value in rest)
    return HsvVolume(hue=(hue[0] / 360, hue[1] / 360), saturation=(s, s2), value=(v, v2))


def _weight(fact: Compound, place: Place, faults: list[Fault]) -> WeightInterval | None:
    open_ended = fact.args[2] == ANY
    limits = Compound(fact.name, fact.args[:2]) if open_ended else fact
    grams = _integers(limits, place, faults, lambda v: v >= 0, "grams, or any as the last")
    if grams is None:
        return None
    if not open_ended and grams[0] >= grams[1]:
        faults.append(place.fault(f"weight {fact.args[0]}: from {grams[0]} to {grams[1]} g is empty"))
        return None
    return WeightInterval(at_least_kg=grams[0] / 1000, below_kg=None if open_ended else grams[1] / 1000)


def _distances(facts: Mapping[str, tuple[Compound, Place]], faults: list[Fault]) -> dict[str, float]:
    """Return the greatest distance in metres by relation."""
    found = {
        word: _integers(fact, place, faults, lambda v: 1 <= v <= 100_000, "a distance from 1 to 100000 mm")
        for word, (fact, place) in sorted(facts.items())
    }
    return {word: values[0] / 1000 for word, values in found.items() if values}


def _comparisons(facts: Mapping[str, tuple[Compound, Place]], faults: list[Fault]) -> dict[str, Quantity]:
    """Return the quantity compared by relation."""
    found: dict[str, Quantity] = {}
    for word, (fact, place) in sorted(facts.items()):
        if fact.args[1] == "weight":
            found[word] = "weight"
        else:
            faults.append(place.fault(f"exceeds {word}: expected weight, found {fact.args[1]}"))
    return found


def _integers(
    fact: Compound, place: Place, faults: list[Fault], allowed: Callable[[int], bool], expected: str
) -> list[int] | None:
    """Return the arguments after the word, if each is an allowed integer."""
    wrong = [value for value in fact.args[1:] if not isinstance(value, int) or not allowed(value)]
    if wrong:
        faults.append(place.fault(f"{fact.name} {fact.args[0]}: expected {expected}, found {wrong[0]}"))
        return None
    return [value for value in fact.args[1:] if isinstance(value, int)]


def _overlaps(colours: Mapping[str, tuple[Term, Place]], meanings: Mapping[str, Meaning]) -> list[Fault]:
    """Return a warning for every two colours that share a part of the colour space, at the user's fact if one is."""
    volumes = {word: meaning for word, meaning in meanings.items() if isinstance(meaning, HsvVolume)}
    return [
        (colours[first][1] if colours[first][1].own else colours[second][1]).fault(
            f"warning: the colours {first} and {second} overlap"
        )
        for first, second in combinations(sorted(volumes), 2)
        if _share(volumes[first], volumes[second])
    ]


def _gaps(colours: Mapping[str, tuple[Term, Place]], meanings: Mapping[str, Meaning]) -> list[Fault]:
    """Return a warning for every range of hues that has no name where colours are vivid, at full saturation and value.

    It is placed at the fact whose colour the gap follows; a user's own file is where it can be closed.
    """
    vivid = [
        (low, high, word)
        for word, meaning in sorted(meanings.items())
        if isinstance(meaning, HsvVolume) and meaning.saturation[1] == 1.0 and meaning.value[1] == 1.0
        for low, high in _arcs(meaning.hue)
    ]
    found: list[Fault] = []
    end, last = 0.0, ""
    for low, high, word in [*sorted(vivid), (1.0, 1.0, "")]:
        if low > end and (last or word):
            place = colours[last or word][1]
            found.append(place.fault(f"warning: no colour for the hues {360 * end:g} to {360 * low:g} degrees"))
        if high > end:
            end, last = high, word or last
    return found


def _share(a: HsvVolume, b: HsvVolume) -> bool:
    hue = any(_cross(s, t) for s in _arcs(a.hue) for t in _arcs(b.hue))
    return hue and _cross(a.saturation, b.saturation) and _cross(a.value, b.value)


def _arcs(hue: tuple[float, float]) -> list[tuple[float, float]]:
    """Return a hue interval as intervals that do not wrap."""
    low, high = hue
    return [(low, high)] if low < high else [(low, 1.0), (0.0, high)]


def _cross(a: tuple[float, float], b: tuple[float, float]) -> bool:
    return max(a[0], b[0]) < min(a[1], b[1])
