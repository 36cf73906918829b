"""Replays from the command line: one after the other, each reported as it ends, and the exit status of them all."""

import json as json_format
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from skolem.tools import fingerprint
from skolem.tools.divergences import comparison_fields, divergence_lines
from skolem.tools.recorded_rules import Rulebooks
from skolem.tools.recorded_run import RecordedRun
from skolem.tools.replaying import Options, Replayed, replay
from skolem.tools.stopwatch import Stopwatch
from skolem.traces.diff import tolerance_for
from skolem.traces.errors import Fault, InputError, TraceError

BAD_INPUT, BAD_TRACE = 2, 3
Status = Literal["identical", "diverged", "same", "changed", "bad_input", "unsound"]
EXIT: dict[Status, int] = {
    "identical": 0,
    "same": 0,
    "diverged": 1,
    "changed": 1,
    "bad_input": BAD_INPUT,
    "unsound": BAD_TRACE,
}


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the command line asks for; see the options of `skolem replay`."""

    from_step: int
    re_anchor: bool
    plan_motions: bool
    atol: float | None
    rtol: float | None
    keep_all: bool
    rules: Path | None
    overrides: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """What came of one trace.

    Attributes:
        status: How it went.
        lines: For people.
        fields: For `--json`.
    """

    status: Status
    lines: list[str]
    fields: Mapping[str, object]


def execute(traces: Sequence[Path], wanted: Wanted, json: bool) -> int:
    """Replay each trace, print what came of it, and return the exit status: that of the worst.

    Raises:
        InputError: If the options contradict one another, or what they name is wrong.
    """
    _check(wanted)
    what_if = None
    if wanted.rules is not None or wanted.overrides:
        from skolem.tools.what_if_reports import WhatIf

        what_if = WhatIf(wanted.rules, wanted.overrides)
    rulebooks = Rulebooks()
    found: Counter[Status] = Counter()
    for path in traces:
        try:
            run = RecordedRun(path)
            report = _replayed(run, wanted, rulebooks) if what_if is None else what_if.report(run)
        except InputError as error:
            if len(traces) == 1:
                raise
            report = Report("bad_input", str(error).splitlines(), {"reason": str(error)})
        except TraceError as error:
            if len(traces) == 1:
                raise
            report = Report("unsound", [str(error).removeprefix(f"{path}: ")], {"reason": str(error)})
        found[report.status] += 1
        if json:
            print(json_format.dumps({"trace": str(path), "status": report.status, **report.fields}))
        else:
            first, *others = report.lines
            print("\n".join([f"{path}: {first}", *(f"  {line}" for line in others)]), flush=True)
    if len(traces) > 1 and not json:
        counts = ", ".join(f"{count} {status.replace('_', ' ')}" for status, count in sorted(found.items()))
        print(f"{len(traces)} traces: {counts}")
    return max(EXIT[status] for status in found)


def _check(wanted: Wanted) -> None:
    """Refuse options that contradict one another."""
    faults = []
    if wanted.rules is not None or wanted.overrides:
        given = {
            "--from-step": wanted.from_step,
            "--re-anchor": wanted.re_anchor,
            "--plan-motions": wanted.plan_motions,
            "--atol": wanted.atol is not None,
            "--rtol": wanted.rtol is not None,
        }
        message = "does not go with --rules or --set, which ask what would be, not whether all is as it was"
        faults = [Fault(name, 0, 0, message) for name, there in given.items() if there]
    if faults:
        raise InputError(faults)


def _replayed(run: RecordedRun, wanted: Wanted, rulebooks: Rulebooks) -> Report:
    other = fingerprint.differences(run.environment)
    tolerance = tolerance_for("other machine" if other else "equal machine").with_floats(wanted.atol, wanted.rtol)
    options = Options(tolerance, wanted.from_step, wanted.re_anchor, wanted.plan_motions, wanted.keep_all)
    replayed = replay(run, options, Stopwatch(), rulebooks)
    comparison = replayed.comparison
    lines = [_headline(replayed)]
    if other and (comparison.tolerated or not comparison.identical):
        lines.append(f"recorded on another machine ({', '.join(other)}): floats compared with tolerance")
    lines += divergence_lines(comparison)
    if replayed.stopped:
        lines.append(f"stopped: {replayed.stopped}")
    return Report("identical" if replayed.identical else "diverged", lines, _fields(replayed, other))


def _headline(replayed: Replayed) -> str:
    compared, differing = replayed.comparison.compared.total(), replayed.comparison.differing.total()
    word = "IDENTICAL" if replayed.identical else "DIVERGED"
    messages = f"{compared} messages" if replayed.identical else f"{differing} of {compared} messages"
    end = "" if replayed.ended or replayed.stopped else ", the record has no end"
    return f"{word}: {replayed.decisions} decisions, {messages}{end}; {_speed(replayed)}"


def _speed(replayed: Replayed) -> str:
    text = f"{replayed.simulated_s:.1f} s simulated in {replayed.seconds:.2f} s"
    if replayed.recorded_s is not None:
        text += f", {replayed.recorded_s / replayed.seconds:.0f} times as fast as the run"
    return text


def _fields(replayed: Replayed, other: list[str]) -> dict[str, object]:
    return {
        "decisions": replayed.decisions,
        "ended": replayed.ended,
        "stopped": replayed.stopped,
        "simulated_s": round(replayed.simulated_s, 3),
        "replay_s": round(replayed.seconds, 3),
        "run_s": replayed.recorded_s,
        "machine_differs_in": other,
        **comparison_fields(replayed.comparison),
    }
