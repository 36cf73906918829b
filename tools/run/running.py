"""A run from the command line: progress, times, summary and exit status."""

import json as json_format
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import IO

from skolem.tools.loop.session import Outcome, run
from skolem.tools.loop.setup import Setup
from skolem.tools.loop.stopwatch import PARTS, Stopwatch
from skolem.tools.words.internal import internal_lines
from skolem.tools.words.live import watcher_for, wording_for
from skolem.tools.words.terminal import output, say
from skolem.traces.errors import InputError, UnwrittenError
from skolem.traces.file.writer import partial_of
from skolem.traces.messages import TICKS_PER_SECOND, RunEnd, RunStatus
from skolem.traces.wording.verdicts import displaced_text
from skolem.traces.wording.wording import Wording

EXIT: dict[RunStatus, int] = {
    "goal_achieved": 0,
    "goal_unachievable": 1,
    "no_referent": 1,
    "no_unique_referent": 1,
    "limit_reached": 1,
    "error": 4,
    "interrupted": 130,
}


def execute(
    setup: Setup,
    trace: Path,
    watch: Stopwatch,
    json: bool,
    quiet: bool,
    partial: IO[bytes] | None = None,
    raw: bool = False,
) -> int:
    """Run, print the result, and return the exit status; `partial` as in `run`, and `raw` shows terms as recorded.

    Raises:
        InputError: If the trace cannot be begun.
        UnwrittenError: If the trace cannot be written to its end; with `json` the object is printed before.
    """
    outcome = Outcome()
    status: RunStatus = "error"
    reason, unwritten, fault = "", None, None
    with watcher_for(setup, quiet, raw) as watcher:
        try:
            run(setup, trace, watcher, watch, outcome, partial)
            assert outcome.end is not None, "a run that raises nothing has an end"
            status, reason = outcome.end.status, outcome.end.reason
        except KeyboardInterrupt:
            status, reason = "interrupted", "interrupted"
        except InputError:
            raise
        except UnwrittenError as error:
            reason, unwritten = str(error), error
        except Exception as error:
            reason, fault = f"{type(error).__name__}: {error}", error
    if json:
        fields = summary(setup, outcome, status, reason, trace)
        output(json_format.dumps({**fields, "trace": fields["trace"] if outcome.content_hash else None}))
    elif unwritten is None:
        say(verdict_lines(outcome, status, reason, trace, wording_for(setup, raw)))
    if unwritten is not None:
        raise unwritten
    if fault is not None:
        output("\n".join(internal_lines(fault, trace if outcome.content_hash else None)), file=sys.stderr)
    return EXIT[status]


def summary(setup: Setup, outcome: Outcome, status: RunStatus, reason: str, trace: Path) -> Mapping[str, object]:
    """Return the fields of `--json`, in the order in which they are printed."""
    end, judged = outcome.end, outcome.verdict
    return {
        "scenario": setup.scenario.name,
        "seed": setup.seed,
        "world": setup.world.name,
        "status": status,
        "believed": status == "goal_achieved",
        "true": None if judged is None else judged.true,
        "own": outcome.own,
        "reason": reason,
        "anchor": None if end is None else end.anchor,
        "witness": None if judged is None else judged.witness,
        "displaced": None if judged is None else {item.id: item.distance_m for item in judged.displaced},
        "goal_probability": None if end is None else end.goal_probability,
        "conjuncts": {} if end is None else end.conjuncts,
        "regions": {} if end is None else end.regions,
        "actions": outcome.actions,
        "replans": outcome.replans,
        "clingo_calls": outcome.clingo_calls,
        "simulated_s": round(outcome.tick / TICKS_PER_SECOND, 3),
        "wall_s": {part: round(outcome.seconds.get(part, 0.0), 3) for part in PARTS}
        | {"total": round(outcome.total_s, 3)},
        "trace": str(trace),
        "content_hash": outcome.content_hash,
    }


def verdict_lines(outcome: Outcome, status: RunStatus, reason: str, trace: Path, words: Wording) -> list[str]:
    """Return the robot's belief about its goal, the truth, and the path of the trace if one was written."""
    counts = (
        f"{outcome.actions} actions, {outcome.replans} replans, "
        f"{outcome.tick / TICKS_PER_SECOND:.1f} s simulated, {outcome.total_s:.1f} s wall"
    )
    lines = []
    if outcome.end is None:
        lines.append(f"{'interrupted' if status == 'interrupted' else f'internal error: {reason}'}; {counts}")
    else:
        achieved, p = status == "goal_achieved", f"p = {outcome.end.goal_probability:.3f}"
        about = f"{outcome.end.anchor}, {p}" if outcome.end.anchor else p
        _, also, more = reason.partition("; ")
        said = f"goal believed achieved{also}{more}" if achieved else f"goal not achieved: {words.sentence(reason)}"
        best = about if achieved else f"best candidate {outcome.end.anchor or 'no object'}, {p}"
        lines.append(f"{said}; {best}; {counts}")
        if status != "goal_achieved":
            lines += explanation(outcome.end)
    if outcome.verdict is not None:
        witness = f" ({outcome.verdict.witness})" if outcome.verdict.witness else ""
        other = ", but not of the object that the robot has in mind" if outcome.verdict.true and not outcome.own else ""
        lines.append(f"true in the simulator: {'yes' + witness + other if outcome.verdict.true else 'no'}")
        if outcome.verdict.displaced:
            lines.append(f"displaced without intent: {displaced_text(outcome.verdict.displaced)}")
    if outcome.content_hash:
        lines.append(f"trace: {trace} (content {outcome.content_hash[:12]})")
    return "\n".join(lines).splitlines()


def explanation(end: RunEnd) -> list[str]:
    """Return the doubts about the best candidate, and the searched regions."""
    lines = []
    if end.conjuncts:
        shares = ", ".join(f"{word} {p:.3f}" for word, p in sorted(end.conjuncts.items(), key=lambda item: item[1]))
        lines.append(f"  of {end.anchor} is believed: {shares}")
    if end.regions:
        seen = ", ".join(f"{region} {100 * part:.0f} %" for region, part in end.regions.items())
        lines.append(f"  seen of the regions: {seen}")
    return lines


def unused(path: Path) -> Path:
    """Return the path, or the first of NAME.2.mcap, NAME.3.mcap, .. that does not exist, complete or partial.

    A partial file may be the only record of a killed run, or another run may be writing it.
    """
    number, free = 2, path
    while free.exists() or partial_of(free).exists():
        free = path.with_name(f"{path.stem}.{number}{path.suffix}")
        number += 1
    return free
