"""The verb `run`."""

import json as json_format
import traceback
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools import session
from skolem.tools.live import watcher_for
from skolem.tools.stopwatch import Stopwatch
from skolem.traces.errors import Fault, InputError, SkolemError
from skolem.traces.messages import TICKS_PER_SECOND, RunStatus

EXIT: dict[RunStatus, int] = {
    "goal_achieved": 0,
    "goal_unachievable": 1,
    "limit_reached": 1,
    "error": 4,
    "interrupted": 130,
}
app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


class WorldChoice(StrEnum):
    """Which simulator to run in."""

    pybullet = "pybullet"
    symbolic = "symbolic"


@app.command()
def run(
    scenario: Annotated[Path, typer.Argument(help="Scenario file.")],
    seed: Annotated[int | None, typer.Option(min=0, help="Instead of the scenario's seed.")] = None,
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
    world: Annotated[
        WorldChoice, typer.Option(help="Physics and rendering, or the same actions and noise without them.")
    ] = WorldChoice.pybullet,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="A.B=VALUE", help="Change a value of the scenario; repeatable.")
    ] = None,
    max_steps: Annotated[int | None, typer.Option(min=1, help="Instead of the scenario's limits.steps.")] = None,
    profile: Annotated[
        bool, typer.Option("--profile", help="Record wall times too; they differ from run to run.")
    ] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="No progress, only the verdict.")] = False,
) -> None:
    """Run a scenario and record it as a trace.

    Exit status: 0 the robot believes its goal achieved, 1 it does not, 2 bad input, 4 internal error, 130 interrupted.
    """
    watch = Stopwatch()
    try:
        overrides = [*(set_ or []), *([] if max_steps is None else [f"limits.steps={max_steps}"])]
        if images and world is WorldChoice.symbolic:
            raise InputError([Fault("--images", 0, 0, "the symbolic world has no camera; leave out one of the two")])
        with watch.part(session.LOADING):
            setup = session.prepare(scenario, overrides, seed, world.value, images, profile)
        trace = out or unused(Path("out") / f"{setup.scenario.name}-{setup.seed}.mcap")
        raise typer.Exit(execute(setup, trace, watch, json, quiet))
    except InputError as error:
        if json:
            print(
                json_format.dumps({"status": "bad_input", "reason": str(error.faults[0]), "faults": fault_rows(error)})
            )
        raise


def execute(setup: session.Setup, trace: Path, watch: Stopwatch, json: bool, quiet: bool) -> int:
    """Run, print what came of it, and return the exit status."""
    outcome = session.Outcome()
    status: RunStatus = "error"
    reason = ""
    with watcher_for(setup, quiet) as watcher:
        try:
            session.run(setup, trace, watcher, watch, outcome)
            assert outcome.end is not None, "a run that raises nothing has an end"
            status, reason = outcome.end.status, outcome.end.reason
        except KeyboardInterrupt:
            status, reason = "interrupted", "interrupted"
        except InputError:
            raise
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
            if not isinstance(error, SkolemError):
                traceback.print_exception(error)
    summary = session.summary(setup, outcome, status, reason, trace)
    if json:
        print(json_format.dumps(summary))
    else:
        print(verdict_text(setup, outcome, status, reason, trace))
    return EXIT[status]


def verdict_text(setup: session.Setup, outcome: session.Outcome, status: RunStatus, reason: str, trace: Path) -> str:
    """Return what the robot believes, what is true, and where the trace lies."""
    counts = (
        f"{outcome.actions} actions, {outcome.replans} replans, "
        f"{outcome.tick / TICKS_PER_SECOND:.1f} s simulated, {outcome.total_s:.1f} s wall"
    )
    lines = []
    if outcome.end is None:
        lines.append(f"{'interrupted' if status == 'interrupted' else f'internal error: {reason}'}; {counts}")
    else:
        about = f"{outcome.end.anchor or 'no object'}, p = {outcome.end.goal_probability:.3f}"
        said = "goal believed achieved" if status == "goal_achieved" else f"goal not achieved: {reason}"
        best = about if status == "goal_achieved" else f"best candidate {about}"
        lines.append(f"{said}; {best}; {counts}")
    if outcome.verdict is not None:
        witness = f" ({outcome.verdict.witness})" if outcome.verdict.witness else ""
        lines.append(f"true in the simulator: {'yes' + witness if outcome.verdict.true else 'no'}")
    lines.append(f"trace: {trace} (content {outcome.content_hash[:12]})")
    return "\n".join(lines)


def unused(path: Path) -> Path:
    """Return the path, or the first of NAME.2.mcap, NAME.3.mcap, .. that does not exist."""
    number, free = 2, path
    while free.exists():
        free = path.with_name(f"{path.stem}.{number}{path.suffix}")
        number += 1
    return free


def fault_rows(error: InputError) -> list[dict[str, object]]:
    """Return faults as the fields of `--json`."""
    return [
        {"file": f.file, "line": f.line, "column": f.column, "at": f.at, "message": f.message} for f in error.faults
    ]
