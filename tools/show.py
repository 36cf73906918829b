"""The verb `show`."""

import json as json_format
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.plan_tree import tree_lines
from skolem.traces.messages import Action, Plan, RunEnd, RunStart
from skolem.traces.reader import Trace

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def show(
    trace: Annotated[Path, typer.Argument(help="Trace of a run.")],
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Print how a run was planned: every plan, what refined it, what was done and what was dropped.

    Exit status: 0 shown, 3 the trace cannot be read.
    """
    run = Trace(trace)
    lines = tree_lines(run.of(Plan), run.of(Action))
    start, end = next(iter(run.of(RunStart))), next(iter(run.of(RunEnd)), None)
    if json:
        ended = None if end is None else end.model_dump(mode="json")
        print(json_format.dumps({"trace": str(trace), "goal": start.goal, "plans": lines, "end": ended}))
        return
    print(f"goal: {start.goal}")
    print("\n".join(lines))
    if end is not None:
        print(f"{end.status}: {end.reason}")
