"""Measurement of the time to convert a recorded run into a recording of the viewer."""

import tempfile
import time
from pathlib import Path

from benchmarks.tables import ROOT, Table, Target
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.tools.view.viewing import record
from skolem.traces.file.reader import Trace
from skolem.traces.messages import TICKS_PER_SECOND

SCENARIOS = (("illustrative", 3, True), ("illustrative", 3, False))  # seed, pictures; runs of more than a minute
TIMES = 5
MINUTE_S, LIMIT_S = 60.0, 2.0


def tables() -> list[Table]:
    """Return the conversion times of runs in PyBullet."""
    with tempfile.TemporaryDirectory() as folder:
        found = [_measured(Path(folder), *each) for each in SCENARIOS]
    worst = max(minute for _, minute in found)
    return [
        Table(
            "Traces for the viewer",
            f"`skolem view T.mcap --save F.rrd`, without the start of the program: the fastest of {TIMES} conversions "
            "of a whole run in PyBullet, the robot's meshes included, and what that is for a minute of the run.",
            (
                "scenario",
                "pictures",
                "run, s simulated",
                "messages",
                "recording, MB",
                "conversion, s",
                "of 60 s of run",
            ),
            [row for row, _ in found],
            [Target(f"60 s of run under {LIMIT_S:.0f} s", worst < LIMIT_S, f"{worst:.2f} s")],
        )
    ]


def _measured(folder: Path, scenario: str, seed: int, pictures: bool) -> tuple[list[object], float]:
    """Return the row of a run, and the conversion time of a minute of it in seconds."""
    path = folder / f"{scenario}-{pictures}.mcap"
    setup = prepare(ROOT / "scenarios" / f"{scenario}.yaml", (), seed, "pybullet", images=pictures)
    run(setup, path)
    trace, recording = Trace(path), path.with_suffix(".rrd")
    seconds = min(_timed(trace, recording) for _ in range(TIMES))
    ticks = [recorded.tick for recorded in trace.messages()]
    simulated = max(ticks) / TICKS_PER_SECOND
    minute = seconds * MINUTE_S / simulated
    size = recording.stat().st_size / 1e6
    row = [scenario, "yes" if pictures else "no", f"{simulated:.1f}", len(ticks), f"{size:.1f}"]
    return [*row, f"{seconds:.2f}", f"{minute:.2f} s"], minute


def _timed(trace: Trace, recording: Path) -> float:
    """Return the seconds of one conversion."""
    begun = time.monotonic()
    record(trace, recording)
    return time.monotonic() - begun
