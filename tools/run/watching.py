"""A run shown while it goes on, by a process of its own: the run neither waits for it nor knows of it.

That process (`skolem view FILE --follow`) reads the trace as it grows and gives way to everything else.
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
    """Show the run that the block records to `trace` in a window; the block is given the partial file to write.

    After the block the window stays until it is closed or Ctrl-C.

    Raises:
        InputError: If there is no display, or the trace cannot be written.
    """
    if not has_display():
        raise InputError([Fault("--view", 0, 0, NO_DISPLAY)])
    file = begin(trace)  # the viewer holds it open too: so it finds it under whatever name it gets
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
    """Prepare a new process: it ends with this one, and gives way to everything else."""
    end_with_parent()
    os.nice(NICE)
