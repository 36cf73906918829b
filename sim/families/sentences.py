"""Goals beyond lambda: negation, different objects, the only one, numbers, all of a kind; their text and their truth.

The truth is read off the true world by counting, apart from the rules and from the evaluation of beliefs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from skolem.sim.families.goals import Description
from skolem.sim.families.ranges import Construct
from skolem.sim.families.things import Thing
from skolem.sim.families.words import Words

NUMBERS = {"at_least": "at least", "at_most": "at most", "exactly": "exactly"}
OF_AN_OBJECT = ("not", "distinct", "the", "together")  # goals about what variables mean; the others are sentences


@dataclass(frozen=True, slots=True)
class Sentence:
    """A goal with one construct.

    Attributes:
        construct: What is new in it.
        description: What the objects are like.
        number: How many; 2 for `distinct`, 1 where the construct names no number.
        target: The table on which they are to be; None: anywhere.
    """

    construct: Construct
    description: Description
    number: int
    target: str | None

    @property
    def variables(self) -> tuple[str, ...]:
        """The variables of the goal: those of its head, or the one that the sentence binds."""
        return ("o", "u") if self.construct == "distinct" else ("o",) if self.construct in OF_AN_OBJECT else ("x",)

    def text(self, bound: float, placed: float) -> str:
        """Return the goal in the goal language.

        Args:
            bound: Bound of the denotations and of sentences.
            placed: Bound of the objects' being on the target.
        """
        said = self.description.text()
        if self.construct == "together":
            return f"exists o. B(Den(lambda x. {said}, o) & On(o, {self.target}), {bound:g})"
        if self.construct in OF_AN_OBJECT:
            binder = "the" if self.construct == "the" else "lambda"
            beliefs = []
            for variable in self.variables:
                beliefs.append(f"B(Den({binder} x. {said}, {variable}), {bound:g})")
                beliefs += [] if self.target is None else [f"B(On({variable}, {self.target}), {placed:g})"]
            head = "exists distinct" if self.construct == "distinct" else "exists"
            return f"{head} {', '.join(self.variables)}. {' & '.join(beliefs)}"
        on = "" if self.target is None else f"On(x, {self.target})"
        if self.construct == "every":
            return f"B(every x. {said} -> {on}, {bound:g})"
        quantifier = f"{NUMBERS[self.construct]} {self.number}" if self.construct in NUMBERS else "not exists"
        return f"B({quantifier} x. {self.description.text(*([on] if on else []))}, {bound:g})"

    def fitting(self, things: Sequence[Thing], words: Words) -> list[Thing]:
        """Return the objects that are as described, wherever they are."""
        return [thing for thing in things if self.description.fits((thing.type, thing.hsv, thing.kg), words)]

    def meant(self, things: Sequence[Thing], words: Words) -> list[Thing]:
        """Return the objects that are as described and on the target."""
        return [thing for thing in self.fitting(things, words) if self.target in (None, thing.on)]

    def true(self, things: Sequence[Thing], words: Words) -> bool:
        """Return whether the goal is true of objects where they stand."""
        fitting, meant = len(self.fitting(things, words)), len(self.meant(things, words))
        match self.construct:
            case "not" | "together" | "distinct" | "at_least":
                return meant >= self.number
            case "the":
                return fitting == meant == 1
            case "exactly":
                return meant == self.number
            case "at_most":
                return meant <= self.number
            case "every":
                return fitting == meant
            case "not_exists":
                return meant == 0
