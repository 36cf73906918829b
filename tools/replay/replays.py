"""Replays from the command line: a report for each trace, in order, and one exit status."""

import json as json_format
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from skolem.tools.replay.replayer import Replayer
from skolem.tools.replay.reports import EXIT, Report, Status, Wanted
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output
from skolem.traces.errors import Fault, InputError

PAYS = 8  # fewest traces for one more process: its start takes as long as a few replays


def execute(traces: Sequence[Path], wanted: Wanted, workers: int | None, json: bool) -> int:
    """Replay each trace, print its report, and return the exit status of the worst.

    Args:
        traces: Traces of runs.
        wanted: The options.
        workers: Number of processes that share the traces; None: as many as save time.
        json: Whether to print one JSON object per trace instead of lines for people.

    Raises:
        InputError: If the options contradict one another, or their files or values are wrong.
        TraceError: If the only trace cannot be read.
    """
    _check(wanted)
    found: Counter[Status] = Counter()
    for path, report in zip(traces, _reports(traces, wanted, workers), strict=True):
        found[report.status] += 1
        if json:
            output(json_format.dumps({"trace": str(path), "status": report.status, **report.fields}), flush=True)
        else:
            first, *others = map(printable, report.lines)
            output("\n".join([f"{path}: {first}", *(f"  {line}" for line in others)]), flush=True)
    if len(traces) > 1 and not json:
        counts = ", ".join(f"{count} {status.replace('_', ' ')}" for status, count in sorted(found.items()))
        output(f"{len(traces)} traces: {counts}")
    return max(EXIT[status] for status in found)


def _reports(traces: Sequence[Path], wanted: Wanted, workers: int | None) -> Iterator[Report]:
    """Yield the report of each trace; of many traces also for those with an error."""
    replayer = Replayer(wanted)
    count = workers or min(len(os.sched_getaffinity(0)), len(traces) // PAYS)
    if len(traces) == 1:
        yield replayer.report(traces[0])
    elif count <= 1:
        yield from map(replayer.report_even_of_faults, traces)
    else:
        from skolem.tools.replay import pool  # loads multiprocessing, which one trace does not need

        yield from pool.reports(traces, wanted, count)


def _check(wanted: Wanted) -> None:
    """Refuse options that contradict one another."""
    faults = []
    if wanted.is_what_if:
        given = {
            "--from-step": wanted.from_step,
            "--re-anchor": wanted.re_anchor,
            "--plan-motions": wanted.plan_motions,
            "--atol": wanted.atol is not None,
            "--rtol": wanted.rtol is not None,
        }
        message = "does not go with --rules or --set, which ask what would be, not whether all is as it was"
        faults = [Fault(name, 0, 0, message) for name, there in given.items() if there]
    if faults:
        raise InputError(faults)
