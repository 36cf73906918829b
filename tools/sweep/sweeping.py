"""A sweep: the list of runs, the results of earlier runs, the other runs on workers, and the results files."""

import json as json_format
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from skolem.tools.loop.families import drawn_setup, refuse_unknown
from skolem.tools.loop.setup import Setup, prepare
from skolem.tools.sweep.calibration import calibration_of
from skolem.tools.sweep.earlier import earlier, keep, kept_as
from skolem.tools.sweep.progress import progress_for
from skolem.tools.sweep.report import Part, line, sections, summary, with_section
from skolem.tools.sweep.rows import Row, results_csv, times_csv
from skolem.tools.sweep.task import Task, tasks_of
from skolem.tools.words.terminal import output
from skolem.traces.errors import MOST_FAULTS, Fault, InputError
from skolem.traces.file.interrupts import interrupts_held
from skolem.traces.given import read_regular
from skolem.traces.written import locked, put, refuse_unwritable

INTERRUPTED = 130
LOCK = ".lock"  # in the folder of a sweep
TABLES = ("results.csv", "times.csv", "summary.md")
LONGEST = 16 << 20  # bytes of a report that gets a section
MOST_SEEDS = 10_000  # of one sweep: each has a task, a row and a trace; further ones may follow in the same folder


@dataclass(frozen=True, slots=True)
class Group:
    """The runs of one section of the report: one scenario with many seeds, or one scenario of a family for each seed.

    Attributes:
        name: Name of the scenario or family.
        source: Its name on the command line: a file, or a family.
        setups: The checked scenario of each seed.
        overrides: Changed values of each of them.
        tasks: One task for each seed, in order.
    """

    name: str
    source: str
    setups: Mapping[int, Setup]
    overrides: Sequence[str]
    tasks: Sequence[Task]


@dataclass(frozen=True, slots=True)
class Plan:
    """The runs of a sweep, as groups by name."""

    groups: Sequence[Group]

    @property
    def tasks(self) -> list[Task]:
        """Return every run, by group and seed."""
        return [task for group in self.groups for task in group.tasks]


def seed_range(text: str) -> range:
    """Return the seeds of `A-B` or of a single number.

    Raises:
        InputError: If the text is neither, or there are too many seeds.
    """
    match = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text)
    seeds = range(int(match[1]), int(match[2] or match[1]) + 1) if match else range(0)
    if not seeds:
        raise InputError([Fault("--seeds", 0, 0, f"expected A-B with A <= B, for example 0-19 (got '{text:.40}')")])
    if len(seeds) > MOST_SEEDS:
        said = f"{len(seeds):,} seeds, at most {MOST_SEEDS:,} are run in one sweep"
        raise InputError([Fault("--seeds", 0, 0, f"{said}; take the others in further ones with the same --out")])
    return seeds


def plan(
    files: Sequence[Path],
    seeds: range,
    world: str,
    overrides: Sequence[str],
    families: Sequence[str] = (),
    bound: float | None = None,
) -> Plan:
    """Return the runs of a sweep.

    Args:
        files: Scenario files; each is run for every seed.
        seeds: Seeds of the runs, and of the worlds of families.
        world: Name of the simulator.
        overrides: Changed values of every scenario.
        families: Families; the world of each seed is run once.
        bound: The bound of the goals in worlds of families, instead of a drawn one.

    Raises:
        InputError: With every fault of every scenario, or if two have the same name, or if there is nothing to do.
    """
    if not files and not families:
        raise InputError([Fault("SCENARIOS", 0, 0, "give scenario files or --family")])
    for i, family in enumerate(families):
        refuse_unknown(family)
        if family in families[:i]:
            raise InputError([Fault("--family", 0, 0, f"'{family}' was given already")])
    groups: dict[str, Group] = {}
    faults: list[Fault] = []
    for file in files:
        try:
            setup = prepare(file, overrides, world=world)
        except InputError as error:
            faults += error.faults
            continue
        name = setup.scenario.name
        if name in groups:
            faults.append(Fault(str(file), 0, 0, f"the scenario '{name}' was given already", at="name"))
        groups[name] = Group(name, str(file), dict.fromkeys(seeds, setup), overrides, tasks_of(setup, overrides, seeds))
    for family in families:
        if family in groups:
            faults.append(Fault("--family", 0, 0, f"'{family}' was given already"))
        elif not faults:
            groups[family] = _of_family(family, seeds, world, overrides, bound)
    if faults:
        raise InputError(faults)
    return Plan([groups[name] for name in sorted(groups)])


def _of_family(family: str, seeds: range, world: str, overrides: Sequence[str], bound: float | None) -> Group:
    """Return the worlds of a family, each with one run."""
    setups, tasks = {}, []
    changed = [*overrides, *([] if bound is None else [f"bound {bound:g}"])]
    for seed in seeds:
        setups[seed] = drawn_setup(family, seed, bound, overrides, world)
        tasks += tasks_of(setups[seed], changed, range(seed, seed + 1))
    source = f"--family {family}" + ("" if bound is None else f" --bound {bound:g}")
    name = family if bound is None else f"{family}, bound {bound:g}"
    return Group(name, source, setups, overrides, tasks)


def execute(
    plan: Plan, out: Path, workers: int, scheduler: str | None, write: Path | None, json: bool, quiet: bool
) -> int:
    """Do the runs that are not done yet, write the results files, print the results, and return the exit status.

    Raises:
        InputError: If the results files could not be written in the end, if another sweep uses the folder, or if the
            workers are lost.
    """
    _check_places(out, write)
    with locked(out, LOCK):
        return _execute(plan, out, workers, scheduler, write, json, quiet)


def _execute(
    plan: Plan, out: Path, workers: int, scheduler: str | None, write: Path | None, json: bool, quiet: bool
) -> int:
    rows = _done_before(plan, out)
    interrupted = False
    try:
        _do_the_others(plan, out, rows, workers, scheduler, quiet)
    except KeyboardInterrupt:
        interrupted = True
    finally:
        parts, whole = _parts(plan, rows), len(rows) == len(plan.tasks)
        if write is not None and whole:
            parts = [_calibrated(part, out) for part in parts]
        with interrupts_held():
            _write_tables(parts, out, write if whole else None)
    found = [row for part in parts for row in part.rows]
    if json:
        for row in found:
            output(json_format.dumps(row.facts() | {"wall_s": dict(row.seconds)}))
    else:
        output("\n".join([*map(line, parts), f"{len(found)} of {len(plan.tasks)} runs; see {out / 'summary.md'}"]))
    if interrupted:
        return INTERRUPTED
    return 0 if all(row.believed for row in found) else 1


def _done_before(plan: Plan, out: Path) -> dict[str, Row]:
    """Return the rows of the runs that are done already, by the name of their trace; say which traces do not count."""
    rows: dict[str, Row] = {}
    others = []
    for group in plan.groups:
        for task in group.tasks:
            found = earlier(task, group.setups[task.start.seed], out)
            if found.row is not None:
                rows[task.name] = found.row
            elif found.why:
                name = kept_as(out / task.name).name
                others.append(f"{out / task.name}: {found.why}: the run is done anew, and this kept as {name}")
    more = [f"and {len(others) - MOST_FAULTS} more"] if len(others) > MOST_FAULTS else []
    if others:
        output("\n".join([*others[:MOST_FAULTS], *more]), file=sys.stderr, flush=True)
    return rows


def _check_places(out: Path, write: Path | None) -> None:
    """Refuse folders and files that cannot be written, before hours of runs."""
    faults: list[Fault] = []
    for path in (out / TABLES[0], write):
        try:
            if path is not None:
                refuse_unwritable(path)
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    if write is not None:
        _text_of(write)


def _text_of(report: Path) -> str:
    """Return the text of a file that is to hold sections, or of a new one.

    Raises:
        InputError: If it cannot be read, is too long, or is not a text.
    """
    try:
        data = read_regular(report, LONGEST)
        if len(data) > LONGEST:
            raise InputError([Fault(str(report), 0, 0, f"has more than {LONGEST >> 20} MB; give another file")])
        return data.decode("utf-8")
    except FileNotFoundError:
        return "# Results\n"
    except OSError as error:
        raise InputError([Fault(str(report), 0, 0, f"cannot be read: {error.strerror}")]) from error
    except UnicodeDecodeError as error:
        raise InputError([Fault(str(report), 0, 0, "is not a text; give another file")]) from error


def _do_the_others(
    plan: Plan, out: Path, rows: dict[str, Row], workers: int, scheduler: str | None, quiet: bool
) -> None:
    """Do every run without a row, and put its trace into `out` and its row into `rows` at once."""
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
                    keep(out / task.name)
                    put(out / task.name, run.trace)
                rows[task.name] = run.row
            progress.done(run.row)


def _parts(plan: Plan, rows: Mapping[str, Row]) -> list[Part]:
    """Return the finished rows, by group and seed."""
    return [
        Part(
            name=group.name,
            source=group.source,
            world=next(iter(group.setups.values())).world.name,
            overrides=group.overrides,
            goals={seed: setup.goal for seed, setup in group.setups.items()},
            rows=[rows[task.name] for task in group.tasks if task.name in rows],
        )
        for group in plan.groups
    ]


def _calibrated(part: Part, out: Path) -> Part:
    """Return a part with the calibration over its traces."""
    return replace(part, calibration=calibration_of(out / row.trace for row in part.rows if row.trace))


def _write_tables(parts: Sequence[Part], out: Path, write: Path | None) -> None:
    """Write the results files; if the sweep is complete, also put the sections into the file `write`."""
    rows = [row for part in parts for row in part.rows]
    for name, text in zip(TABLES, (results_csv(rows), times_csv(rows), summary(parts)), strict=True):
        put(out / name, text.encode())
    if write is not None:
        text = _text_of(write)
        for key, account in sections(parts):
            text = with_section(text, key, account)
        put(write, text.encode())
