"""The verb `diff`."""

import json as json_format
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.divergences import comparison_fields, divergence_lines
from skolem.traces.diff import Tolerance, by_step, compare
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import CLASS_OF, PERF
from skolem.traces.reader import Recorded, Trace

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def diff(
    a: Annotated[Path, typer.Argument(help="Trace of a run.")],
    b: Annotated[Path, typer.Argument(help="Trace of another.")],
    topic: Annotated[
        list[str] | None, typer.Option("--topic", help="Compare only this topic; repeatable. Default: all but PERF.")
    ] = None,
    atol: Annotated[float, typer.Option(min=0.0, help="Absolute tolerance of floats.")] = 0.0,
    rtol: Annotated[float, typer.Option(min=0.0, help="Relative tolerance of floats.")] = 0.0,
    all_: Annotated[bool, typer.Option("--all", help="Print every divergence, not the first alone.")] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Print where two runs part first, and how often each field differs.

    Exit status: 0 they agree, 1 they do not, 2 bad input, 3 a trace cannot be read.
    """
    topics = frozenset(topic or (name for name, kind in CLASS_OF.items() if kind != PERF))
    if unknown := sorted(topics - CLASS_OF.keys()):
        raise InputError([Fault("--topic", 0, 0, f"no topic {unknown[0]}; there are: {', '.join(CLASS_OF)}")])
    one, other = Trace(a), Trace(b)
    tolerance = Tolerance().with_floats(atol or None, rtol or None)
    comparison = compare(_steps(one, topics), _steps(other, topics), tolerance, all_)
    attached = sorted(one.attachments.keys() | other.attachments.keys())
    changed = [name for name in attached if one.attachments.get(name) != other.attachments.get(name)]
    if json:
        print(json_format.dumps({"a": str(a), "b": str(b), "attachments": changed, **comparison_fields(comparison)}))
    else:
        messages = comparison.compared.total()
        word = "IDENTICAL" if comparison.identical else f"{comparison.differing.total()} differ"
        print("\n".join([f"{messages} messages: {word}", *divergence_lines(comparison)]))
        if changed:
            print(f"attached files that differ: {', '.join(changed)}")
    raise typer.Exit(0 if comparison.identical else 1)


def _steps(trace: Trace, topics: frozenset[str]) -> Iterator[list[Recorded]]:
    """Yield the messages of `topics`, step by step."""
    for group in by_step(trace.messages(*topics, "/belief")):
        yield [message for message in group if message.topic in topics]
