"""Counts of failed attempts: of each command in a row, and of each command from where the robot stands.

What failed before an object was moved may succeed after it, since the object may have hidden or blocked another one. So
a pick or a place that succeeds resets the counts of the commands about other objects.

An attempt after which a fluent that is still false is nearer to being true than ever before does not count as failed:
a step may stand for many looks.
"""

from collections import Counter
from collections.abc import Mapping
from typing import Final

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import Compound, Term, compound, parse_term
from skolem.traces.messages import HANDS, Limits

_MOVES_THINGS: Final = ("pick", "place")
LEAST_GAIN: Final = 0.01  # of a degree (see `Situation.degree`): less is no progress


class Attempts:
    """Failures by command; a success resets both counts, a drive resets those from where the robot stood."""

    def __init__(self, limits: Limits) -> None:
        """Begin without failures."""
        self._limits = limits
        self._failures: Counter[Term] = Counter()
        self._in_vain: Counter[Term] = Counter()
        self._nearest: dict[Compound, float] = {}

    def judge(self, done: Instance, degrees: Mapping[Term, float]) -> None:
        """Note whether an executed step achieved what it should.

        Args:
            done: The step.
            degrees: The degree of each fluent that it should have made true and that is still false.
        """
        if done.executes is None:
            return
        achieved, nearer = not degrees, self._is_nearer(done.executes, degrees)
        self._failures[done.executes] = 0 if achieved or nearer else self._failures[done.executes] + 1
        if achieved and isinstance(done.executes, Compound) and done.executes.name in _MOVES_THINGS:
            self._forget_others(done.executes)
        if isinstance(done.executes, Compound) and done.executes.name == "move":
            self._in_vain.clear()
        else:
            self._in_vain[done.executes] = 0 if achieved or nearer else self._in_vain[done.executes] + 1

    def _forget_others(self, moving: Compound) -> None:
        """Reset the counts of the commands that are about none of the objects of a command."""
        kept = Counter({command: n for command, n in self._failures.items() if _objects(command) & _objects(moving)})
        self._failures = kept

    def _is_nearer(self, command: Term, degrees: Mapping[Term, float]) -> bool:
        """Keep the highest degrees after a command; return whether one has grown. A success forgets them."""
        if not degrees:
            self._nearest = {key: best for key, best in self._nearest.items() if key.args[0] != command}
        grown = False
        for fluent, degree in degrees.items():
            key = compound(
                "nearest", command, fluent.args[0] if isinstance(fluent, Compound) and fluent.args else fluent
            )
            best = self._nearest.get(key)
            grown |= best is not None and degree > best + LEAST_GAIN
            self._nearest[key] = degree if best is None else max(best, degree)
        return grown

    def is_hopeless(self, command: Term | None) -> bool:
        """Return whether a command failed so often in a row that it is not tried again; an inference never does."""
        return command is not None and self._failures[command] >= self._limits.repeats

    def hopeless(self) -> list[Term]:
        """Return the commands that are not tried again, in the order in which they were first tried."""
        return [command for command in self._failures if self.is_hopeless(command)]

    def fruitless_here(self) -> frozenset[Term]:
        """Return the commands that failed so often from here that they are not repeated from here."""
        return frozenset(done for done, count in self._in_vain.items() if count >= self._limits.same_looks)

    def failures(self) -> dict[str, int]:
        """Return how often in a row each command failed, for the trace."""
        return _written(self._failures)

    def in_vain(self) -> dict[str, int]:
        """Return how often in a row each command failed from here, for the trace."""
        return _written(self._in_vain)

    def nearest(self) -> dict[str, float]:
        """Return the highest degree of each fluent after each command, for the trace."""
        return {str(key): degree for key, degree in sorted(self._nearest.items(), key=str)}

    def recall(self, failures: Mapping[str, int], in_vain: Mapping[str, int], nearest: Mapping[str, float]) -> None:
        """Take over the counts and degrees of a trace."""
        self._failures, self._in_vain = _read(failures), _read(in_vain)
        found = ((parse_term(text), degree) for text, degree in nearest.items())
        self._nearest = {key: degree for key, degree in found if isinstance(key, Compound)}


def _objects(command: Term) -> frozenset[Term]:
    """Return the constants in a command, but for those of hands and of nothing."""
    if isinstance(command, Compound):
        return frozenset().union(*map(_objects, command.args))
    return frozenset() if command in (*HANDS, "nothing") else frozenset({command})


def _written(counts: Counter[Term]) -> dict[str, int]:
    return {str(term): count for term, count in sorted(counts.items(), key=str) if count}


def _read(counts: Mapping[str, int]) -> Counter[Term]:
    return Counter({parse_term(text): count for text, count in counts.items()})
