"""The descriptions that a goal leads to: its own, and those of the objects that its sentences and `the` are about."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from skolem.reasoner.language.descriptions import Lambda, Was
from skolem.reasoner.language.expressions import Sentence
from skolem.reasoner.meaning.literals import Alternatives, Literals
from skolem.reasoner.meaning.related import Related, related
from skolem.reasoner.meaning.statements import Statement, statement
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.terms import Compound
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


@dataclass(frozen=True, slots=True)
class Witnessed:
    """A description by a relation to another object, the witness, by the constants of descriptions.

    Attributes:
        relation: The relation.
        from_witness: Whether the witness is its first argument.
        itself: What else is said of the described object; None if nothing is.
        witness: What is said of the witness; None if nothing is.
    """

    relation: str
    from_witness: bool
    itself: str | None
    witness: str | None


@dataclass(frozen=True, slots=True)
class Ranked:
    """A superlative among the objects that fit a description: one beats each of the others.

    Attributes:
        kind: heaviest, lightest or nearest.
        fitting: The constant of the description.
        to: The object to which one is nearest; None for the others.
    """

    kind: str
    fitting: str
    to: str | None

    def beats(self, one: str, other: str) -> Compound:
        """Return the statement that one object is ahead of another."""
        match self.kind:
            case "heaviest":
                return Compound("heavier", (one, other))
            case "lightest":
                return Compound("heavier", (other, one))
        return Compound("nearer", (one, other, str(self.to)))


@dataclass(slots=True)
class Universe:
    """The descriptions of a goal by constant.

    Attributes:
        descriptions: Every description; `e1_any` is that of all objects of which `e1` means the only one.
        counted: What a sentence, or a description that means the only such object, says of how many there are.
        ranked: The descriptions that are superlatives.
        witnessed: The descriptions that ask for a witness.
        true, false: The minimal sets of properties that make a description true or false of an object.
        meanings: The meaning of each property.
    """

    descriptions: dict[str, Lambda] = field(default_factory=dict)
    counted: dict[str, Counted] = field(default_factory=dict)
    ranked: dict[str, Ranked] = field(default_factory=dict)
    witnessed: dict[str, Witnessed] = field(default_factory=dict)
    true: dict[str, Alternatives] = field(default_factory=dict)
    false: dict[str, Alternatives] = field(default_factory=dict)
    meanings: Mapping[str, Meaning] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        expressions: Mapping[str, Lambda],
        sentences: Mapping[str, Sentence],
        vocabulary: Vocabulary,
        witnesses: bool = True,
    ) -> "Universe":
        """Return the descriptions that a goal's own descriptions and sentences lead to.

        Args:
            expressions: The descriptions of the goal.
            sentences: Its sentences.
            vocabulary: The words.
            witnesses: Whether witnesses are looked for; otherwise relations count as settled, as in the paper.
        """
        found, literals = cls(), Literals(vocabulary)
        for name, description in expressions.items():
            found._add(name, description, literals)
            if description.kind != "lambda":
                every = replace(description, kind="lambda", to=None, body=Was(description.body))
                fitting = found._add(f"{name}_any", every, literals)
                found.counted[name] = Counted(1, 1 if description.kind == "the" else None, fitting, fitting)
                found.true[name] = ()
            if description.kind not in ("lambda", "the"):
                to = description.to.name if description.to else None
                found.ranked[name] = Ranked(description.kind, fitting, to)
        for name, description in list(found.descriptions.items()) if witnesses else ():
            if description.kind == "lambda" and (said := related(description)) is not None:
                found.witnessed[name] = found._witnessed(name, said, literals)
                found.true[name] = ()
        for name, sentence in sentences.items():
            if (counted := statement(sentence.body)) is not None:
                found.counted[name] = found._counted(name, counted, literals)
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

    def _witnessed(self, name: str, said: Related, literals: Literals) -> Witnessed:
        itself = self._add(f"{name}_itself", said.itself, literals) if said.itself else None
        witness = self._add(f"{name}_witness", said.witness, literals) if said.witness else None
        return Witnessed(said.relation, said.from_witness, itself, witness)

    def about(self, description: str) -> Counted | None:
        """Return what is counted by a description that objects fit; None if none is."""
        return next((counted for counted in self.counted.values() if counted.fitting == description), None)
