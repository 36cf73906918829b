"""The descriptions and sentences of a goal: how probable it is that an object is meant, or that a sentence is true.

What a probability is, the goal says: the share of the possible worlds of the belief, or the paper's product.
"""

from collections.abc import Mapping
from typing import Final

from skolem.reasoner.language.descriptions import Count, Every, Exists, Lambda, Not, Was
from skolem.reasoner.language.expressions import Goal, Sentence
from skolem.reasoner.meaning.literals import Alternatives
from skolem.reasoner.meaning.universe import Universe
from skolem.reasoner.planning.denotation import STRANGER, WithStranger, evaluate, evaluate_at
from skolem.reasoner.protocols import GroundBeliefs, OpenBeliefs
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.terms import Compound, Term
from skolem.reasoner.worlds.circuits import Circuit, compile_description, compile_sentence
from skolem.reasoner.worlds.evaluator import Evaluator, Interval
from skolem.traces.messages import Meaning

_NO: Final = Interval(0.0, 0.0)


class Denotations:
    """The descriptions and sentences of a goal, evaluated once per version of the belief.

    Attributes:
        universe: The descriptions that the goal leads to.
        circuits: The circuit of each description and sentence, by its constant.
        meanings: The meaning of each property by name: those of the words, the comparisons with numbers, and the
            complements of which the goal speaks.
        alternatives: The minimal sets of properties that make each description true, by its constant.
    """

    def __init__(self, goal: Goal, rulebook: Rulebook) -> None:
        self._vocabulary = rulebook.vocabulary
        self._by_worlds, self._key = goal.evaluation == "worlds", str(goal)
        self.universe = Universe.of(goal.expressions, goal.sentences, self._vocabulary, self._by_worlds)
        self.circuits: dict[str, Circuit] = {
            name: compile_description(found, rulebook) for name, found in self.universe.descriptions.items()
        }
        sentences = dict(goal.sentences) | _numbers(goal.expressions) | _nothing(goal.sentences)
        self.circuits |= {name: compile_sentence(sentence, rulebook) for name, sentence in sentences.items()}
        self._worlds = Evaluator(self.circuits, self._vocabulary, self._key)
        self._constants = {description: name for name, description in goal.expressions.items()}
        self.meanings: Mapping[str, Meaning] = self.universe.meanings
        self.alternatives: Mapping[str, Alternatives] = self.universe.true
        self._version: int | None = None
        self._products: dict[str, dict[str, float]] = {}

    @property
    def words(self) -> Mapping[str, Meaning]:
        """The meanings of the words that the rules give."""
        return self._vocabulary.meanings

    # ------------------------------------------------------------ probabilities

    def probabilities(self, expression: str, belief: GroundBeliefs) -> Mapping[str, float]:
        """Return P(Den) for every anchor; the middle of its bounds where it is not known exactly."""
        if self._by_worlds:
            return {anchor: found.middle for anchor, found in self._worlds.table(expression, belief).items()}
        if belief.version != self._version:
            self._version, self._products = belief.version, {}
        if expression not in self._products:
            self._products[expression] = evaluate(self.circuits[expression], belief, self._vocabulary)
        return self._products[expression]

    def probability(self, expression: str, anchor: str, belief: GroundBeliefs) -> float:
        """Return P(Den), the middle of its bounds; 0 for an unknown anchor."""
        return self.interval(Compound("den", (expression, anchor)), belief).middle

    def interval(self, phi: Term, belief: GroundBeliefs, at_least: float | None = None) -> Interval:
        """Return the bounds between which the probability of a statement lies.

        Args:
            phi: den(E, o), holds_of_the_world(S), or together(phi, phi').
            belief: The belief.
            at_least: The probability that decides; the bounds are narrowed until it does. None: any answer will do.
        """
        match phi:
            case Compound("den", (str(expression), str(anchor))):
                if self._by_worlds:
                    return self._worlds.probability(expression, anchor, belief, at_least)
                p = self.probabilities(expression, belief).get(anchor, 0.0)
                return Interval(p, p)
            case Compound("beaten", (str(expression), str(rival), str(anchor))):
                return self._beaten(expression, rival, anchor, belief)
            case Compound("together", (first, second)):
                return self._worlds.together((first, *_parts(second)), belief, at_least)
        return self._worlds.together((phi,), belief, at_least)

    def _beaten(self, expression: str, rival: str, anchor: str, belief: GroundBeliefs) -> Interval:
        """Return the bounds of P(a rival does not fit a superlative, or the anchor is ahead of it)."""
        ranked = self.universe.ranked[expression]
        fits = self._worlds.probability(ranked.fitting, rival, belief)
        ahead = self._worlds.together((ranked.beats(anchor, rival),), belief)
        return Interval(1.0 - fits.high * (1.0 - ahead.low), 1.0 - fits.low * (1.0 - ahead.high))

    def probability_of_new(self, expression: str, region: str, belief: OpenBeliefs) -> float:
        """Return P(Den) of an arbitrary object in the region that is not met yet."""
        extended = WithStranger(belief, region)
        if not self._by_worlds:
            return evaluate_at(STRANGER, self.circuits[expression], extended, self._vocabulary)
        worlds = Evaluator(self.circuits, self._vocabulary, self._key)
        return worlds.together((Compound("den", (expression, STRANGER)),), extended, strangers=False).low

    def conjuncts(self, expression: str, anchor: str, belief: GroundBeliefs) -> dict[str, float]:
        """Return the probability of each property in the description, for explanations."""
        return {name: belief.prob_property(anchor, self.meanings[name]) for name in self.circuits[expression].props}

    def vacuous(self, sentence: str, belief: GroundBeliefs) -> float:
        """Return P(there is no object of which a sentence speaks); 0 if it does not speak of every object of a kind."""
        name = f"{sentence}_nothing"
        return self._worlds.sentence(name, belief).low if name in self.circuits else 0.0

    # ------------------------------------------------------------ the only one

    def any_such(self, description: Lambda) -> str:
        """Return the constant for all objects of which a description of the goal means the only one."""
        return self.universe.counted[self._constants[description]].fitting

    def number(self, description: Lambda, belief: GroundBeliefs) -> tuple[float, float]:
        """Return P(no object fits) and P(exactly one does), of a description of the goal that means the only one."""
        name = self._constants[description]
        none, one = (self._worlds.sentence(each, belief) for each in (f"{name}_none", f"{name}_one"))
        return none.middle, one.middle


def _numbers(expressions: Mapping[str, Lambda]) -> dict[str, Sentence]:
    """Return the sentences that no object fits and that one does, for each description that means the only one."""
    found: dict[str, Sentence] = {}
    for name, each in expressions.items():
        if each.kind == "the":
            found[f"{name}_none"] = Sentence(Was(Not(Exists(each.variable, each.body))))
            found[f"{name}_one"] = Sentence(Was(Count("exactly", 1, each.variable, each.body)))
    return found


def _nothing(sentences: Mapping[str, Sentence]) -> dict[str, Sentence]:
    """Return the sentence that there is nothing, for each sentence about every object of a kind."""
    return {
        f"{name}_nothing": Sentence(Not(Exists(said.variable, said.condition)))
        for name, sentence in sentences.items()
        if isinstance(said := sentence.body, Every)
    }


def _parts(phi: Term) -> tuple[Term, ...]:
    match phi:
        case Compound("together", (first, second)):
            return (first, *_parts(second))
    return (phi,)
