"""Child processes, none of which outlives the process that starts it."""

import ctypes
import os
import signal
import subprocess
from typing import Any, Final

END_S: Final = 5.0
NO_DISPLAY: Final = "there is no display for a window; record the run and use `skolem view` with --web or --shot"
_PR_SET_PDEATHSIG: Final = 1


def end_with_parent() -> None:
    """Let the kernel end this process when its parent ends for any reason (Linux); for `preexec_fn`."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def end(process: "subprocess.Popen[Any]", seconds: float = END_S) -> None:
    """Ask a process to end, and kill it if it has not ended after `seconds`."""
    process.terminate()
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def has_display() -> bool:
    """Return whether windows can be opened."""
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"))
