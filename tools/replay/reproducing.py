"""Reproduction of a recorded run: the simulator runs again with the scenario, rules and seed in its trace."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from skolem.sim.scenario.scenario import read_document
from skolem.tools.loop import worlds
from skolem.tools.loop.session import Watcher, run
from skolem.tools.loop.setup import Setup, understood
from skolem.tools.recorded.replaying import other_end
from skolem.tools.recorded.rules import rulebook_of
from skolem.tools.recorded.run import CUT_SHORT, check_made_of
from skolem.traces import Trace
from skolem.traces.compare.diff import NOT_TIMED, Comparison, Tolerance, by_step
from skolem.traces.errors import BrokenRulesError, InputError, TraceError
from skolem.traces.file.made_of import SCENARIO
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import RunEnd, RunStart


def setup_in(trace: Trace) -> Setup:
    """Return the inputs of a recorded run.

    Raises:
        InputError: If scenario, rules or goal are not sound for this version of the product, or the world of the run
            is not installed.
        TraceError: If the trace lacks its scenario, its rules or the metadata of its run.
    """
    start = next(trace.of(RunStart), None)
    if start is None or SCENARIO not in trace.attachments:
        raise TraceError(f"{trace.path}: nothing to run: no /run/start, or no {SCENARIO} attached")
    check_made_of(trace, start)
    document = read_document(SCENARIO, trace.attachments[SCENARIO].decode(errors="replace"))
    rulebook = rulebook_of(trace.attachments)
    scenario, goal = understood(document, rulebook)
    world = worlds.named(start.world, str(trace.path))
    images = next(trace.messages("/camera/rgb"), None) is not None
    return Setup(document, scenario, rulebook, goal, start.seed, world, images, profile=False)


def reproduce(
    trace: Trace, setup: Setup, out: Path, watcher: Watcher, tolerance: Tolerance, keep_all: bool = False
) -> Comparison:
    """Run again, and compare the new trace at `out` with the old one.

    A run that failed or was cut short is compared as far as its record goes; a failed run may fail again.
    """
    end = next(trace.of(RunEnd), None)
    try:
        run(setup, out, watcher)
    except Exception as error:
        limit = isinstance(error, InputError) and not isinstance(error, BrokenRulesError)
        if limit or end is None or end.status != "error":
            raise
    comparison = Comparison(tolerance, keep_all)
    cut_short = end is None or end.status in CUT_SHORT
    for number, (expected, got) in enumerate(_pairs(trace, Trace(out), cut_short)):
        comparison.add(number - 1, expected, got)
    return comparison


def end_of_again(old: Trace, new: Trace) -> str:
    """Return a sentence if the old run ended in an error and the new one did not; empty otherwise."""
    then, now = (next(trace.of(RunEnd), None) for trace in (old, new))
    return other_end(then, now.reason if now is not None and now.status == "error" else "")


def _pairs(old: Trace, new: Trace, cut_short: bool) -> Iterator[tuple[Sequence[Recorded], Sequence[Recorded]]]:
    """Yield the messages of both runs step by step; after a record that was cut short the new ones are left out."""
    ours, theirs = by_step(old.messages(*NOT_TIMED)), by_step(new.messages(*NOT_TIMED))
    group = next(ours)
    while True:
        following = next(ours, None)
        if following is None and cut_short:
            group = [message for message in group if message.topic != "/run/end"]
            yield group, next(theirs, [])[: len(group)]
            return
        yield group, next(theirs, [])
        if following is None:
            break
        group = following
    yield from (([], more) for more in theirs)
