"""The verb `check`."""

import json as json_format
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output
from skolem.traces import check as check_trace
from skolem.traces.file.check import Checked

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def check(
    traces: Annotated[list[Path], typer.Argument(help="Traces of runs.")],
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per trace on standard output, and only that.")
    ] = False,
) -> None:
    """Check that traces are whole and unchanged; name the first fault of each, with its position and a remedy.

    What an older version recorded is sound as long as this one reads it; a remark says so. The hashes cover everything
    recorded but wall times; the machine and the versions of the libraries (`env`) are covered by the checksums alone.

    Exit status: 0 all are sound, 3 one is not.
    """
    sound = True
    for path in traces:
        found = check_trace(path)
        sound &= found.sound
        text = json_format.dumps(_fields(found)) if json else "\n".join(map(printable, _text(found).splitlines()))
        output(text)
    raise typer.Exit(0 if sound else 3)


def _fields(found: Checked) -> dict[str, object]:
    return {
        "trace": str(found.path),
        "sound": found.sound,
        "messages": found.messages,
        "steps": found.steps,
        "content_hash": found.content_hash if found.sound else None,
        "decision_hash": found.decision_hash if found.sound else None,
        "fault": None if found.flaw is None else asdict(found.flaw),
        "remarks": found.remarks,
    }


def _text(found: Checked) -> str:
    if found.flaw is not None:
        return f"{found.path}: not sound: {found.flaw}"
    hashes = f"content {found.content_hash[:12]}, decisions {found.decision_hash[:12]}"
    head = f"{found.path}: sound; {found.messages} messages, {found.steps} steps, {hashes}"
    return "\n".join([head, *(f"    {remark}" for remark in found.remarks)])
