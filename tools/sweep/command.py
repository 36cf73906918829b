"""The verb `sweep`."""

import json as json_format
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.faults import fault_rows
from skolem.tools.words.options import World
from skolem.tools.words.terminal import output
from skolem.traces.errors import Fault, InputError

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def sweep(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for traces and tables.")],
    scenarios: Annotated[list[Path] | None, typer.Argument(help="Scenario files.")] = None,
    family: Annotated[
        list[str] | None,
        typer.Option(help="Run the worlds that `skolem generate` draws: one for each seed; repeatable."),
    ] = None,
    bound: Annotated[
        float | None,
        typer.Option(help="Probability that the goals ask for in those worlds, instead of a drawn one."),
    ] = None,
    seeds: Annotated[str, typer.Option(metavar="A-B", help="First and last seed.")] = "0-19",
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, max=1024, help="Number of processes on this machine; each does one run at a time. Default: 2."
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="tcp://HOST:PORT", help="Use the workers of this dask scheduler instead."),
    ] = None,
    world: World = "pybullet",
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="A.B=VALUE", help="Change a value of the scenarios; repeatable."),
    ] = None,
    write: Annotated[
        Path | None,
        typer.Option(
            help="Markdown file for the section of each scenario, with its calibration, once all runs are done; "
            "other sections stay."
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object per run, and only that.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print no progress.")] = False,
) -> None:
    """Run scenarios for many seeds, several at a time, and write the results as tables.

    A run is not done again if the folder has its trace, made from the same scenario, rules, seed and program.
    Exit status: 0 every run believes its goal achieved, 1 some do not, 2 bad input, 130 interrupted.
    """
    from skolem.tools.sweep import sweeping

    try:
        if workers is not None and scheduler is not None:
            raise InputError([Fault("--scheduler", 0, 0, "give --workers or --scheduler, not both")])
        if bound is not None and not family:
            raise InputError([Fault("--bound", 0, 0, "is of worlds of a family; give --family, or change the goal")])
        plan = sweeping.plan(scenarios or [], sweeping.seed_range(seeds), world, set_ or [], family or [], bound)
        raise typer.Exit(sweeping.execute(plan, out, workers or 2, scheduler, write, json, quiet))
    except InputError as error:
        if json:
            output(json_format.dumps({"status": "bad_input", "faults": fault_rows(error)}))
        raise
