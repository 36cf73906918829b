"""Faults of a goal that is well formed: relations that cannot be evaluated, and bounds that no belief can reach."""

from collections.abc import Iterator

from skolem.reasoner.language.descriptions import SPATIAL, And, Atom, Exists, Expression, Number, Or, word_of
from skolem.reasoner.language.expressions import Believed, Den, Estimated, Goal
from skolem.reasoner.rulebook.vocabulary import Vocabulary


def misused(goal: Goal, vocabulary: Vocabulary) -> list[str]:
    """Return a text for each wrong relation of a goal that is well formed and has known words only."""
    comparing = {word_of(word) for word in vocabulary.exceeds}
    alone = [each.phi for each in goal.conjuncts if isinstance(each, Believed) and isinstance(each.phi, Atom)]
    faults = [
        f"{atom}: {atom.word} is for descriptions only; write it inside of a lambda"
        for atom in alone
        if len(atom.args) > 1 and atom.word not in SPATIAL
    ]
    for description in goal.expressions.values():
        faults += [_wrong(atom, atom.word in comparing) for atom in _atoms(description.body)]
    return [fault for fault in faults if fault]


def too_sure(goal: Goal, most: float) -> list[str]:
    """Return a text for each conjunct whose bound no belief can reach.

    Args:
        goal: A well-formed goal.
        most: Greatest probability with which any object is believed to exist.
    """
    needing = [
        each
        for each in goal.conjuncts
        if isinstance(each, Estimated)
        or (isinstance(each, Believed) and (isinstance(each.phi, Den) or getattr(each.phi, "word", "") in SPATIAL))
    ]
    why = f"no object is ever believed to exist with more than {most:g}, so neither is this; ask for at most {most:g}"
    return [f"{each}: {why}" for each in needing if each.p > most]


def _atoms(expression: Expression) -> Iterator[Atom]:
    match expression:
        case Atom():
            yield expression
        case And(left, right) | Or(left, right):
            yield from _atoms(left)
            yield from _atoms(right)
        case Exists(_, body):
            yield from _atoms(body)


def _wrong(atom: Atom, compares: bool) -> str:
    """Return a text for wrong arguments of a relation; empty if they are of the right kinds."""
    last, *_ = reversed(atom.args)
    if any(isinstance(each, Number) for each in atom.args[:-1]):
        return f"{atom}: {atom.word} is of an object first"
    if compares and not isinstance(last, Number):
        return f"{atom}: {atom.word} compares with a number, found {last}"
    if not compares and isinstance(last, Number):
        return f"{atom}: {atom.word} is between objects, found the number {last}"
    return ""
