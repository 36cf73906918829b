"""Many runs of one scenario, and the table of how they went."""

import multiprocessing
import os
import platform
import re
import statistics
import sys
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from skolem.tools import session
from skolem.tools.live import Silence
from skolem.tools.stopwatch import Stopwatch
from skolem.traces.errors import Fault, InputError
from skolem.traces.messages import RunStatus

Row = Mapping[str, Any]
TIMES = (
    ("rendering and detection", session.SENSING),
    ("estimation", session.ESTIMATION),
    ("reasoning", session.REASONING),
    ("motion planning", session.MOTION_PLANNING),
    ("physics", session.PHYSICS),
    ("total", "total"),
)


@dataclass(frozen=True, slots=True)
class Task:
    """One run to do, as a process of its own can be told."""

    scenario: Path
    seed: int
    world: session.WorldKind
    trace: Path


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


def run_all(tasks: Sequence[Task], jobs: int) -> Iterable[Row]:
    """Yield a row per task, in order, and a line on standard error for each as it comes."""
    if jobs == 1:
        found: Iterable[Row] = map(run_one, tasks)
    else:
        pool = ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"))
        found = pool.map(run_one, tasks)
    for row in found:
        print(
            f"seed {row['seed']}: {row['status']}, true {row['true']}, {row['actions']} actions, "
            f"{row['wall_s']['total']:.1f} s",
            file=sys.stderr,
            flush=True,
        )
        yield row


def run_one(task: Task) -> Row:
    """Return the summary of one run; a run that crashes gives a row with status `error`."""
    watch, outcome = Stopwatch(), session.Outcome()
    status: RunStatus = "error"
    with watch.part(session.LOADING):
        setup = session.prepare(task.scenario, seed=task.seed, world=task.world)
    try:
        session.run(setup, task.trace, Silence(), watch, outcome)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    else:
        assert outcome.end is not None, "a run that raises nothing has an end"
        status, reason = outcome.end.status, outcome.end.reason
    return session.summary(setup, outcome, status, reason, task.trace)


def report(name: str, world: str, rows: Sequence[Row]) -> str:
    """Return how the runs went, as Markdown: a sentence, and a table with a row per seed and the medians."""
    head = ("seed", "believed", "true", "object", "actions", "replans", *(title for title, _ in TIMES))
    lines = [
        f"## {name}, {world} world",
        "",
        f"{sum(row['believed'] for row in rows)} of {len(rows)} runs ended with the goal believed, "
        f"{sum(row['believed'] and row['true'] is True for row in rows)} of these truly so. "
        f"Wall time in seconds on {os.cpu_count()} processors ({platform.machine()}), "
        f"Python {platform.python_version()}.",
        "",
        f"| {' | '.join(head)} |",
        f"|{'---|' * len(head)}",
        *(_line(row) for row in rows),
        _medians(rows),
    ]
    failed = [f"- seed {row['seed']}: {row['status']}: {row['reason']}" for row in rows if not row["believed"]]
    return "\n".join([*lines, *(["", *failed] if failed else []), ""])


def _line(row: Row) -> str:
    said = {True: "yes", False: "no", None: ""}
    cells = [row["seed"], said[row["believed"]], said[row["true"]], row["anchor"] or "", row["actions"], row["replans"]]
    cells += [f"{row['wall_s'][part]:.2f}" for _, part in TIMES]
    return f"| {' | '.join(map(str, cells))} |"


def _medians(rows: Sequence[Row]) -> str:
    counts = [f"{statistics.median(row[key] for row in rows):g}" for key in ("actions", "replans")]
    times = [f"{statistics.median(row['wall_s'][part] for row in rows):.2f}" for _, part in TIMES]
    return f"| **median** | | | | {' | '.join(f'**{cell}**' for cell in counts + times)} |"


def with_section(text: str, key: str, section: str) -> str:
    """Return a text with the section of that key put in, or replaced, between its markers."""
    begin, end = f"<!-- results {key} -->", f"<!-- end of results {key} -->"
    block = f"{begin}\n{section}{end}"
    pattern = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
    if pattern.search(text):
        return pattern.sub(lambda _: block, text)
    return f"{text.rstrip()}\n\n{block}\n"
