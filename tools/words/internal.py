"""Errors of the product itself, as text: what was raised, which trace shows it, and how to report it."""

import os
import traceback
from pathlib import Path
from typing import Final

DEBUG: Final = "SKOLEM_DEBUG"  # environment variable; 1 shows where an error was raised


def internal_lines(error: BaseException, trace: Path | None) -> list[str]:
    """Return the traceback if it is asked for, and how to report the error.

    Args:
        error: An exception that the product did not expect.
        trace: The trace of the run that it ended; None if there is none.
    """
    wanted = os.environ.get(DEBUG, "0") not in ("", "0")
    shown = "".join(traceback.format_exception(error)).splitlines() if wanted else []
    what = "the command" if trace is None else f"{trace} (it holds the scenario, the rules and the seed)"
    more = "" if wanted else f"; {DEBUG}=1 shows where it was raised"
    return [*shown, f"this is a fault of skolem: to report it, send the version and {what}{more}"]
