"""The wording that fits a recorded run: its goal and its types are asked of the trace, colour words of its rules."""

from collections.abc import Mapping

from skolem.traces.file.reader import Trace
from skolem.traces.messages import HsvVolume, Meaning, Prior, RunStart
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import AS_RECORDED, InWords, Wording


def wording_of(trace: Trace, raw: bool = False, meanings: Mapping[str, Meaning] | None = None) -> Wording:
    """Return how to put a run into words.

    Args:
        trace: The run.
        raw: Whether terms are to be shown as they are recorded.
        meanings: What the words of its rules mean, if that is known; without them colours are given in numbers.
    """
    if raw:
        return AS_RECORDED
    start, prior = next(iter(trace.of(RunStart)), None), next(iter(trace.of(Prior)), None)
    colours = {word: meaning for word, meaning in (meanings or {}).items() if isinstance(meaning, HsvVolume)}
    return InWords(Things("" if start is None else start.goal, frozenset(prior.types if prior else ()), colours))
