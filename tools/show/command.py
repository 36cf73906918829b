"""The verb `show`."""

import json as json_format
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.options import Raw
from skolem.tools.words.plan_tree import LEGEND, tree_lines
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output, say
from skolem.traces import Trace
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import Action, Meaning, Plan, RunEnd, RunStart
from skolem.traces.wording.of_run import wording_of
from skolem.traces.wording.wording import AS_RECORDED

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def show(
    trace: Annotated[Path, typer.Argument(help="Trace of a run.")],
    step: Annotated[
        int | None,
        typer.Option(min=0, help="Show one decision: belief table, plan stack, candidates, and result."),
    ] = None,
    object_: Annotated[
        str | None, typer.Option("--object", metavar="ANCHOR", help="Show one object's beliefs over the run.")
    ] = None,
    raw: Raw = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Print the plans of a run: every plan, its refinements, the actions and the dropped plans.

    With --step it prints one decision, with --object one object over the whole run.

    Exit status: 0 shown, 2 there is no such step or object, 3 the trace cannot be read.
    """
    if step is not None and object_ is not None:
        raise InputError([Fault("--object", 0, 0, "cannot be combined with --step; leave out one of the two")])
    run = Trace(trace)
    if step is not None:
        _show_step(run, step, raw, json)
    elif object_ is not None:
        _show_object(run, object_, raw, json)
    else:
        _show_plans(run, raw, json)


def _show_plans(run: Trace, raw: bool, json: bool) -> None:
    words = AS_RECORDED if json else wording_of(run, {} if raw else _words(run), raw)
    lines = tree_lines(run.of(Plan), run.of(Action), words)
    start, end = next(iter(run.of(RunStart)), None), next(iter(run.of(RunEnd)), None)
    goal = "unknown: the record of it is lost" if start is None else start.goal
    if json:
        ended = None if end is None else end.model_dump(mode="json")
        output(json_format.dumps({"trace": str(run.path), "goal": start and start.goal, "plans": lines, "end": ended}))
        return
    last = [] if end is None else [words.end(end)]
    say([f"goal: {goal}", *([] if raw else [LEGEND]), *lines, *last])


def _show_step(run: Trace, step: int, raw: bool, json: bool) -> None:
    from skolem.tools.show.step_text import moment, moment_fields, moment_lines

    found, meanings = moment(run, step), _words(run)
    if json:
        output(json_format.dumps(moment_fields(found, meanings)))
    else:
        say(moment_lines(found, meanings, wording_of(run, meanings, raw)))


def _show_object(run: Trace, anchor: str, raw: bool, json: bool) -> None:
    from skolem.tools.show.step_text import HISTORY_COLUMNS, history
    from skolem.tools.words.belief_table import table_lines

    rows = history(run, anchor, _words(run))
    if json:
        steps = [dict(zip(HISTORY_COLUMNS, row, strict=True)) for row in rows]
        output(json_format.dumps({"trace": str(run.path), "object": anchor, "history": steps}))
    else:
        words, after = wording_of(run, raw=raw), HISTORY_COLUMNS.index("after")
        cells = [(*row[:after], words.operation(row[after]) if row[after] else "", *row[after + 1 :]) for row in rows]
        say(table_lines(HISTORY_COLUMNS, cells), hanging=8)


def _words(run: Trace) -> Mapping[str, Meaning]:
    """Return the meanings of the run's words; if this version cannot read them, colours are printed as numbers."""
    from skolem.tools.show.step_text import words_of

    try:
        return words_of(run)
    except InputError as error:
        said = "\n".join(map(printable, str(error.faults[0]).splitlines()))
        output(f"colours in numbers, as the run's own rules cannot be read: {said}", file=sys.stderr)
        return {}
