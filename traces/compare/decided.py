"""The first step at which two runs decide differently: their plans and actions, without the numbers behind them.

Runs of two seeds differ from the first message on, and in almost every number that they sense. That says little; the
step at which the robot does something else says more.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from skolem.traces.compare.diff import Divergence, Tolerance, compare_steps, fields_of
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import canonical

DECIDED: Final = {"/action": ("op",), "/run/end": ("status", "anchor"), "/decision": ("plan",)}


def parting(one: Iterable[Sequence[Recorded]], other: Iterable[Sequence[Recorded]]) -> Divergence | None:
    """Return the first divergence between the decisions of two runs; None if they decide alike to the end.

    Each run is given step by step. Within a step the action is compared before the search that found it.
    """
    comparison = compare_steps(map(_decided, one), map(_decided, other), Tolerance())
    return next(iter(comparison.divergences), None)


def _decided(step: Sequence[Recorded]) -> list[Recorded]:
    """Return the decisions of a step: the action, or the end of the run, then the plans."""
    return sorted(_without_numbers(step), key=lambda message: list(DECIDED).index(message.topic))


def _without_numbers(step: Sequence[Recorded]) -> Iterator[Recorded]:
    for message in step:
        if message.topic in DECIDED:
            known = fields_of(message)
            words = {name: known.get(name) for name in DECIDED[message.topic]}
            yield replace(message, tick=0, data=canonical(words))
