"""The wording that fits a run: what is known of its goal, its types of things and the colour words of its rules."""

from collections.abc import Iterable, Mapping

from skolem.traces.file.reader import Trace
from skolem.traces.messages import HsvVolume, Meaning, Prior, RunStart
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import AS_RECORDED, InWords, Wording


def wording(goal: str, types: Iterable[str], meanings: Mapping[str, Meaning], raw: bool = False) -> Wording:
    """Return how to put a run into words.

    Args:
        goal: As the run states it.
        types: The words that name a type of things.
        meanings: What the words of its rules mean, if that is known; without them colours are given in numbers.
        raw: Whether terms are to be shown as they are recorded.
    """
    colours = {word: meaning for word, meaning in meanings.items() if isinstance(meaning, HsvVolume)}
    return AS_RECORDED if raw else InWords(Things(goal, frozenset(types), colours))


def wording_of(trace: Trace, meanings: Mapping[str, Meaning] | None = None, raw: bool = False) -> Wording:
    """Return how to put a recorded run into words; arguments as of `wording`."""
    start, prior = next(iter(trace.of(RunStart)), None), next(iter(trace.of(Prior)), None)
    return wording("" if start is None else start.goal, prior.types if prior else (), meanings or {}, raw)
