"""The verb `diff`."""

import json as json_format
from collections.abc import Collection
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.recorded.divergences import comparison_fields, divergence_lines
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output
from skolem.traces import Trace, compare
from skolem.traces.compare.decided import DECIDED, parting
from skolem.traces.compare.diff import NOT_TIMED, Divergence, Tolerance, steps_of
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import CLASS_OF

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def diff(
    a: Annotated[Path, typer.Argument(help="Trace of a run.")],
    b: Annotated[Path, typer.Argument(help="Trace of another run.")],
    topic: Annotated[
        list[str] | None, typer.Option("--topic", help="Compare only this topic; repeatable. Default: all but PERF.")
    ] = None,
    atol: Annotated[float, typer.Option(min=0.0, help="Absolute tolerance of floats.")] = 0.0,
    rtol: Annotated[float, typer.Option(min=0.0, help="Relative tolerance of floats.")] = 0.0,
    all_: Annotated[bool, typer.Option("--all", help="Print every divergence, not only the first.")] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Print the first difference of two runs, how often each field differs, and the first different decision.

    Exit status: 0 the runs agree, 1 they differ, 2 bad input, 3 a trace cannot be read.
    """
    topics = frozenset(topic or NOT_TIMED)
    if unknown := sorted(topics - CLASS_OF.keys()):
        raise InputError([Fault("--topic", 0, 0, f"no topic {unknown[0]}; there are: {', '.join(CLASS_OF)}")])
    one, other = Trace(a), Trace(b)
    _refuse_absent(topic or [], one, other)
    tolerance = Tolerance().with_floats(atol or None, rtol or None)
    comparison = compare(one, other, tolerance, all_, topics)
    decided = topics & DECIDED.keys()
    parted = parting(steps_of(one, decided), steps_of(other, decided)) if decided and not comparison.identical else None
    attached = sorted(one.attachments.keys() | other.attachments.keys())
    changed = [name for name in attached if one.attachments.get(name) != other.attachments.get(name)]
    if json:
        fields = {"a": str(a), "b": str(b), "identical": comparison.identical, "attachments": changed}
        fields |= {"decisions_part": None if parted is None else asdict(parted)}
        output(json_format.dumps(fields | comparison_fields(comparison)))
    else:
        lines = [comparison.in_words(), *divergence_lines(comparison)]
        lines += [] if comparison.identical or not decided else [_decisions(parted)]
        lines += [f"attached files that differ: {', '.join(changed)}"] if changed else []
        output("\n".join(map(printable, lines)))
    raise typer.Exit(0 if comparison.identical else 1)


def _decisions(parted: Divergence | None) -> str:
    """Return in one line the first difference in the decisions."""
    if parted is None:
        return "the decisions are the same: plans, actions and end"
    where = f"at step {parted.step}" if parted.step >= 0 else "before the first"
    return f"the decisions part {where}, {parted.topic}{parted.changes[0]}"


def _refuse_absent(topics: Collection[str], one: Trace, other: Trace) -> None:
    """Refuse a topic that is in neither trace: the traces would agree without any comparison."""
    there = {message.topic for trace in (one, other) for message in trace.messages()} if topics else set()
    faults = [
        Fault("--topic", 0, 0, f"neither trace has messages of {topic}; there are: {', '.join(sorted(there))}")
        for topic in topics
        if topic not in there
    ]
    if faults:
        raise InputError(faults)
