"""The wording for a run, made from its goal, its object types and the colour words of its rules."""

from collections.abc import Iterable, Mapping

from skolem.traces.file.reader import Trace
from skolem.traces.messages import ColourMeaning, Meaning, Prior, RunStart
from skolem.traces.wording.things import Things
from skolem.traces.wording.wording import AS_RECORDED, InWords, Wording


def wording(goal: str, types: Iterable[str], meanings: Mapping[str, Meaning], raw: bool = False) -> Wording:
    """Return the wording for a run.

    Args:
        goal: The text of the goal.
        types: The names of the object types.
        meanings: Meanings of the words of its rules; without them colours are given in numbers.
        raw: Whether terms are shown as recorded.
    """
    colours = {word: meaning for word, meaning in meanings.items() if isinstance(meaning, ColourMeaning)}
    return AS_RECORDED if raw else InWords(Things(goal, frozenset(types), colours))


def wording_of(trace: Trace, meanings: Mapping[str, Meaning] | None = None, raw: bool = False) -> Wording:
    """Return the wording for a recorded run; arguments as for `wording`."""
    start, prior = next(iter(trace.of(RunStart)), None), next(iter(trace.of(Prior)), None)
    return wording("" if start is None else start.goal, prior.types if prior else (), meanings or {}, raw)
