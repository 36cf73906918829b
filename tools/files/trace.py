"""The verb `trace`."""

import json as json_format
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from skolem.tools.words.terminal import output
from skolem.traces.compare.golden import MANIFEST, Golden, read_manifest
from skolem.traces.errors import Fault, InputError

if TYPE_CHECKING:
    from skolem.tools.files.blessing import Blessed

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.callback()
def trace() -> None:
    """Record golden traces again, which is the only way to change them."""


@app.command()
def bless(
    reason: Annotated[str, typer.Option(help="Why the traces change; the manifest keeps it.")],
    names: Annotated[list[str] | None, typer.Argument(help="Golden traces.")] = None,
    all_: Annotated[bool, typer.Option("--all", help="Every trace of the manifest.")] = False,
    folder: Annotated[Path, typer.Option(help="Folder of the golden traces and their manifest.")] = Path(
        "tests/golden"
    ),
    scenario: Annotated[Path | None, typer.Option(help="Scenario file of a new trace.")] = None,
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="Seed of a new trace.")] = 0,
    world: Annotated[str, typer.Option(metavar="NAME", help="Kind of world of a new trace.")] = "pybullet",
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="A.B=VALUE", help="Change a value of a new trace's scenario; repeatable."),
    ] = None,
    why: Annotated[str, typer.Option(help="Purpose of a new trace.")] = "",
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per trace on standard output, and only that.")
    ] = False,
) -> None:
    """Run the scenarios of golden traces again, print what differs, and keep the new ones.

    A trace with the same decisions as before is not replaced. With --scenario and --why a trace is added, or gets
    another recipe.

    Exit status: 0 blessed, 2 bad input, or a trace would be too large.
    """
    from skolem.tools.files.blessing import bless as bless_one

    known = read_manifest(folder)
    of_new = {"--seed": seed, "--world": world != "pybullet", "--set": set_, "--why": why}
    faults = _contradictions(scenario, all_, [flag for flag, given in of_new.items() if given])
    if faults:
        raise InputError(faults)
    if scenario is None:
        recipes = _known_recipes(known, folder, sorted(known) if all_ else names or [])
    else:
        recipes = _new_recipe(names or [], str(scenario), seed, world, set_ or [], why)
    for name, recipe in recipes.items():
        blessed = bless_one(folder, name, recipe, reason)
        output(json_format.dumps(_fields(blessed)) if json else _text(blessed), flush=True)


def _contradictions(scenario: Path | None, all_: bool, of_new: Sequence[str]) -> list[Fault]:
    """Return a fault for each flag of a new trace that is given together with flags of existing ones."""
    if scenario is None:
        return [Fault(flag, 0, 0, "is of a new trace, or of another recipe: give --scenario too") for flag in of_new]
    return [Fault("--all", 0, 0, "is of the traces that there are: leave out --scenario")] if all_ else []


def _known_recipes(known: dict[str, Golden], folder: Path, names: Sequence[str]) -> dict[str, Golden]:
    said = f"there is no such trace in {folder / MANIFEST}; a new one needs --scenario and --why"
    faults = [Fault(name, 0, 0, said) for name in names if name not in known]
    if faults or not names:
        raise InputError(faults or [Fault("bless", 0, 0, "expected names of golden traces, or --all")])
    return {name: known[name] for name in names}


def _new_recipe(
    names: Sequence[str],
    scenario: str,
    seed: int,
    world: str,
    overrides: Sequence[str],
    why: str,
) -> dict[str, Golden]:
    if len(names) != 1 or not why:
        raise InputError([Fault("--scenario", 0, 0, "expected one name, and --why with what the trace is for")])
    if not re.fullmatch(r"\w+", names[0], re.ASCII):
        raise InputError([Fault(names[0], 0, 0, "expected a name of letters, digits and underscores")])
    return {names[0]: Golden(scenario=scenario, seed=seed, world=world, overrides=tuple(overrides), why=why)}


def _fields(blessed: "Blessed") -> dict[str, object]:
    described = {"name": blessed.name, "changed": blessed.changed, "bytes": blessed.bytes}
    return described | blessed.golden.model_dump(mode="json") | {"changes": blessed.changes}


def _text(blessed: "Blessed") -> str:
    golden = blessed.golden
    said = "new" if blessed.old is None else "changed" if blessed.changed else "unchanged"
    head = f"{blessed.name}: {said}; {golden.status}, {golden.steps} steps, {blessed.bytes} bytes"
    return "\n".join([f"{head}, decisions {golden.decision_hash[:12]}", *(f"    {line}" for line in blessed.changes)])
