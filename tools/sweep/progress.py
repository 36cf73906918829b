"""The progress of a sweep: a bar on a terminal, otherwise a line for each finished run."""

import sys
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from skolem.tools.sweep.rows import Row
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output


class Quiet(AbstractContextManager["Quiet"]):
    """Prints nothing."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Do nothing."""

    def done(self, row: Row) -> None:
        """Print nothing."""


class Lines(Quiet):
    """Prints one line on standard error for each finished run."""

    def __init__(self, total: int, before: int) -> None:
        """Print how many runs are done already."""
        self._total, self._done = total, before
        if before:
            output(f"{before} of {total} runs are done already", file=sys.stderr, flush=True)

    def done(self, row: Row) -> None:
        """Print the end of the run."""
        self._done += 1
        output(f"[{self._done}/{self._total}] {said_of(row)}", file=sys.stderr, flush=True)


class Bar(Quiet):
    """Shows a bar with the counts so far, and the failures above it."""

    def __init__(self, total: int, before: int, console: Console) -> None:
        """Prepare the bar."""
        self._believed = self._true = 0
        self._bar = Progress(
            TextColumn("runs"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.description}"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=console,
        )
        self._task = self._bar.add_task("starting workers", total=total, completed=before)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._bar.stop()

    def done(self, row: Row) -> None:
        """Move the bar on, and print a failure."""
        self._believed += row.believed
        self._true += row.succeeded
        if not row.succeeded:
            self._bar.console.print(printable(said_of(row)), highlight=False, markup=False)
        self._bar.update(self._task, advance=1, description=f"{self._believed} believed, {self._true} of them true")


def said_of(row: Row) -> str:
    """Return the end of a run in one line."""
    true = {True: "true", False: "not true", None: "cut short"}[row.true]
    why = "" if row.believed else f": {' '.join(row.reason.split())}"
    effort = f"{row.actions} action{'' if row.actions == 1 else 's'}, {row.seconds['total']:.1f} s"
    return f"{row.scenario} seed {row.seed}: {row.status}, {true}, {effort}{why}"


def progress_for(total: int, before: int, quiet: bool) -> Quiet:
    """Return the display of the progress: none, a bar on a terminal, or lines."""
    if quiet:
        return Quiet()
    console = Console(stderr=True)
    return Bar(total, before, console) if console.is_terminal else Lines(total, before)
