"""The words of goals and their meanings, read from the facts of `vocabulary.lp` and of a user's own rule files."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Final

from skolem.reasoner.language.cursor import REFUSED
from skolem.reasoner.language.expressions import RESERVED_WORDS, SPATIAL, word_of
from skolem.reasoner.terms import ANY, Compound, Term
from skolem.traces.errors import Fault
from skolem.traces.messages import HsvVolume, Meaning, ObjectType, Quantity, TypeIs, WeightInterval

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
class Position:
    """The position of a fact in a rule file.

    Attributes:
        line: Line, from 1.
        column: Column, from 1.
        report: Makes a fault in its file from line, column and message.
        own: Whether the file is a user's own, whose facts replace those that ship.
        arguments: Line and column of each argument; empty if they are not written at that position.
    """

    line: int
    column: int
    report: Callable[[int, int, str], Fault]
    own: bool
    arguments: tuple[tuple[int, int], ...] = ()

    def fault(self, message: str, argument: int | None = None) -> Fault:
        """Return a fault at this position, or at one of the arguments, counted from 0."""
        if argument is None or not self.arguments:
            return self.report(self.line, self.column, message)
        return self.report(*self.arguments[argument], message)

    def __str__(self) -> str:
        """Return `file:line`."""
        return f"{self.fault('').file}:{self.line}"


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
    chosen = _replaced(sorted(facts, key=lambda fact: str(fact[0])), faults)
    types = _types(chosen, faults, whole)
    meanings: dict[str, Meaning] = {word: TypeIs(type=word) for word in types}
    for name, read in (("colour", _colour), ("weight", _weight)):
        for word, (fact, position) in chosen[name].items():
            if word in meanings:
                faults.append(position.fault(f"{word!r} already names a {meanings[word].quantity}; {_ANOTHER}", 0))
            meaning = read(fact, position, faults)
            if meaning is not None:
                meanings[word] = meaning
    warnings = _overlaps(chosen["colour"], meanings)
    warnings += _gaps(chosen["colour"], meanings) if whole and not faults else []
    near_m, exceeds = _distances(chosen["near"], faults), _comparisons(chosen["exceeds"], faults)
    for word, (_, position) in sorted((chosen["near"] | chosen["exceeds"]).items()):
        if word in meanings or (word in near_m and word in exceeds):
            faults.append(position.fault(f"{word!r} already has another meaning; {_ANOTHER}", 0))
    return Vocabulary(dict(sorted(types.items())), dict(sorted(meanings.items())), near_m, exceeds), faults, warnings


_Chosen = dict[str, dict[str, tuple[Compound, Position]]]


def _replaced(facts: Sequence[tuple[Compound, Position]], faults: list[Fault]) -> _Chosen:
    """Return the fact in force by predicate and word."""
    chosen: _Chosen = {name: {} for name in WORD_FACTS}
    for fact, position in sorted(facts, key=lambda item: item[1].own):
        word = fact.args[0]
        if not isinstance(word, str) or not _WORD.fullmatch(word):
            faults.append(position.fault(f"expected a word in lower case such as soda_box, found {word}", 0))
        elif word_of(word) in RESERVED_WORDS or word == ANY or word in REFUSED:
            faults.append(position.fault(f"{word!r} cannot be a word: the goal language uses it; {_ANOTHER}", 0))
        elif word in chosen[fact.name] and chosen[fact.name][word][1].own == position.own:
            before = chosen[fact.name][word]
            faults.append(position.fault(f"{fact} contradicts {before[0]} in {before[1]}; leave one of them out"))
        else:
            chosen[fact.name][word] = (fact, position)
    return chosen


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
    size = _integers(fact, position, faults, [_Range("a size", 1, 10_000, "mm")] * 3)
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


def _colour(fact: Compound, position: Position, faults: list[Fault]) -> HsvVolume | None:
    problems = [
        (at + 1, f"{name} from {fact.args[at]} to {fact.args[at + 1]} is empty; {remedy}")
        for at, name, remedy in (
            (1, "hue", "let it end elsewhere"),
            (3, "saturation", f"let it end above {fact.args[3]}"),
            (5, "value", f"let it end above {fact.args[5]}"),
        )
        if _empty(fact.args[at], fact.args[at + 1], turns=at == 1)
    ]
    faults += [position.fault(f"colour {fact.args[0]}: {problem}", at) for at, problem in problems]
    values = _integers(fact, position, faults, [_HUE] * 2 + [_PERCENT] * 4)
    if values is None or problems:
        return None
    hue, (s, s2, v, v2) = values[:2], (value / 100 for value in values[2:])
    return HsvVolume(hue=(hue[0] / 360, hue[1] / 360), saturation=(s, s2), value=(v, v2))


def _empty(low: Term, high: Term, turns: bool) -> bool:
    """Return whether the interval between two numbers is empty; with `turns` it may wrap around."""
    if not isinstance(low, int) or not isinstance(high, int):
        return False
    return low % 360 == high % 360 and high - low != 360 if turns else low >= high


def _weight(fact: Compound, position: Position, faults: list[Fault]) -> WeightInterval | None:
    open_ended = fact.args[2] == ANY
    limits = Compound(fact.name, fact.args[:2]) if open_ended else fact
    grams = _integers(limits, position, faults, [_GRAMS, _GRAMS_OR_ANY])
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
        word: _integers(fact, position, faults, [_Range("a distance", 1, 100_000, "mm")])
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


@dataclass(frozen=True, slots=True)
class _Range:
    """The numbers an argument may be: name, least, greatest (None: no end), unit, and other values allowed."""

    of: str
    low: int
    high: int | None
    unit: str
    instead: str = ""
    turns: bool = False  # whether the range is a circle, its end equal to its beginning

    def expected(self) -> str:
        upto = "" if self.high is None else f" to {self.high}"
        return f"{self.of} from {self.low}{upto} {self.unit}{self.instead}"

    def holds(self, value: Term) -> bool:
        return isinstance(value, int) and self.low <= value and (self.high is None or value <= self.high)

    def nearest(self, value: Term) -> str:
        """Return a hint at the nearest allowed value for a number out of the range."""
        if not isinstance(value, int):
            return "write a whole number"
        if self.turns and self.high is not None:
            return f"{value} {self.unit} are {value % self.high}"
        return f"write at least {self.low}" if value < self.low else f"write at most {self.high}"


_HUE: Final = _Range("a hue", 0, 360, "degrees", turns=True)
_PERCENT: Final = _Range("a number", 0, 100, "percent")
_GRAMS: Final = _Range("a weight", 0, None, "grams")
_GRAMS_OR_ANY: Final = _Range("a weight", 0, None, "grams", ", or any for no end")


def _integers(fact: Compound, position: Position, faults: list[Fault], ranges: Sequence[_Range]) -> list[int] | None:
    """Return the arguments after the word if each is an integer in its range."""
    good: list[int] = []
    for i, (value, allowed) in enumerate(zip(fact.args[1:], ranges, strict=False), 1):
        if isinstance(value, int) and allowed.holds(value):
            good.append(value)
        else:
            wrong = f"{fact.name} {fact.args[0]}: expected {allowed.expected()}, found {value}"
            faults.append(position.fault(f"{wrong}; {allowed.nearest(value)}", i))
    return good if len(good) == len(fact.args) - 1 else None


def _overlaps(colours: Mapping[str, tuple[Term, Position]], meanings: Mapping[str, Meaning]) -> list[Fault]:
    """Return a warning for every two colours that overlap, at the user's own fact if there is one."""
    volumes = {word: meaning for word, meaning in meanings.items() if isinstance(meaning, HsvVolume)}
    return [
        (colours[first][1] if colours[first][1].own else colours[second][1]).fault(
            f"warning: the colours {first} and {second} overlap"
        )
        for first, second in combinations(sorted(volumes), 2)
        if _share(volumes[first], volumes[second])
    ]


def _gaps(colours: Mapping[str, tuple[Term, Position]], meanings: Mapping[str, Meaning]) -> list[Fault]:
    """Return a warning for every range of hues without a name, at full saturation and value.

    A warning stands at the fact of the colour before the gap; a user can close the gap in an own file.
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
            position = colours[last or word][1]
            found.append(position.fault(f"warning: no colour for the hues {360 * end:g} to {360 * low:g} degrees"))
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
