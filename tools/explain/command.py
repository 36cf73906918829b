"""The verb `explain`."""

import json as json_format
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from skolem.tools.words.options import Raw
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output, say
from skolem.traces.errors import Fault, InputError

if TYPE_CHECKING:
    from skolem.tools.explain.explaining import Explanation
    from skolem.tools.explain.text import Tree
    from skolem.traces.wording.wording import Wording

PARTED = (
    "the actions and plans below are the robot's, beliefs and reasons are what this version thinks, not what the robot "
    "thought; `skolem replay` shows where"
)

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def explain(
    trace: Annotated[Path, typer.Argument(help="Trace of a run.")],
    step: Annotated[
        int | None, typer.Option(min=0, help="The decision to explain. Default: the last one of the run.")
    ] = None,
    why_not: Annotated[
        str | None,
        typer.Option("--why-not", metavar="ANCHOR", help="Print only the reasons for and against this object."),
    ] = None,
    raw: Raw = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Explain one decision of a run: why this object, why this action, why plans were dropped, why the run ended.

    It uses the trace alone: the mind is rebuilt from the recorded observations, and the attached rules are asked again.

    Exit status: 0 explained, 2 there is no such decision or object, 3 the trace cannot be read.
    """
    from skolem.tools.explain.explaining import explained
    from skolem.tools.recorded.rules import rulebook_of
    from skolem.traces import Trace
    from skolem.traces.wording.of_run import wording_of

    found = explained(trace, step)
    run = Trace(trace)
    words = wording_of(run, rulebook_of(run.attachments).vocabulary.meanings, raw)
    if found.parts is not None and not json:
        say([f"this version thinks otherwise from step {found.parts} on: {PARTED}", ""])
    if why_not is not None:
        _print_object(found, why_not, json, words)
    elif json:
        output(json_format.dumps(asdict(found)))
    else:
        _print_all(found, words)


def _print_object(found: "Explanation", name: str, json: bool, words: "Wording") -> None:
    from skolem.tools.explain.text import choice_tree

    options = {} if found.choice is None else {option.object: option for option in found.choice.options}
    if name not in options:
        there = ", ".join(options) or "none: no plan was being followed"
        raise InputError([Fault("--why-not", 0, 0, f"no object {name} to choose; there are: {there}")])
    assert found.choice is not None
    if json:
        output(json_format.dumps(asdict(options[name])))
    else:
        _print(choice_tree(replace(found.choice, options=(options[name],)), words))


def _print_all(found: "Explanation", words: "Wording") -> None:
    from skolem.tools.explain.text import action_tree, choice_tree, drop_tree, end_tree

    action = words.operation(found.action) if found.action else "no action"
    say([f"goal: {found.goal}", f"step {found.step}: {action}"])
    trees = [] if found.choice is None else [choice_tree(found.choice, words)]
    trees += [action_tree(found.action, found.layers, words)] if found.layers else []
    trees += [drop_tree(found.drops, words)] if found.drops else []
    trees += [] if found.ending is None else [end_tree(found.ending, words)]
    for tree in trees:
        output()
        _print(tree)
    for note in found.notes:
        say(["", f"note: {words.sentence(note)}"])


def _print(tree: "Tree") -> None:
    """Print a tree: on a terminal in colours and as wide as it is, else as lines of any length."""
    from skolem.tools.explain.text import lines

    if not sys.stdout.isatty():
        output("\n".join(lines(tree)))
        return
    from rich.console import Console
    from rich.text import Text
    from rich.tree import Tree as RichTree

    def branch(of: "Tree", style: str) -> RichTree:
        found = RichTree(Text(printable(of.line), style))
        found.children = [branch(below, "") for below in of.below]
        return found

    Console(highlight=False).print(branch(tree, "bold"))
