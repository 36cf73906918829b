"""How much faster than a run its replay is: as whole commands, and where one command replays many runs."""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.tables import ROOT, Table, Target

SCENARIOS = ("illustrative", "real1_oil", "sim1_green", "sim2_heavy_soda", "occluded")
SKOLEM = Path(sys.executable).with_name("skolem")
TIMES = 20


def tables() -> list[Table]:
    """Return the comparison of runs in PyBullet with their replays."""
    with tempfile.TemporaryDirectory() as folder:
        traces = [Path(folder) / f"{name}.mcap" for name in SCENARIOS]
        runs = [
            _timed(["run", f"scenarios/{t.stem}.yaml", "--seed", "0", "--profile", "--quiet", "-o", str(t)])[0]
            for t in traces
        ]
        alone = [_replayed([trace]) for trace in traces]
        seconds, together = _replayed([traces[0], *traces])
    rows, ratios, inner = [], [], []
    for name, run, (command, found), other in zip(SCENARIOS, runs, alone, together[1:], strict=True):
        ratios.append(run / command)
        inner.append(found[0]["run_s"] / found[0]["replay_s"])
        rest = other["run_s"] / other["replay_s"]
        times = [run, command, ratios[-1], found[0]["replay_s"], inner[-1], other["replay_s"], rest]
        rows.append([name, found[0]["decisions"], *(f"{value:.2f}" for value in times)])
    every = sum(found["run_s"] for found in together)
    return [
        Table(
            "Replays beside their runs",
            "Wall times of `skolem run` in PyBullet, seed 0, and of `skolem replay` of its trace, which is identical "
            "each time: of the whole commands; of run and replay themselves, without the start of the program; and of "
            "a replay in a command that has read the same rules for another trace before.",
            (
                "scenario",
                "decisions",
                "run, s",
                "replay, s",
                "ratio",
                "itself, s",
                "ratio",
                "after another, s",
                "ratio",
            ),
            rows,
            [
                Target(f"a command at least {TIMES} times faster", min(ratios) >= TIMES, f"{min(ratios):.1f}"),
                Target(f"a replay itself at least {TIMES} times faster", min(inner) >= TIMES, f"{min(inner):.1f}"),
                Target(
                    f"one command for {len(together)} traces at least {TIMES} times faster than the runs",
                    every / seconds >= TIMES,
                    f"{every / seconds:.1f}",
                ),
            ],
            [_start_up(alone[0][0] - alone[0][1][0]["replay_s"])],
        )
    ]


def _start_up(seconds: float) -> str:
    """Return what a short replay spends its time on."""
    return (
        f"Of each command about {seconds:.2f} s are the start: loading numpy, scipy, gtsam, clingo, pydantic and "
        "the product. Of a replay itself the first part is reading the rules of the trace, which the last columns are "
        "without. Runs of a few seconds cannot be replayed twenty times faster by one command each."
    )


def _replayed(traces: Sequence[Path]) -> tuple[float, list[dict[str, float]]]:
    """Return the seconds of one command, and what it says of each trace.

    Raises:
        RuntimeError: If one is not identical.
    """
    seconds, out = _timed(["replay", "--json", *map(str, traces)])
    found = [json.loads(line) for line in out.splitlines()]
    strange = [each["trace"] for each in found if each["status"] != "identical"]
    if strange:
        raise RuntimeError(f"{strange[0]} diverged when it was replayed")
    return seconds, found


def _timed(arguments: Sequence[str]) -> tuple[float, str]:
    """Run a command of the product; return its wall time and what it printed."""
    begun = time.monotonic()
    done = subprocess.run([str(SKOLEM), *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return time.monotonic() - begun, done.stdout
