"""The objects, regions and descriptions in terms, in words."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from skolem.traces.messages import ColourMeaning
from skolem.traces.wording.descriptions import Description, descriptions, predicate
from skolem.traces.wording.recorded import Recorded


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

    def name(self, term: Recorded) -> str:
        """Return the name of an object: its anchor, the variable of the goal, or `the green thing to be found`."""
        match term:
            case Recorded("sk", (Recorded("var", (Recorded(variable),)),)):
                described = self._descriptions[0].get(self._descriptions[1].get(variable, ""))
                phrase = described.phrase(self.nouns) if described and described.words else ""
                return f"{phrase if phrase and ' that is ' not in phrase else 'the object'} to be found"
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
        return f"sentence {str(constant).removeprefix('s')} of the goal is true"

    def is_meant(self, expression: Recorded, thing: Recorded) -> str:
        """Return the clause that an object is meant by a description."""
        name = "the object to be found" if thing.name == "sk" else self.name(thing)
        known = str(expression) in self._descriptions[0]
        return f"{name} is {self.described(expression)}" if known else f"{name} is meant"

    def has(self, thing: Recorded, *words: Recorded) -> str:
        """Return the clause that an object has some properties."""
        return f"{self.name(thing)} is {predicate([str(word) for word in words], self.nouns)}"

    def of_type(self, thing: Recorded, word: Recorded) -> str:
        """Return the clause that an object is of a type."""
        return f"{self.name(thing)} is {predicate([str(word)], [str(word)])}"
