"""The verb `recover`."""

import json as json_format
import sys
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.terminal import output
from skolem.traces.file.recover import Recovered, recover as recover_trace

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def recover(
    bad: Annotated[Path, typer.Argument(help="Trace that is cut off or damaged, also NAME.mcap.partial.")],
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Where to write the whole messages; an existing file is not replaced.")
    ],
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Save every whole message of a trace that was cut off or damaged.

    The result can be read and shown, and replayed if no message is missing in between; `skolem check` says
    what is missing.

    Exit status: 0 saved, 2 the result cannot be written, or exists, 3 nothing can be saved.
    """
    found = recover_trace(bad, out)
    for damage in found.lost:
        output(f"{bad}: byte {damage.byte}: {damage.message}", file=sys.stderr)
    output(json_format.dumps(_fields(found)) if json else _text(found))


def _fields(found: Recovered) -> dict[str, object]:
    return {
        "trace": str(found.path),
        "messages": found.messages,
        "steps": found.steps,
        "simulated_s": round(found.simulated_s, 3),
        "ended": found.ended,
        "lost": [{"byte": damage.byte, "message": damage.message} for damage in found.lost],
    }


def _text(found: Recovered) -> str:
    end = "to the end of the run" if found.ended else "the run has no end"
    return (
        f"{found.path}: saved {found.messages} messages, {found.steps} steps, "
        f"up to {found.simulated_s:.2f} s simulated; {end}"
    )
