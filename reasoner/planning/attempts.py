"""Counts of failed attempts: of each command in a row, and of each command from where the robot stands."""

from collections import Counter
from collections.abc import Mapping

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.terms import Compound, Term, parse_term
from skolem.traces.messages import Limits


class Attempts:
    """Failures by command; a success resets both counts, a drive resets those from where the robot stood."""

    def __init__(self, limits: Limits) -> None:
        """Begin without failures."""
        self._limits = limits
        self._failures: Counter[Term] = Counter()
        self._in_vain: Counter[Term] = Counter()

    def judge(self, done: Instance, achieved: bool) -> None:
        """Note whether an executed step achieved its results."""
        if done.executes is None:
            return
        self._failures[done.executes] = 0 if achieved else self._failures[done.executes] + 1
        if isinstance(done.executes, Compound) and done.executes.name == "move":
            self._in_vain.clear()
        else:
            self._in_vain[done.executes] = 0 if achieved else self._in_vain[done.executes] + 1

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

    def recall(self, failures: Mapping[str, int], in_vain: Mapping[str, int]) -> None:
        """Take over the counts of a trace."""
        self._failures, self._in_vain = _read(failures), _read(in_vain)


def _written(counts: Counter[Term]) -> dict[str, int]:
    return {str(term): count for term, count in sorted(counts.items(), key=str) if count}


def _read(counts: Mapping[str, int]) -> Counter[Term]:
    return Counter({parse_term(text): count for text, count in counts.items()})
