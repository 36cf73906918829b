"""The meanings of words for drawing worlds; they are passed in, so that no rule file is read here."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from skolem.traces.messages import ColourMeaning, Meaning, ObjectType, WeightInterval

Hsv = tuple[float, float, float]


@dataclass(frozen=True)
class Words:
    """A vocabulary.

    Attributes:
        types: Every object type by its word.
        meanings: Every property by its word; types are properties too.
        margins: Margins of colours, kept once computed.
    """

    types: Mapping[str, ObjectType]
    meanings: Mapping[str, Meaning]
    margins: dict[Hsv, float] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def colours(self) -> dict[str, ColourMeaning]:
        """The words of colours, in alphabetical order."""
        items = sorted(self.meanings.items())
        return {word: meaning for word, meaning in items if isinstance(meaning, ColourMeaning)}

    def colour_of(self, hsv: Hsv) -> str | None:
        """Return the first word of a colour; None if it has none."""
        return next((word for word, meaning in self.colours.items() if meaning.contains(hsv)), None)

    def weight_words(self) -> dict[str, WeightInterval]:
        """Return the words of weights, in alphabetical order."""
        items = sorted(self.meanings.items())
        return {word: meaning for word, meaning in items if isinstance(meaning, WeightInterval)}

    def weight_borders(self) -> tuple[float, ...]:
        """Return the weights at which a word begins or ends, kg, ascending."""
        ends = {end for item in self.weight_words().values() for end in (item.at_least_kg, item.below_kg) if end}
        return tuple(sorted(ends))
