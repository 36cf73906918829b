"""Presuppositions of `the`: that there is such an object, and only one (Strawson, "On referring", 1950).

A goal about `the green can` is neither achieved nor impossible where there is no green can or where there are two: its
presupposition fails, and the run says so.
"""

from collections.abc import Iterator

from skolem.reasoner.language.descriptions import Lambda
from skolem.reasoner.language.expressions import Believed, Den, Goal, Sentence, parts_of
from skolem.reasoner.planning.denotations import Denotations
from skolem.reasoner.protocols import BeliefQueries
from skolem.traces.messages import RunStatus

_SURE = 0.9  # two objects are told apart by a word that is true of one and false of the other with this probability
_MOST_WORDS = 3  # that tell two objects apart, said at most


Failed = tuple[RunStatus, str]  # the status with which a run ends, and the reason


def several(goal: Goal, denotations: Denotations, belief: BeliefQueries) -> Failed | None:
    """Return the end of a run in which several objects are believed to be the one that is meant; None if they are not.

    It is believed with the probability that the goal asks of the description. No look makes them fewer.
    """
    for description, p in _meant(goal):
        none, one = denotations.number(description, belief)
        if 1.0 - none - one >= p:
            constant = denotations.any_such(description)
            return "no_unique_referent", _several(description, constant, denotations, belief, 1.0 - none - one)
    return None


def nothing(goal: Goal, denotations: Denotations, belief: BeliefQueries) -> Failed | None:
    """Return the end of a run in which nothing is believed to be what is meant; None if something may be.

    It ends a run only where nothing is left to try: a look at a region may show such an object.
    """
    for description, p in _meant(goal):
        none, _ = denotations.number(description, belief)
        if none >= p:
            regions = ", ".join(f"{r} ({belief.prob_contents(r):.2f} known)" for r in belief.regions())
            looked = f"; regions that were told of: {regions}" if regions else ""
            return "no_referent", f"nothing is {description} (P = {none:.3f}){looked}"
    return None


def vacuous(goal: Goal, denotations: Denotations, belief: BeliefQueries) -> str:
    """Return which sentences are believed to be true of nothing, as a continued sentence."""
    constants = {sentence: name for name, sentence in goal.sentences.items()}
    said = ""
    for conjunct in goal.conjuncts:
        if isinstance(conjunct, Believed) and isinstance(conjunct.phi, Sentence):
            p = denotations.vacuous(constants[conjunct.phi], belief)
            if p >= conjunct.p:
                said += f"; true of nothing: {conjunct.phi} (P that there is no such object = {p:.3f})"
    return said


def _meant(goal: Goal) -> Iterator[tuple[Lambda, float]]:
    for conjunct in goal.conjuncts:
        if isinstance(conjunct, Believed):
            for phi in parts_of(conjunct.phi):
                if isinstance(phi, Den) and phi.description.kind == "the":
                    yield phi.description, conjunct.p


def _several(description: Lambda, constant: str, denotations: Denotations, belief: BeliefQueries, p: float) -> str:
    fitting = denotations.probabilities(constant, belief)
    first, *others = sorted(fitting, key=lambda anchor: -fitting[anchor])
    said = f"more than one object is {description} (P = {p:.3f})"
    if not others:
        return f"{said}: {first} ({fitting[first]:.3f}), and others that are not met yet"
    second = others[0]
    both = f"{first} ({fitting[first]:.3f}), {second} ({fitting[second]:.3f})"
    words = [*_telling_apart(first, second, denotations, belief)][:_MOST_WORDS]
    told = f"; what tells them apart: {'; '.join(words)}" if words else "; nothing that is known tells them apart"
    return f"{said}: {both}{told}"


def _telling_apart(first: str, second: str, denotations: Denotations, belief: BeliefQueries) -> Iterator[str]:
    if (on := belief.support(first)) != (other := belief.support(second)):
        yield f"{first} is on {on or 'the floor or in a hand'}, {second} on {other or 'the floor or in a hand'}"
    for word, meaning in denotations.words.items():
        has, lacks = belief.prob_property(first, meaning), belief.prob_property(second, meaning)
        if has >= _SURE and lacks <= 1.0 - _SURE:
            yield f"{first} is {word}"
        if lacks >= _SURE and has <= 1.0 - _SURE:
            yield f"{second} is {word}"
