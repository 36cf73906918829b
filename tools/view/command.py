"""The verb `view`."""

import json as json_format
import sys
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.options import Raw
from skolem.tools.words.terminal import output
from skolem.traces.errors import Fault, InputError

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def view(
    trace: Annotated[Path, typer.Argument(help="Trace of a run.")],
    save: Annotated[Path | None, typer.Option(help="Write a rerun recording (.rrd) and open nothing.")] = None,
    web: Annotated[bool, typer.Option("--web", help="Serve the viewer to a browser on this machine.")] = False,
    shot: Annotated[Path | None, typer.Option(help="Write a picture (.png) of the viewer; no display needed.")] = None,
    at: Annotated[
        str | None,
        typer.Option(metavar="step=N|time=S", help="Moment of the picture of --shot. Default: the end of the run."),
    ] = None,
    follow: Annotated[
        bool, typer.Option("--follow", help="Show a run while it is recorded: TRACE is its .partial file.")
    ] = False,
    raw: Raw = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Show a run: robot, true and believed objects, camera, plans, decisions and curves, over steps or time.

    Exit status: 0 shown, 1 the picture has faults, 2 bad input or no viewer here, 3 the trace cannot be read.
    """
    if sum((save is not None, web, shot is not None, follow)) > 1:
        raise InputError([Fault("view", 0, 0, "--save, --web, --shot and --follow exclude one another")])
    if at is not None and shot is None:
        raise InputError([Fault("--at", 0, 0, "says when the picture of --shot is taken; add --shot PICTURE.png")])
    from skolem.tools.view import viewing
    from skolem.tools.view.viewer import shoot
    from skolem.traces import Trace

    if follow:
        viewing.follow_run(trace, raw)
        return
    run = Trace(trace)
    for out in filter(None, (save, shot)):
        viewing.spare_traces(out, trace)
    moment = None if at is None else viewing.moment_of(at, run)
    said: dict[str, object] = {"trace": str(trace)}
    faults: list[str] = []
    with tempfile.TemporaryDirectory(prefix="skolem-view-") as folder:
        recording = save or Path(folder, f"{trace.stem}.rrd")
        viewing.record(run, recording, raw)
        if save is not None:
            said["recording"] = str(save)
        elif shot is not None:
            faults = shoot(recording, shot, moment)
            said["picture"] = str(shot)
        elif web:
            viewing.serve(recording)
        else:
            viewing.window(recording)
    if json:
        output(json_format.dumps(said | {"faults": faults}))
    elif save or shot:
        output(f"written: {save or shot}")
    for fault in faults:
        output(fault, file=sys.stderr)
    raise typer.Exit(1 if faults else 0)
