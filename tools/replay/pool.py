"""Parallel replays of many traces in processes of this machine; the reports keep the order of the traces."""

import gc
import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

from skolem.tools.loop.children import end_with_parent
from skolem.tools.replay.replayer import Replayer
from skolem.tools.replay.reports import Report, Wanted
from skolem.traces.errors import InternalError

_replayers: list[Replayer] = []  # the one replayer of a worker process


def reports(traces: Sequence[Path], wanted: Wanted, workers: int) -> Iterator[Report]:
    """Yield the report of each trace.

    Args:
        traces: Traces of runs.
        wanted: The checked options.
        workers: Number of processes that share the traces.

    Raises:
        InternalError: If a process dies.
    """
    try:
        arguments = (wanted, gc.get_threshold(), os.getpid())
        with ProcessPoolExecutor(workers, get_context("spawn"), _begin, arguments) as pool:
            held = signal.pthread_sigmask(
                signal.SIG_BLOCK, {signal.SIGINT}
            )  # workers inherit it: Ctrl-C is not for them
            try:
                found = pool.map(_report, traces)
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, held)
            yield from found
    except BrokenProcessPool as error:
        raise InternalError("a process died while it replayed; --workers 1 tells over which trace") from error


def _begin(wanted: Wanted, garbage: tuple[int, int, int], parent: int) -> None:
    """Make this process a worker, unless its parent has died meanwhile."""
    end_with_parent()
    if os.getppid() != parent:
        os._exit(1)
    gc.set_threshold(*garbage)
    _replayers.append(Replayer(wanted))


def _report(path: Path) -> Report:
    return _replayers[0].report_even_of_faults(path)
