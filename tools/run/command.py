"""The verb `run`."""

import json as json_format
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.loop.stopwatch import Stopwatch
from skolem.tools.words.faults import fault_rows
from skolem.tools.words.options import Raw, World
from skolem.tools.words.terminal import output
from skolem.traces.errors import InputError

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def run(
    scenario: Annotated[Path, typer.Argument(help="Scenario file.")],
    seed: Annotated[
        int | None, typer.Option(min=0, max=2**63 - 1, help="Seed of the run. Default: the scenario's.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="Where to write the trace; an existing file is replaced. Default: out/NAME-SEED.mcap below the "
            "current folder, with a number added if that exists.",
        ),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
    images: Annotated[bool, typer.Option("--images", help="Record the camera's images too.")] = False,
    world: World = "pybullet",
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="A.B=VALUE", help="Change a value of the scenario; repeatable.")
    ] = None,
    max_steps: Annotated[
        int | None, typer.Option(min=1, help="Most actions of the run. Default: the scenario's limits.steps.")
    ] = None,
    optimal: Annotated[
        bool, typer.Option("--optimal", help="Use only the likeliest plans (limits.optimal); takes longer.")
    ] = False,
    profile: Annotated[
        bool, typer.Option("--profile", help="Record wall times too; they differ from run to run.")
    ] = False,
    view: Annotated[bool, typer.Option("--view", help="Show the run in a window while it goes on.")] = False,
    raw: Raw = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print only the verdict, no progress.")] = False,
) -> None:
    """Run a scenario and record it as a trace.

    Exit status: 0 the robot believes its goal achieved, 1 it does not, 2 bad input, 3 the trace
    cannot be written to its end, 4 internal error, 130 interrupted.
    """
    watch = Stopwatch()
    with watch.part("loading"):
        from skolem.reasoner.planning.relations import start_text
        from skolem.tools.loop.setup import prepare
        from skolem.tools.loop.stopwatch import LOADING
        from skolem.tools.run import running
        from skolem.tools.run.watching import watched
    try:
        overrides = [*(set_ or []), *([] if max_steps is None else [f"limits.steps={max_steps}"])]
        overrides += ["limits.optimal=true"] if optimal else []
        with watch.part(LOADING):
            setup = prepare(scenario, overrides, seed, world, images, profile)
        for warning in setup.rulebook.warnings:
            output(warning, file=sys.stderr)
        if not quiet and (said := start_text(setup.goal)):
            output(said, file=sys.stderr)
        trace = out or running.unused(Path("out") / f"{setup.scenario.name}-{setup.seed}.mcap")
        with watched(trace, raw) if view else nullcontext() as partial:
            status = running.execute(setup, trace, watch, json, quiet, partial, raw)
        raise typer.Exit(status)
    except InputError as error:
        if json:
            output(
                json_format.dumps({"status": "bad_input", "reason": str(error.faults[0]), "faults": fault_rows(error)})
            )
        raise
