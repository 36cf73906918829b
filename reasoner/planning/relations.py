"""Faults of a goal that is well formed: relations that cannot be evaluated, and bounds that no belief can reach."""

from collections.abc import Iterator

from skolem.reasoner.language.descriptions import (
    SPATIAL,
    And,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Not,
    Number,
    Or,
    Was,
    word_of,
)
from skolem.reasoner.language.expressions import Believed, Den, Estimated, Goal, parts_of
from skolem.reasoner.rulebook.vocabulary import Vocabulary


def misused(goal: Goal, vocabulary: Vocabulary) -> list[str]:
    """Return a text for each wrong relation of a goal that is well formed and has known words only."""
    comparing = {word_of(word) for word in vocabulary.exceeds}
    alone = [atom for each in goal.conjuncts if isinstance(each, Believed) for atom in parts_of(each.phi)]
    faults = [
        f"{atom}: {atom.word} is for descriptions only; write it inside of a lambda"
        for atom in alone
        if isinstance(atom, Atom) and len(atom.args) > 1 and atom.word not in SPATIAL
    ]
    bodies = [each.body for each in goal.expressions.values()] + [each.body for each in goal.sentences.values()]
    faults += [_wrong(atom, atom.word in comparing) for body in bodies for atom in _atoms(body)]
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
        or (isinstance(each, Believed) and any(map(_needs_existence, parts_of(each.phi))))
    ]
    why = f"no object is ever believed to exist with more than {most:g}, so neither is this; ask for at most {most:g}"
    return [f"{each}: {why}" for each in needing if each.p > most]


def of_the_start(goal: Goal) -> list[Atom]:
    """Return the relations of a goal that are about the start of the run, in order of appearance, each once.

    They are those inside of `Was(..)`, and those of a description that means one object of several: otherwise it would
    mean another object once something was moved.
    """
    found: dict[Atom, None] = {}
    for description in goal.expressions.values():
        body = description.body if description.kind == "lambda" else Was(description.body)
        found |= dict.fromkeys(_remembered(body, False))
    for sentence in goal.sentences.values():
        found |= dict.fromkeys(_remembered(sentence.body, False))
    return list(found)


def speaks_of_the_start(goal: Goal) -> bool:
    """Return whether a relation of the goal is about the start of the run; nearness to something is one, too."""
    return bool(start_text(goal))


def start_text(goal: Goal) -> str:
    """Return a sentence about what of a goal is about the start of the run; empty if nothing is."""
    said = [str(atom) for atom in of_the_start(goal)]
    said += [f"{each.kind} to {each.to}" for each in goal.expressions.values() if each.kind == "nearest"]
    verb = "is" if len(said) == 1 else "are"
    return f"{', '.join(said)} {verb} read as of the start of the run, whatever is moved since" if said else ""


def _remembered(expression: Expression, earlier: bool) -> Iterator[Atom]:
    match expression:
        case Atom(_, (_, other)) if earlier and not isinstance(other, Number):
            yield expression
        case And(left, right) | Or(left, right) | Every(_, left, right):
            yield from _remembered(left, earlier)
            yield from _remembered(right, earlier)
        case Was(body):
            yield from _remembered(body, True)
        case Exists(_, body) | Count(_, _, _, body) | Not(body):
            yield from _remembered(body, earlier)


def _needs_existence(part: object) -> bool:
    return isinstance(part, Den) or (isinstance(part, Atom) and part.word in SPATIAL)


def _atoms(expression: Expression) -> Iterator[Atom]:
    match expression:
        case Atom():
            yield expression
        case And(left, right) | Or(left, right) | Every(_, left, right):
            yield from _atoms(left)
            yield from _atoms(right)
        case Exists(_, body) | Count(_, _, _, body) | Not(body) | Was(body):
            yield from _atoms(body)


def _wrong(atom: Atom, compares: bool) -> str:
    """Return a text for wrong arguments of a relation; empty if they are of the right kinds."""
    first, *others = atom.args
    if any(isinstance(each, Number) for each in atom.args[:-1]):
        return f"{atom}: {atom.word} is of an object first"
    if not compares and isinstance(atom.args[-1], Number):
        return f"{atom}: {atom.word} is between objects, found the number {atom.args[-1]}"
    if first in others:
        return f"{atom}: {atom.word} is never true of an object and itself; name another one"
    return ""
