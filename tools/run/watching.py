"""The live view of a run in a separate process, for which the run does not wait.

That process (`skolem view FILE --follow`) reads the growing trace at the lowest priority.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Final

from skolem.tools.loop.children import NO_DISPLAY, end, end_with_parent, has_display
from skolem.traces.errors import Fault, InputError
from skolem.traces.file.writer import begin, discard

NICE: Final = 10


@contextmanager
def watched(trace: Path, raw: bool = False) -> Iterator[IO[bytes]]:
    """Show the run that the block records to `trace` in a window; the block gets the partial file.

    After the block the window stays until it is closed or Ctrl-C.

    Raises:
        InputError: If there is no display, or the trace cannot be written.
    """
    if not has_display():
        raise InputError([Fault("--view", 0, 0, NO_DISPLAY)])
    file = begin(trace)  # the viewer holds it open too, so that a new name of the file does not matter
    shown = ["--raw"] if raw else []
    try:
        follower = subprocess.Popen(
            [sys.executable, "-m", "skolem", "view", f"/dev/fd/{file.fileno()}", "--follow", *shown],
            stdin=subprocess.DEVNULL,
            pass_fds=[file.fileno()],
            preexec_fn=_aside,
        )
        try:
            yield file
            with suppress(KeyboardInterrupt):
                follower.wait()
        finally:
            end(follower)
    finally:
        if not file.closed:
            discard(file, trace)


def _aside() -> None:
    """Prepare a new process: it ends with this one, and has the lowest priority."""
    end_with_parent()
    os.nice(NICE)
