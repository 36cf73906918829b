"""The objects, regions and descriptions in terms, in words."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from skolem.traces.messages import ColourMeaning
from skolem.traces.wording.descriptions import Description, descriptions, predicate
from skolem.traces.wording.recorded import Recorded
from skolem.traces.wording.sentences import sentences


@dataclass(frozen=True)
class Things:
    """The facts about a run that are needed to put its terms into words.

    Attributes:
        goal: The text of the goal, which gives the names of its descriptions.
        nouns: The words that name object types: an object is `a soda`, but `green`.
        colours: The colour words of the run's rules; without them colours are given in numbers.
    """

    goal: str = ""
    nouns: frozenset[str] = frozenset()
    colours: Mapping[str, ColourMeaning] = field(default_factory=dict)

    @cached_property
    def _descriptions(self) -> tuple[dict[str, Description], dict[str, str]]:
        return descriptions(self.goal)

    @cached_property
    def _sentences(self) -> dict[str, str]:
        return sentences(self.goal)

    def name(self, term: Recorded) -> str:
        """Return the name of an object: its anchor, the variable of the goal, or `the green thing to be found`."""
        match term:
            case Recorded("sk", (Recorded("var", (Recorded(variable),)),)):
                described = self._descriptions[0].get(self._descriptions[1].get(variable, ""))
                phrase = described.phrase(self.nouns) if described and described.words else ""
                return f"{phrase if phrase and ' that is ' not in phrase else 'the object'} to be found"
            case Recorded("sk", (Recorded("one_of", (_, number)),)) if number.number is not None:
                return f"object {number.number + 1} to be found"
            case Recorded("sk", (_,)):
                return "the object to be found"
            case Recorded("var", (Recorded(variable),)):
                return variable
            case Recorded("number", (Recorded() as thousandths,)) if thousandths.number is not None:
                return f"{thousandths.number / 1000.0:g}"
        return str(term)

    def region(self, term: Recorded) -> str:
        """Return the name of a region."""
        return f"region {self.name(term)}"

    def described(self, expression: Recorded) -> str:
        """Return the object of a description of the goal: `the green thing`."""
        description = self._descriptions[0].get(str(expression))
        return "what is meant" if description is None else description.phrase(self.nouns)

    def sentence(self, constant: Recorded) -> str:
        """Return the clause that a sentence of the goal is true."""
        text = self._sentences.get(str(constant))
        return "what the goal says of the world is true" if text is None else f'"{text}" is true'

    def is_meant(self, expression: Recorded, thing: Recorded) -> str:
        """Return the clause that an object is meant by a description."""
        return self._meant(expression, thing, "is", "fits")

    def is_not_meant(self, expression: Recorded, thing: Recorded) -> str:
        """Return the clause that an object is not meant by a description."""
        return self._meant(expression, thing, "is not", "does not fit")

    def hides_none(self, expression: Recorded, region: Recorded) -> str:
        """Return the clause that the unseen part of a region holds nothing of what is meant by a description."""
        told = self._told(expression)
        what = f"fits {told}" if told else "is meant"
        return f"{self.region(region)} hides nothing that {what}"

    def _meant(self, expression: Recorded, thing: Recorded, equals: str, fits: str) -> str:
        name = "the object to be found" if thing.name == "sk" else self.name(thing)
        if str(expression) in self._descriptions[0]:
            return f"{name} {equals} {self.described(expression)}"
        told = self._told(expression)
        return f"{name} {fits} {told}" if told else f"{name} {equals} meant"

    def _told(self, expression: Recorded) -> str:
        """Return where the goal tells of all objects of a kind: of which it means one, or which a sentence counts."""
        whole, _, part = str(expression).rpartition("_")
        if part == "any" and whole in self._descriptions[0]:
            return f"the description of {self._descriptions[0][whole].phrase(self.nouns)}"
        if part in ("any", "kind") and whole in self._sentences:
            return f'what "{self._sentences[whole]}" {"counts" if part == "any" else "is about"}'
        return ""

    def has(self, thing: Recorded, *words: Recorded) -> str:
        """Return the clause that an object has some properties."""
        return f"{self.name(thing)} is {predicate([str(word) for word in words], self.nouns)}"

    def of_type(self, thing: Recorded, word: Recorded) -> str:
        """Return the clause that an object is of a type."""
        return f"{self.name(thing)} is {predicate([str(word)], [str(word)])}"
