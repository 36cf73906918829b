"""The verb `info`."""

import json as json_format
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from skolem.tools.words.optimality import optimality_of_all
from skolem.tools.words.terminal import output, say
from skolem.tools.words.trace_account import Account, account
from skolem.traces import Trace
from skolem.traces.messages import CLASS_OF
from skolem.traces.wording.of_run import wording_of
from skolem.traces.wording.verdicts import displaced_text

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
def info(
    trace: Annotated[Path, typer.Argument(help="Trace of a run.")],
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output, and only that.")
    ] = False,
) -> None:
    """Print the inputs and the result of a run, and the size of each topic in its trace.

    Exit status: 0 printed, 3 the trace cannot be read.
    """
    run = Trace(trace)
    found = account(run)
    if json:
        output(json_format.dumps(_fields(run, found)))
    else:
        say(_lines(run, found), hanging=len("environment  "))


def _fields(run: Trace, found: Account) -> dict[str, object]:
    start, end, verdict = found.start, found.end, found.verdict
    return {
        "trace": str(run.path),
        "bytes": run.path.stat().st_size,
        "run": run.metadata.get("run", {}),
        "goal": None if start is None else start.goal,
        "status": None if end is None else end.status,
        "reason": None if end is None else end.reason,
        "anchor": None if end is None else end.anchor,
        "goal_probability": None if end is None else end.goal_probability,
        "true": None if verdict is None else verdict.true,
        "witness": None if verdict is None else verdict.witness,
        "displaced": None if verdict is None else {item.id: item.distance_m for item in verdict.displaced},
        "steps": found.steps,
        "simulated_s": round(found.simulated_s, 3),
        "replans": found.replans,
        "plan_causes": dict(sorted(found.causes.items())),
        "executed": dict(sorted(found.executed.items())),
        "planned": dict(sorted(found.planned.items())),
        "searches": found.searches,
        "plans": {
            "found": len(found.within),
            "optimal": found.within.count(1.0),
            "bounded": sum(factor is not None for factor in found.within),
            "within": max((factor for factor in found.within if factor is not None), default=None),
        },
        "clingo_calls": found.clingo_calls,
        "topics": {
            topic: {"class": CLASS_OF[topic], "messages": found.messages[topic], "bytes": found.bytes[topic]}
            for topic in sorted(found.messages)
        },
        "content_hash": found.hashes.content,
        "decision_hash": found.hashes.decision,
        "scenario_sha256": None if start is None else start.scenario_sha256,
        "rules_sha256": {} if start is None else start.rules_sha256,
        "robot_sha256": None if start is None else start.robot_sha256,
        "attachments": {name: len(data) for name, data in sorted(run.attachments.items())},
        "environment": run.metadata.get("env", {}),
    }


def _lines(run: Trace, found: Account) -> Iterator[str]:
    """Yield the summary of a trace as lines."""
    start, end, words = found.start, found.end, wording_of(run)
    if start is not None:
        yield f"goal         {start.goal}"
        yield f"scenario     {start.scenario}, seed {start.seed}, {start.world} world"
    yield f"status       {'the run has no end: killed or cut off' if end is None else words.end(end)}"
    if end is not None and end.anchor is not None:
        yield f"believed     {end.anchor}, p = {end.goal_probability:.3f}"
    if found.verdict is not None:
        witness = f" ({found.verdict.witness})" if found.verdict.witness else ""
        yield f"true         {'yes' if found.verdict.true else 'no'}{witness}"
        if found.verdict.displaced:
            yield f"displaced    {displaced_text(found.verdict.displaced)} (without intent)"
    yield f"steps        {found.steps}, {found.simulated_s:.1f} s simulated"
    yield f"executed     {_counts(found.executed)}"
    yield f"planned      {_counts(found.planned)}"
    yield f"replans      {found.replans}"
    yield f"plan stack   {_counts({words.cause(cause): count for cause, count in found.causes.items()})}"
    yield f"reasoning    {found.searches} searches, {found.clingo_calls} rule calls"
    yield f"plans        {optimality_of_all(found.within)}"
    yield f"content      {found.hashes.content}"
    yield f"decisions    {found.hashes.decision}"
    yield f"rules        {', '.join(sorted(run.attachments.keys() - {'scenario.yaml'})) or 'none attached'}"
    yield f"environment  {', '.join(f'{name} {value}' for name, value in _environment(run))}"
    yield ""
    yield f"{'topic':<21}  {'class':<7}  {'messages':>8}  {'bytes':>9}"
    for topic in sorted(found.messages, key=lambda topic: (-found.bytes[topic], topic)):
        yield f"{topic:<21}  {CLASS_OF[topic]:<7}  {found.messages[topic]:>8}  {found.bytes[topic]:>9}"
    total = sum(found.bytes.values())
    yield f"{'together':<21}  {'':<7}  {sum(found.messages.values()):>8}  {total:>9}"
    yield f"file, compressed, with schemas, scenario and rules: {run.path.stat().st_size} bytes"


def _counts(found: dict[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in sorted(found.items())) or "none"


def _environment(run: Trace) -> Iterator[tuple[str, str]]:
    for name, value in sorted(run.metadata.get("env", {}).items()):
        if value and name not in ("simd", "source"):
            yield name.removeprefix("version "), value
