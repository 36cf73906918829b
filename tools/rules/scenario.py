"""The verb `scenario`: check files, print the schema."""

import json as json_format
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.faults import fault_rows
from skolem.tools.words.terminal import output
from skolem.traces.errors import InputError

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    help="Check scenario files, or print their JSON Schema.",
)


@app.command()
def check(
    files: Annotated[list[Path], typer.Argument(help="Scenario files.")],
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object per mistake.")] = False,
) -> None:
    """Report every mistake in scenario files with its place; exit status 2 if there is one."""
    from skolem.tools.loop.setup import prepare

    sound = True
    for file in files:
        try:
            prepare(file)
        except InputError as error:
            sound = False
            output("\n".join(map(json_format.dumps, fault_rows(error))) if json else error)
        else:
            if not json:
                output(f"{file}: sound")
    raise typer.Exit(0 if sound else 2)


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenario files, for editors."""
    from skolem.sim.scenario.scenario import schema_text

    output(schema_text(), end="")
