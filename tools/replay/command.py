"""The verb `replay`."""

from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.replay.options import All, Atol, Rtol

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def replay(
    traces: Annotated[list[Path], typer.Argument(help="Traces of runs.")],
    from_step: Annotated[
        int, typer.Option(min=0, help="First decision to take again, with the memory recorded there.")
    ] = 0,
    re_anchor: Annotated[
        bool,
        typer.Option(
            "--re-anchor", help="Use the recorded memory at every decision: lists each that diverges by itself."
        ),
    ] = False,
    plan_motions: Annotated[
        bool,
        typer.Option("--plan-motions", help="Ask the planner every geometric question, not the trace."),
    ] = False,
    rules: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="What if: rule files that replace those of the same name in the trace, or are added."
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="A.B=VALUE",
            help="What if: another goal=, threshold= (the p of every B in the goal), limits.*, belief.*, priors.*, "
            "model.* or noise.*; repeatable.",
        ),
    ] = None,
    atol: Atol = None,
    rtol: Rtol = None,
    all_: All = False,
    workers: Annotated[
        int | None,
        typer.Option(min=1, max=1024, help="Number of processes that share the traces. Default: as many as save time."),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per trace on standard output, and only that.")
    ] = False,
) -> None:
    """Take the decisions of recorded runs again, without a simulator, and compare; or try other rules or goals.

    Exit status: 0 identical, or no decision changes; 1 a run diverges, or a decision changes; 2 bad input; 3 a trace
    cannot be read; 4 internal error.
    """
    from skolem.tools.replay.replays import execute
    from skolem.tools.replay.reports import Wanted

    wanted = Wanted(
        from_step=from_step,
        re_anchor=re_anchor,
        plan_motions=plan_motions,
        atol=atol,
        rtol=rtol,
        keep_all=all_,
        rules=rules,
        overrides=tuple(set_ or ()),
    )
    raise typer.Exit(execute(traces, wanted, workers, json))
