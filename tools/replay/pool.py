"""Many traces replayed at a time, in processes of this machine; their reports come in the order of the traces."""

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

_replayers: list[Replayer] = []  # of this process, if it is a worker


def reports(traces: Sequence[Path], wanted: Wanted, workers: int) -> Iterator[Report]:
    """Yield what came of each trace.

    Args:
        traces: Of runs.
        wanted: What to do to each; sound.
        workers: Processes that share them.

    Raises:
        InternalError: If a process dies.
    """
    try:
        told = (wanted, gc.get_threshold(), os.getpid())
        with ProcessPoolExecutor(workers, get_context("spawn"), _begin, told) as pool:
            held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # Ctrl-C is for us: workers inherit this
            try:
                found = pool.map(_report, traces)
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, held)
            yield from found
    except BrokenProcessPool as error:
        raise InternalError("a process died while it replayed; --workers 1 tells over which trace") from error


def _begin(wanted: Wanted, garbage: tuple[int, int, int], parent: int) -> None:
    """Make this process a worker, unless the one that started it has died meanwhile."""
    end_with_parent()
    if os.getppid() != parent:
        os._exit(1)
    gc.set_threshold(*garbage)
    _replayers.append(Replayer(wanted))


def _report(path: Path) -> Report:
    return _replayers[0].told(path)
