"""Traces that a sweep finds in its folder: those of the runs that are asked for count as done, all others are kept."""

import os
from dataclasses import dataclass
from pathlib import Path

from skolem.tools.loop.setup import Setup
from skolem.tools.sweep.rows import Row, read_row
from skolem.tools.sweep.task import Task
from skolem.traces import Trace
from skolem.traces.errors import TraceError
from skolem.traces.file.codec import CONTENT
from skolem.traces.file.made_of import digest, disagreements
from skolem.traces.messages import RunStart
from skolem.traces.written import give_name, refuse_special

# Another attempt would end alike.
BY_ITSELF = frozenset({"goal_achieved", "goal_unachievable", "no_referent", "no_unique_referent", "limit_reached"})
SAID = {  # field of the start of a run -> what differs
    "scenario": "of another scenario",
    "goal": "of another goal",
    "seed": "of another seed",
    "world": "of another world",
    "limits": "of other limits",
    "rules_sha256": "of other rules",
    "robot_sha256": "of another model of the robot",
    "scenario_sha256": "of a scenario with other values",
    "schema_version": "of another version of skolem",
}


@dataclass(frozen=True, slots=True)
class Earlier:
    """What a sweep finds under the name of the trace of a run.

    Attributes:
        row: The row of the run, if it is done already.
        why: Otherwise why the trace does not count; empty if there is none.
    """

    row: Row | None = None
    why: str = ""


def earlier(task: Task, setup: Setup, folder: Path) -> Earlier:
    """Return what there is of a run.

    A trace counts if it is whole, its hash fits, it was made from the same scenario, rules, robot, seed and world by
    the same program, and the run ended by itself.

    Raises:
        InputError: If what has its name is no file.
    """
    path = folder / task.name
    refuse_special(path)
    if not os.path.exists(path):
        return Earlier()
    try:
        trace = Trace(path)
        why = _difference(trace, task)
        row = None if why else read_row(trace, task.name, setup)
    except TraceError as error:
        return Earlier(why=str(error).removeprefix(f"{path}: ").partition(";")[0])
    if row is None or row.status in BY_ITSELF:
        return Earlier(row, why)
    return Earlier(why=f"of a run that was cut short ({row.status})")


def kept_as(path: Path) -> Path:
    """Return where a trace that does not count is kept: the first free name of NAME.old.mcap, NAME.old.2.mcap, .."""
    number, free = 2, path.with_name(f"{path.stem}.old{path.suffix}")
    while os.path.lexists(free):
        free = path.with_name(f"{path.stem}.old.{number}{path.suffix}")
        number += 1
    return free


def keep(path: Path) -> None:
    """Give a trace that does not count another name, if there is one.

    Raises:
        OSError: If the folder cannot be written to.
    """
    if os.path.lexists(path):
        give_name(path, kept_as(path))


def _difference(trace: Trace, task: Task) -> str:
    """Return in what a trace is not of the run that is asked for; empty if it is."""
    start = next(trace.of(RunStart), None)
    if start is None:
        return "without a start of the run"
    for name, said in SAID.items():
        if getattr(start, name) != getattr(task.start, name):
            return said
    if trace.metadata.get("env", {}).get("source") != task.source:
        return "of another version of the program"
    if trace.metadata.get(CONTENT) != trace.hashes.metadata:
        return "not as the hash of its content says"
    attached = {name: digest(content) for name, content in trace.attachments.items()}
    return next(disagreements(start, attached, trace.metadata.get("run", {})), "")
