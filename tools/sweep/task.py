"""One run of a sweep as a message to a worker on any machine, with all of its inputs, and the worker's answer.

No shared file system is needed. A worker that runs another version of the program refuses.
"""

import gc
import hashlib
import signal
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from skolem.sim.scenario.scenario import load_document
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import Setup, compose, run_start
from skolem.tools.loop.source import SOURCE_SHA256
from skolem.tools.loop.stopwatch import LOADING, Stopwatch
from skolem.tools.sweep.rows import Row, expected_of, read_row
from skolem.traces import Trace
from skolem.traces.errors import InputError, SkolemError
from skolem.traces.messages import RunStart, RunStatus

HASH_DIGITS = 8


class WorkerRefusedError(SkolemError):
    """A worker cannot do the run as asked."""


@dataclass(frozen=True, slots=True)
class Task:
    """One run to do.

    Attributes:
        name: Name of its trace.
        scenario: Text of the scenario file, overrides applied.
        rules: Name and content of the scenario's own rule files.
        start: The start that the trace must have.
        expected: The end that the scenario expects.
        source: Hash of the program that asks.
    """

    name: str
    scenario: str
    rules: tuple[tuple[str, bytes], ...]
    start: RunStart
    expected: RunStatus
    source: str


@dataclass(frozen=True, slots=True)
class Finished:
    """The result of a run: its row, and its trace as bytes."""

    row: Row
    trace: bytes


def tasks_of(setup: Setup, overrides: Sequence[str], seeds: range) -> list[Task]:
    """Return a task for each seed.

    Args:
        setup: The checked scenario with its overrides.
        overrides: The same overrides, for the names of the traces.
        seeds: Seeds of the runs.
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


def dask_setup(worker: object) -> None:
    """Leave Ctrl-C and a closed terminal to the process that asks; dask calls this in each process that it starts."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)


def run_on_worker(task: Task) -> Finished:
    """Do a run in a worker process of dask.

    Raises:
        WorkerRefusedError: If the worker has several threads, or runs another version of the program.
    """
    from distributed import get_worker

    worker = get_worker()
    if worker.state.nthreads != 1:
        raise WorkerRefusedError(f"{worker.address}: a worker must have one thread; start it with --nthreads 1")
    try:
        with TemporaryDirectory(dir=worker.local_directory) as folder:
            return perform(task, Path(folder))
    finally:
        gc.collect()  # a run leaves circles of few objects that hold much memory of compiled libraries


def perform(task: Task, folder: Path) -> Finished:
    """Do a run in an empty folder; the trace of a run that raises ends with the reason.

    Raises:
        WorkerRefusedError: If the program that asks has another version.
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


def _setup(task: Task, folder: Path) -> Setup:
    scenario = folder / "scenario.yaml"
    scenario.write_text(task.scenario, encoding="utf-8", newline="")
    for name, content in task.rules:
        (folder / name).write_bytes(content)
    try:
        document = replace(load_document(scenario), rules=tuple(folder / name for name, _ in task.rules))
        setup = compose(document, task.start.seed, task.start.world, profile=True)
    except InputError as error:
        raise WorkerRefusedError(f"what is sound here is not so for the worker: {error}") from None
    if task.source != SOURCE_SHA256 or run_start(setup) != task.start:
        raise WorkerRefusedError("the worker runs another version of skolem or of the robot's model; install the same")
    return setup
