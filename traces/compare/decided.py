"""Where two runs decide otherwise: what was searched out and done, without the numbers that it was decided by.

Two seeds differ from the first message on, and what they sense in almost every number. That says little; at which step
the robot does something else says more.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from skolem.traces.compare.diff import Divergence, Tolerance, compare_steps, fields_of
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import canonical

DECIDED: Final = {"/action": ("op",), "/run/end": ("status", "anchor"), "/decision": ("plan",)}


def parting(one: Iterable[Sequence[Recorded]], other: Iterable[Sequence[Recorded]]) -> Divergence | None:
    """Return where the decisions of two runs part, each given step by step; None if they never do.

    Within a step what is done counts before how it was found.
    """
    comparison = compare_steps(map(_decided, one), map(_decided, other), Tolerance())
    return next(iter(comparison.divergences), None)


def _decided(step: Sequence[Recorded]) -> list[Recorded]:
    """Return what was decided in a step: the act, or the end, then the plans."""
    return sorted(_without_numbers(step), key=lambda message: list(DECIDED).index(message.topic))


def _without_numbers(step: Sequence[Recorded]) -> Iterator[Recorded]:
    for message in step:
        if message.topic in DECIDED:
            known = fields_of(message)
            words = {name: known.get(name) for name in DECIDED[message.topic]}
            yield replace(message, tick=0, data=canonical(words))
