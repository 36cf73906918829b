"""Comparison of the times of runs and of their replays: one run for each command, and many runs in one command."""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.tables import ROOT, Table, Target

SCENARIOS = tuple(sorted(path.stem for path in (ROOT / "scenarios").glob("*.yaml")))
SKOLEM = Path(sys.executable).with_name("skolem")
TIMES = 20
ROUNDS = 2  # repetitions of every command: the fastest one counts
MORE_SEEDS = (1, 2)  # further seeds of each scenario, for a folder of traces


def tables() -> list[Table]:
    """Return the comparison of runs in PyBullet with their replays."""
    with tempfile.TemporaryDirectory() as folder:
        traces = [Path(folder) / f"{name}.mcap" for name in SCENARIOS]
        runs = [min(_run(trace, trace.stem, 0) for _ in range(ROUNDS)) for trace in traces]
        alone = [_fastest([trace]) for trace in traces]
        seconds, together = _fastest([traces[0], *traces])
        others = [(trace.with_stem(f"{trace.stem}-{seed}"), seed) for trace in traces for seed in MORE_SEEDS]
        for trace, seed in others:
            _run(trace, trace.stem.removesuffix(f"-{seed}"), seed)
        shared_seconds, shared = _fastest([*traces, *(trace for trace, _ in others)], workers=())
    rows, ratios, inner, lived, own, later = [], [], [], [], [], []
    for name, run, (command, found), other in zip(SCENARIOS, runs, alone, together[1:], strict=True):
        ratios.append(run / command)
        inner.append(found[0]["run_s"] / found[0]["replay_s"])
        lived.append(found[0]["simulated_s"] / command)
        own.append(found[0]["simulated_s"] / found[0]["replay_s"])
        later.append(other["run_s"] / other["replay_s"])
        times = [found[0]["simulated_s"], run, command, lived[-1], ratios[-1]]
        times += [found[0]["replay_s"], inner[-1], other["replay_s"], later[-1]]
        rows.append([name, found[0]["decisions"], *(f"{value:.2f}" for value in times)])
    every, every_lived = (sum(found[what] for found in together) for what in ("run_s", "simulated_s"))
    shared_runs = sum(found["run_s"] for found in shared)
    return [
        Table(
            "Replays beside their runs",
            "Of `skolem run` in PyBullet, seed 0, and of `skolem replay` of its trace, which is identical each time: "
            "how long the robot took, by its own clock, and the wall times of the whole commands; of run and replay "
            "themselves, without the start of the program; and of a replay in a command that has read the same rules "
            f"for another trace before. Of each command the fastest of {ROUNDS}, of a run itself the last. The folder "
            f"has {1 + len(MORE_SEEDS)} seeds of each scenario, shared "
            "between as many processes as `skolem replay` takes by itself.",
            (
                "scenario",
                "decisions",
                "robot, s",
                "run, s",
                "replay, s",
                "robot / replay",
                "run / replay",
                "itself, s",
                "ratio",
                "after another, s",
                "ratio",
            ),
            rows,
            [
                _faster("a replay itself", "the robot", min(own)),
                _faster("a command", "the robot", min(lived)),
                _faster(f"one command for {len(together)} traces, in one process", "the robot", every_lived / seconds),
                _faster("a command", "the run", min(ratios)),
                _faster("a replay itself", "the run", min(inner)),
                _faster("a replay with rules that were read before", "the run", min(later)),
                _faster(f"one command for {len(together)} traces, in one process", "the runs", every / seconds),
                _faster(f"one command for a folder of {len(shared)} traces", "the runs", shared_runs / shared_seconds),
            ],
            [_start_up(alone[0][0] - alone[0][1][0]["replay_s"])],
        )
    ]


def _faster(what: str, than: str, ratio: float) -> Target:
    return Target(f"{what} at least {TIMES} times faster than {than}", ratio >= TIMES, f"{ratio:.1f}")


def _start_up(seconds: float) -> str:
    """Return a note on the time that a short replay spends on its start."""
    return (
        f"Of each command about {seconds:.2f} s are the start: loading numpy, scipy, gtsam, clingo, pydantic and "
        "the product. Of a replay itself the first part is reading the rules of the trace, which the last columns are "
        "without. Each command is one process; a run of a few seconds is not replayed twenty times faster by one."
    )


def _run(trace: Path, scenario: str, seed: int) -> float:
    """Run a scenario by one command, which replaces the trace, and return the seconds."""
    trace.unlink(missing_ok=True)
    return _timed(["run", f"scenarios/{scenario}.yaml", "--seed", str(seed), "--profile", "-q", "-o", str(trace)])[0]


def _fastest(
    traces: Sequence[Path], workers: Sequence[str] = ("--workers", "1")
) -> tuple[float, list[dict[str, float]]]:
    """Return the shortest time of a repeated command and of each of its replays, in seconds."""
    every = [_replayed(traces, workers) for _ in range(ROUNDS)]
    each = [min(replays, key=lambda found: found["replay_s"]) for replays in zip(*(r for _, r in every), strict=True)]
    return min(seconds for seconds, _ in every), each


def _replayed(traces: Sequence[Path], workers: Sequence[str]) -> tuple[float, list[dict[str, float]]]:
    """Replay traces by one command, and return its seconds and its output for each trace.

    Raises:
        RuntimeError: If a replay is not identical.
    """
    seconds, out = _timed(["replay", "--json", *workers, *map(str, traces)])
    found = [json.loads(line) for line in out.splitlines()]
    strange = [each["trace"] for each in found if each["status"] != "identical"]
    if strange:
        raise RuntimeError(f"{strange[0]} diverged when it was replayed")
    return seconds, found


def _timed(arguments: Sequence[str]) -> tuple[float, str]:
    """Run a command of the product; return its wall time and what it printed.

    Raises:
        RuntimeError: If the command fails; a goal that is not achieved is no failure.
    """
    begun = time.monotonic()
    done = subprocess.run([str(SKOLEM), *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"skolem {' '.join(arguments)} failed: {done.stderr}")
    return time.monotonic() - begun, done.stdout
