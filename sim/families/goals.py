"""Descriptions and goals: their text, whether an object fits, and by which margin."""

from collections.abc import Sequence
from dataclasses import dataclass

from skolem.sim.families.margins import MAX_SD, WEIGHT_SD_KG, colour_margin
from skolem.sim.families.words import Hsv, Words
from skolem.traces.messages import TypeIs, TypeIsNot, WeightInterval

Body = tuple[str, Hsv | None, float | None]  # type, colour, mass [kg]


@dataclass(frozen=True, slots=True)
class Property:
    """A property: a word of the vocabulary or, with `grams`, a comparison of the weight; perhaps negated."""

    word: str
    grams: int | None = None
    negated: bool = False

    def text(self) -> str:
        """Return its text in the goal language, about x."""
        name = "".join(part.capitalize() for part in self.word.split("_"))
        text = f"{name}(x)" if self.grams is None else f"{name}(x, {self.grams})"
        return f"not {text}" if self.negated else text

    def holds(self, body: Body, words: Words) -> bool:
        """Return whether it is true of a body."""
        return self._said(body, words) != self.negated

    def _said(self, body: Body, words: Words) -> bool:
        """Return whether the word is true of a body."""
        kind, hsv, kg = body
        if self.grams is not None:
            return kg is not None and kg >= self.grams / 1000.0
        meaning = words.meanings[self.word]
        if isinstance(meaning, TypeIs):
            return kind == meaning.type
        if isinstance(meaning, TypeIsNot):
            return kind != meaning.type
        if isinstance(meaning, WeightInterval):
            return kg is not None and meaning.at_least_kg <= kg and (meaning.below_kg is None or kg < meaning.below_kg)
        return hsv is not None and meaning.contains(hsv)

    def margin(self, body: Body, words: Words) -> float:
        """Return the distance of a body from the border of the property, in standard deviations of one reading."""
        _, hsv, kg = body
        meaning = None if self.grams is not None else words.meanings[self.word]
        if isinstance(meaning, TypeIs | TypeIsNot):
            return MAX_SD
        if meaning is None or isinstance(meaning, WeightInterval):
            ends = (self.grams or 0) / 1000.0 if meaning is None else meaning
            borders = [ends] if isinstance(ends, float) else [end for end in (ends.at_least_kg, ends.below_kg) if end]
            return min((MAX_SD, *(abs((kg or 0.0) - end) / WEIGHT_SD_KG for end in borders)))
        return MAX_SD if hsv is None else colour_margin(hsv, words)


@dataclass(frozen=True, slots=True)
class Description:
    """A conjunction of alternatives of properties: each inner tuple is a disjunction."""

    parts: tuple[tuple[Property, ...], ...]

    def text(self, *more: str) -> str:
        """Return its text in the goal language, about x, with more conjuncts at its end."""
        said = [" | ".join(each.text() for each in part) for part in self.parts] + list(more)
        return " & ".join(f"({text})" if "|" in text and len(said) > 1 else text for text in said)

    def fits(self, body: Body, words: Words) -> bool:
        """Return whether it is true of a body."""
        return all(any(each.holds(body, words) for each in part) for part in self.parts)

    def margin(self, body: Body, words: Words) -> float:
        """Return the margin by which a body fits, in standard deviations of one reading; 0 if it does not fit."""
        best = [max((p.margin(body, words) for p in part if p.holds(body, words)), default=0.0) for part in self.parts]
        return min(best, default=MAX_SD)


@dataclass(frozen=True, slots=True)
class Clause:
    """One variable of a goal: an object with its description must be known and, with a target, be on that table."""

    variable: str
    description: Description
    target: str | None


def goal_text(clauses: Sequence[Clause], bound: float, placed: float) -> str:
    """Return the goal in the goal language.

    Args:
        clauses: One per variable.
        bound: Bound of the denotations.
        placed: Bound of the objects' being on their targets.
    """
    names = ", ".join(clause.variable for clause in clauses)
    beliefs = []
    for clause in clauses:
        beliefs.append(f"B(Den(lambda x. {clause.description.text()}, {clause.variable}), {bound:g})")
        if clause.target is not None:
            beliefs.append(f"B(On({clause.variable}, {clause.target}), {placed:g})")
    return f"exists {names}. {' & '.join(beliefs)}"
