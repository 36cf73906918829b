"""A sweep: what there is to do, what of it is done already, the rest on workers, and the tables of it all."""

import json as json_format
import re
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from skolem.tools.loop.setup import Setup, prepare
from skolem.tools.sweep.progress import progress_for
from skolem.tools.sweep.report import ACHIEVED, Part, line, sections, summary, with_section
from skolem.tools.sweep.rows import Row, put, results_csv, times_csv
from skolem.tools.sweep.task import Task, done_before, tasks_of
from skolem.traces.errors import Fault, InputError
from skolem.traces.file.interrupts import interrupts_held
from skolem.traces.messages import RunStatus

INTERRUPTED = 130


@dataclass(frozen=True, slots=True)
class Plan:
    """What a sweep is to do.

    Attributes:
        setups: The scenarios, found without fault, by name.
        overrides: What was changed of each of them.
        tasks: A run per scenario and seed, sorted by both.
    """

    setups: dict[str, Setup]
    overrides: Sequence[str]
    tasks: Sequence[Task]


def seed_range(text: str) -> range:
    """Return the seeds of `A-B` or of a single number.

    Raises:
        InputError: If the text is neither.
    """
    match = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text)
    seeds = range(int(match[1]), int(match[2] or match[1]) + 1) if match else range(0)
    if not seeds:
        raise InputError([Fault("--seeds", 0, 0, f"expected A-B with A <= B, for example 0-19 (got '{text}')")])
    return seeds


def plan(files: Sequence[Path], seeds: range, world: str, overrides: Sequence[str]) -> Plan:
    """Return what there is to do.

    Raises:
        InputError: With every fault of every scenario, or if two have the same name.
    """
    setups: dict[str, Setup] = {}
    faults: list[Fault] = []
    for file in files:
        try:
            setup = prepare(file, overrides, world=world)
        except InputError as error:
            faults += error.faults
            continue
        name = setup.scenario.name
        if name in setups:
            faults.append(Fault(str(file), 0, 0, f"the scenario '{name}' was given already", at="name"))
        setups[name] = setup
    if faults:
        raise InputError(faults)
    tasks = [task for name in sorted(setups) for task in tasks_of(setups[name], overrides, seeds)]
    return Plan(setups, overrides, tasks)


def execute(
    plan: Plan, out: Path, workers: int, scheduler: str | None, write: Path | None, json: bool, quiet: bool
) -> int:
    """Do the runs that are not done yet, write the tables, print what came of it, and return the exit status.

    Raises:
        InputError: If the tables could not be written in the end.
    """
    _check_places(out, write)
    rows = {task.name: row for task in plan.tasks if (row := done_before(task, out)) is not None}
    interrupted = False
    try:
        _do_the_others(plan, out, rows, workers, scheduler, quiet)
    except KeyboardInterrupt:
        interrupted = True
    finally:
        with interrupts_held():
            parts = _parts(plan, rows)
            _write_tables(parts, out, write if len(rows) == len(plan.tasks) else None)
    found = [row for part in parts for row in part.rows]
    if json:
        for row in found:
            print(json_format.dumps(row.facts() | {"wall_s": dict(row.seconds)}))
    else:
        print("\n".join([*map(line, parts), f"{len(found)} of {len(plan.tasks)} runs; see {out / 'summary.md'}"]))
    if interrupted:
        return INTERRUPTED
    return 0 if all(row.believed for row in found) else 1


def _check_places(out: Path, write: Path | None) -> None:
    """Refuse places where nothing can be written, before hours of runs."""
    faults = []
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        faults.append(Fault("--out", 0, 0, f"cannot write to {out}: {error.strerror}"))
    try:
        if write is not None and write.exists():
            write.read_text(encoding="utf-8")
    except OSError as error:
        faults.append(Fault("--write", 0, 0, f"cannot write to {write}: {error.strerror}"))
    except UnicodeDecodeError:
        faults.append(Fault("--write", 0, 0, f"cannot write to {write}: it is not a text"))
    if faults:
        raise InputError(faults)


def _do_the_others(
    plan: Plan, out: Path, rows: dict[str, Row], workers: int, scheduler: str | None, quiet: bool
) -> None:
    """Do every run that has no row yet; put its trace into `out` and its row into `rows` as soon as it is there."""
    missing = [task for task in plan.tasks if task.name not in rows]
    if not missing:
        return
    from skolem.tools.sweep import pool  # dask takes half a second to import

    with (
        progress_for(len(plan.tasks), len(rows), quiet) as progress,
        pool.workers_of(scheduler) if scheduler else pool.local_workers(workers) as client,
        closing(pool.run_all(client, missing)) as finished,
    ):
        for task, run in finished:
            with interrupts_held():
                if run.trace:
                    put(out / task.name, run.trace)
                rows[task.name] = run.row
            progress.done(run.row)


def _parts(plan: Plan, rows: Mapping[str, Row]) -> list[Part]:
    """Return the rows there are, by scenario and seed."""
    found = [rows[task.name] for task in plan.tasks if task.name in rows]
    return [
        Part(
            name=name,
            file=setup.document.file,
            world=setup.world.name,
            overrides=plan.overrides,
            goal=setup.goal,
            expected=_expected(setup),
            rows=[row for row in found if row.scenario == name],
        )
        for name, setup in sorted(plan.setups.items())
    ]


def _expected(setup: Setup) -> RunStatus:
    """Return how the scenario says that its runs end."""
    return ACHIEVED if setup.scenario.expect is None else setup.scenario.expect.status


def _write_tables(parts: Sequence[Part], out: Path, write: Path | None) -> None:
    """Write the tables of the sweep, and the accounts into the file `write`: of complete sweeps alone."""
    rows = [row for part in parts for row in part.rows]
    put(out / "results.csv", results_csv(rows).encode())
    put(out / "times.csv", times_csv(rows).encode())
    put(out / "summary.md", summary(parts).encode())
    if write is not None:
        text = write.read_text(encoding="utf-8") if write.exists() else "# Results\n"
        for key, account in sections(parts):
            text = with_section(text, key, account)
        put(write, text.encode())
