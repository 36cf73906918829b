"""What the words of goals mean, as far as drawing worlds needs it: given from outside, so that no rule is read here."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from skolem.traces.messages import HsvVolume, Meaning, ObjectType, TypeIs, WeightInterval

Hsv = tuple[float, float, float]


@dataclass(frozen=True)
class Words:
    """A vocabulary.

    Attributes:
        types: Every object type by its word.
        meanings: Every property by its word; types are properties too.
        margins: Of colours that were asked about, kept.
    """

    types: Mapping[str, ObjectType]
    meanings: Mapping[str, Meaning]
    margins: dict[Hsv, float] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def colours(self) -> dict[str, HsvVolume]:
        """The words of colours, in order of the alphabet."""
        items = sorted(self.meanings.items())
        return {word: meaning for word, meaning in items if not isinstance(meaning, TypeIs | WeightInterval)}

    def colour_of(self, hsv: Hsv) -> str | None:
        """Return the first word that a colour is called by; None if there is none."""
        return next((word for word, meaning in self.colours.items() if meaning.contains(hsv)), None)

    def weight_words(self) -> dict[str, WeightInterval]:
        """Return the words of weights, in order of the alphabet."""
        items = sorted(self.meanings.items())
        return {word: meaning for word, meaning in items if isinstance(meaning, WeightInterval)}

    def weight_borders(self) -> tuple[float, ...]:
        """Return the weights at which a word begins or ends, kg, ascending."""
        ends = {end for item in self.weight_words().values() for end in (item.at_least_kg, item.below_kg) if end}
        return tuple(sorted(ends))
