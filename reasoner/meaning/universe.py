"""The descriptions that a goal leads to: its own, and those of the objects that its sentences and `the` are about."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from skolem.reasoner.language.descriptions import Lambda
from skolem.reasoner.language.expressions import Sentence
from skolem.reasoner.meaning.literals import Alternatives, Literals
from skolem.reasoner.meaning.statements import Statement, statement
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.traces.messages import Meaning


@dataclass(frozen=True, slots=True)
class Counted:
    """A number of objects that fit a description, by the constants of descriptions.

    Attributes:
        low: At least so many.
        high: At most so many; None for any number.
        fitting: The description.
        kind: What is left of it if the objects stand on `on`; None if nothing is.
        on: Where each of the objects stands.
        unless_on: An object that stands there does not fit.
    """

    low: int
    high: int | None
    fitting: str
    kind: str | None
    on: tuple[str, ...] = ()
    unless_on: tuple[str, ...] = ()


@dataclass(slots=True)
class Universe:
    """The descriptions of a goal by constant.

    Attributes:
        descriptions: Every description; `e1_any` is that of all objects of which `e1` means the only one.
        counted: What a sentence, or a description that means the only such object, says of how many there are.
        true, false: The minimal sets of properties that make a description true or false of an object.
        meanings: The meaning of each property.
    """

    descriptions: dict[str, Lambda] = field(default_factory=dict)
    counted: dict[str, Counted] = field(default_factory=dict)
    true: dict[str, Alternatives] = field(default_factory=dict)
    false: dict[str, Alternatives] = field(default_factory=dict)
    meanings: Mapping[str, Meaning] = field(default_factory=dict)

    @classmethod
    def of(
        cls, expressions: Mapping[str, Lambda], sentences: Mapping[str, Sentence], vocabulary: Vocabulary
    ) -> "Universe":
        """Return the descriptions that a goal's own descriptions and sentences lead to."""
        found, literals = cls(), Literals(vocabulary)
        for name, description in expressions.items():
            found._add(name, description, literals)
            if description.kind == "the":
                found._add(f"{name}_any", replace(description, kind="lambda"), literals)
                found.counted[name] = Counted(1, 1, f"{name}_any", f"{name}_any")
                found.true[name] = ()
        for name, sentence in sentences.items():
            said = statement(sentence.body)
            if said is not None:
                found.counted[name] = found._counted(name, said, literals)
        found.meanings = literals.meanings
        return found

    def _add(self, name: str, description: Lambda, literals: Literals) -> str:
        self.descriptions[name] = description
        self.true[name], self.false[name] = literals.true(description), literals.false(description)
        return name

    def _counted(self, name: str, said: Statement, literals: Literals) -> Counted:
        fitting = self._add(f"{name}_any", said.fitting, literals)
        kind = fitting if said.kind else None
        if said.on and said.kind:
            kind = self._add(f"{name}_kind", said.kind, literals)
        return Counted(said.low, said.high, fitting, kind, said.on, said.unless_on)

    def about(self, description: str) -> Counted | None:
        """Return what is counted by a description that objects fit; None if none is."""
        return next((counted for counted in self.counted.values() if counted.fitting == description), None)
