"""Relations in a goal that nothing can tell: those that compare take an object and a number, the others objects."""

from collections.abc import Iterator

from skolem.reasoner.expressions import SPATIAL, And, Atom, Believed, Exists, Expression, Goal, Number, Or, word_of
from skolem.reasoner.vocabulary import Vocabulary


def misused(goal: Goal, vocabulary: Vocabulary) -> list[str]:
    """Return what is wrong with relations of a goal that is well formed and has known words only."""
    comparing = {word_of(word) for word in vocabulary.exceeds}
    alone = [each.phi for each in goal.conjuncts if isinstance(each, Believed) and isinstance(each.phi, Atom)]
    faults = [
        f"{atom}: {atom.word} is told of described objects only; write it inside of a lambda"
        for atom in alone
        if len(atom.args) > 1 and atom.word not in SPATIAL
    ]
    for description in goal.expressions.values():
        faults += [_wrong(atom, atom.word in comparing) for atom in _atoms(description.body)]
    return [fault for fault in faults if fault]


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
    """Return what is wrong with the arguments of a relation; nothing if they are of the kinds that it takes."""
    last, *_ = reversed(atom.args)
    if any(isinstance(each, Number) for each in atom.args[:-1]):
        return f"{atom}: {atom.word} is of an object first"
    if compares and not isinstance(last, Number):
        return f"{atom}: {atom.word} compares with a number, found {last}"
    if not compares and isinstance(last, Number):
        return f"{atom}: {atom.word} is between objects, found the number {last}"
    return ""
