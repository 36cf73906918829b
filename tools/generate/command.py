"""The verb `generate`."""

from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.terminal import output
from skolem.traces.written import put

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def generate(
    family: Annotated[str, typer.Argument(help="Kind of world; docs/families.md describes the kinds.")],
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="Seed of the world and of its runs.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="Where to write the scenario; an existing file is replaced. Default: print it."
        ),
    ] = None,
    bound: Annotated[
        float | None,
        typer.Option(help="Probability that the goal asks for a denotation, instead of a drawn one."),
    ] = None,
) -> None:
    """Draw a random scenario of a family, with a known answer.

    The same family and seed give the same bytes. The answer stands in `expect`, which the robot never reads.
    """
    from skolem.tools.loop.families import drawn_text

    text = drawn_text(family, seed, bound)
    if out is None:
        output(text, end="")
        return
    put(out, text.encode())
