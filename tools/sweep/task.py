"""One run of a sweep, as a message: everything a process on any machine needs to do it, and what it gives back.

Nothing is assumed of a shared file system. The worker is the same program as the one that asks, or it refuses.
"""

import hashlib
import signal
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from skolem.reasoner import load_rules
from skolem.reasoner.rulebook.book import Rulebook
from skolem.sim.scenario.scenario import load_document
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import Setup, compose, run_start
from skolem.tools.loop.source import SOURCE_SHA256
from skolem.tools.loop.stopwatch import LOADING, Stopwatch
from skolem.tools.sweep.rows import Row, expected_of, read_row
from skolem.traces import Trace
from skolem.traces.errors import InputError, SkolemError, TraceError
from skolem.traces.messages import RunStart, RunStatus

BY_ITSELF = frozenset({"goal_achieved", "goal_unachievable", "limit_reached"})  # ends that another attempt would repeat
HASH_DIGITS = 8


class WorkerRefusedError(SkolemError):
    """A worker cannot do the run as it was meant."""


@dataclass(frozen=True, slots=True)
class Task:
    """One run to do.

    Attributes:
        name: Of its trace.
        scenario: Text of the scenario file, overrides applied.
        rules: Name and content of the scenario's own rule files.
        start: What the trace must begin with.
        expected: How the scenario says that the run ends.
        source: The program that asks.
    """

    name: str
    scenario: str
    rules: tuple[tuple[str, bytes], ...]
    start: RunStart
    expected: RunStatus
    source: str


@dataclass(frozen=True, slots=True)
class Finished:
    """What a run gave: its row, and its trace as bytes."""

    row: Row
    trace: bytes


def tasks_of(setup: Setup, overrides: Sequence[str], seeds: range) -> list[Task]:
    """Return a task per seed.

    Args:
        setup: The scenario with its overrides, found without fault.
        overrides: The same overrides, for the names of the traces.
        seeds: Of the runs.
    """
    text = setup.document.effective_text()
    rules = tuple((path.name, path.read_bytes()) for path in setup.document.rules)
    changed = "".join(f"{flag}\n" for flag in overrides).encode()
    suffix = f"-{hashlib.sha256(changed).hexdigest()[:HASH_DIGITS]}" if overrides else ""
    start = run_start(setup)
    return [
        Task(
            name=f"{setup.scenario.name}-{seed}{suffix}.mcap",
            scenario=text,
            rules=rules,
            start=start.model_copy(update={"seed": seed}),
            expected=expected_of(setup),
            source=SOURCE_SHA256,
        )
        for seed in seeds
    ]


def done_before(task: Task, setup: Setup, folder: Path) -> Row | None:
    """Return the row of the run's trace in `folder`, or None if it has to be done.

    A trace counts if it is whole, was made of the same scenario, rules, robot and seed by the same program, and the run
    ended by itself.
    """
    path = folder / task.name
    if not path.exists():
        return None
    try:
        trace = Trace(path)
        same = next(trace.of(RunStart), None) == task.start and trace.metadata["env"].get("source") == task.source
        row = read_row(trace, task.name, setup) if same else None
    except TraceError:
        return None
    return row if row is not None and row.status in BY_ITSELF else None


def dask_setup(worker: object) -> None:
    """Leave Ctrl-C and a closed terminal to the process that asks; dask calls this where it starts a process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)


def run_on_worker(task: Task) -> Finished:
    """Do a run in a worker process of dask.

    Raises:
        WorkerRefusedError: If the worker has several threads, or is another program.
    """
    from distributed import get_worker

    worker = get_worker()
    if worker.state.nthreads != 1:
        raise WorkerRefusedError(f"{worker.address}: a worker must have one thread; start it with --nthreads 1")
    with TemporaryDirectory(dir=worker.local_directory) as folder:
        return perform(task, Path(folder))


def perform(task: Task, folder: Path) -> Finished:
    """Do a run, with an empty folder to work in; a run that raises gives a trace that ends with the reason.

    Raises:
        WorkerRefusedError: If this is another program than the one that asks.
    """
    watch, path = Stopwatch(), folder / "run.mcap"
    with watch.part(LOADING):
        setup = _setup(task, folder)
    try:
        run(setup, path, watch=watch)
    except Exception:
        if not path.exists():
            raise
    return Finished(read_row(Trace(path), task.name, setup), path.read_bytes())


@cache
def _shipped() -> Rulebook:
    """Return the rules that ship: to read them is half of a symbolic run, so a worker does it once."""
    return load_rules()


def _setup(task: Task, folder: Path) -> Setup:
    scenario = folder / "scenario.yaml"
    scenario.write_text(task.scenario, encoding="utf-8", newline="")
    for name, content in task.rules:
        (folder / name).write_bytes(content)
    try:
        document = replace(load_document(scenario), rules=tuple(folder / name for name, _ in task.rules))
        rulebook = None if task.rules else _shipped()
        setup = compose(document, task.start.seed, task.start.world, profile=True, rulebook=rulebook)
    except InputError as error:
        raise WorkerRefusedError(f"what is sound here is not so for the worker: {error}") from None
    if task.source != SOURCE_SHA256 or run_start(setup) != task.start:
        raise WorkerRefusedError("the worker runs another version of skolem or of the robot's model; install the same")
    return setup
