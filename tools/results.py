"""The verb `results`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.run import WorldChoice

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def results(
    scenario: Annotated[Path, typer.Argument(help="Scenario file.")],
    seeds: Annotated[str, typer.Option(metavar="A-B", help="First and last seed.")] = "0-19",
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="Markdown file to write the table into, instead of printing it; tables of other scenarios in it stay.",
        ),
    ] = None,
    world: Annotated[
        WorldChoice, typer.Option(help="Physics and rendering, or the same actions and noise without them.")
    ] = WorldChoice.pybullet,
    traces: Annotated[Path, typer.Option(help="Folder for the traces; they are replaced.")] = Path("out/results"),
    jobs: Annotated[int, typer.Option(min=1, help="Processes at a time, at most one per processor.")] = 1,
) -> None:
    """Run a scenario for many seeds and write a table of how it went.

    Exit status: 0 if every run believes its goal achieved, else 1.
    """
    from skolem.tools import seeds as many
    from skolem.tools import session

    wanted = many.seed_range(seeds)
    name = session.prepare(scenario).scenario.name
    tasks = [many.Task(scenario, seed, world.value, traces / f"{name}-{world.value}-{seed}.mcap") for seed in wanted]
    rows = list(many.run_all(tasks, min(jobs, os.cpu_count() or 1)))
    table = many.report(name, world.value, rows)
    if out is None:
        print(table)
    else:
        out.parent.mkdir(parents=True, exist_ok=True)
        before = out.read_text(encoding="utf-8") if out.exists() else "# Results\n"
        out.write_text(many.with_section(before, f"{name} {world.value}", table), encoding="utf-8")
    raise typer.Exit(0 if all(row["believed"] for row in rows) else 1)
