"""The verb `reproduce`."""

import json as json_format
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from skolem.tools.replay.options import All, Atol, Rtol
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output
from skolem.traces.errors import Fault, InputError
from skolem.traces.written import give_name, refuse_unwritable

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def reproduce(
    trace: Annotated[Path, typer.Argument(help="Trace of a run.")],
    keep: Annotated[Path | None, typer.Option(metavar="FILE", help="Keep the trace of the new run here.")] = None,
    atol: Atol = None,
    rtol: Rtol = None,
    all_: All = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print only the result, no progress.")] = False,
) -> None:
    """Run a recorded run again from its attached scenario, rules and seed, and compare everything but wall times.

    Exit status: 0 identical, 1 the runs differ, 2 bad input, 3 the trace cannot be read, 130 interrupted.
    """
    from skolem.tools.recorded import fingerprint
    from skolem.tools.recorded.divergences import comparison_fields, divergence_lines
    from skolem.tools.replay import reproducing
    from skolem.tools.words.live import watcher_for
    from skolem.traces import Trace
    from skolem.traces.compare.diff import tolerance_for

    if keep is not None:
        refuse_unwritable(keep)
    if keep is not None and os.path.exists(keep):
        raise InputError([Fault("--keep", 0, 0, f"{keep} exists and is not replaced; give another name")])
    old = Trace(trace)
    other = fingerprint.differences(old.metadata.get("env", {}))
    tolerance = tolerance_for("other machine" if other else "equal machine").with_floats(atol, rtol)
    setup = reproducing.setup_in(old)
    with _kept(keep) as out, watcher_for(setup, quiet or json) as watcher:
        comparison = reproducing.reproduce(old, setup, out, watcher, tolerance, all_)
        other_end = reproducing.end_of_again(old, Trace(out))
    if json:
        fields = {"trace": str(trace), "identical": comparison.identical, "other_end": other_end}
        output(json_format.dumps(fields | {"machine_differs_in": other} | comparison_fields(comparison)))
    else:
        machine = [f"recorded on another machine ({', '.join(other)}): floats compared with tolerance"] if other else []
        head = f"{trace}: {comparison.in_words()}{f'; {other_end}' if other_end else ''}"
        output("\n".join(map(printable, [head, *machine, *divergence_lines(comparison)])))
    raise typer.Exit(0 if comparison.identical else 1)


@contextmanager
def _kept(keep: Path | None) -> Iterator[Path]:
    """Give the block a path for a trace, and move the trace to `keep` if that is given.

    Until then the trace lies in a temporary folder: the remains of a killed process disturb nobody.
    """
    with TemporaryDirectory(dir=None if keep is None else keep.parent) as folder:
        out = Path(folder) / "again.mcap"
        try:
            yield out
        finally:
            if keep is not None and out.exists():
                give_name(out, keep)
