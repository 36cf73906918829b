"""Results of mutants as lines of a file, so that a long run may be interrupted."""

import json
import sys
from collections import Counter
from collections.abc import Sequence
from multiprocessing import get_context
from pathlib import Path

import pytest

from benchmarks.mutants.drawing import Mutant
from benchmarks.mutants.forking import Checker, Result

Row = dict[str, str | int]


def apart(stage: str, tests: Sequence[str], mutants: Sequence[Mutant], out: Path) -> None:
    """Check the unchecked mutants in a separate process, which imports these tests alone."""
    done = {name(row) for row in rows(out) if row["stage"] == stage}
    left = [mutant for mutant in mutants if name(said(stage, mutant)) not in done]
    if left:
        process = get_context("spawn").Process(target=check, args=(stage, tests, left, out))
        process.start()
        process.join()
        if process.exitcode:
            sys.exit(process.exitcode)


def check(stage: str, tests: Sequence[str], mutants: Sequence[Mutant], out: Path) -> None:
    """Check mutants against tests, and add a line for each to the file."""
    with out.open("a", encoding="utf-8") as file:

        def tell(result: Result) -> None:
            row = said(stage, result.mutant) | {"outcome": result.outcome, "tests": result.tests, "by": result.by}
            file.write(json.dumps(row) + "\n")
            file.flush()

        checker = Checker(mutants, tell)
        status = pytest.main(["-q", "-p", "no:cacheprovider", *tests], [checker])
    if checker.broken:
        sys.exit(f"these tests fail without a mutant: {', '.join(checker.broken)}")
    if status not in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
        sys.exit(int(status))


def said(stage: str, mutant: Mutant) -> Row:
    """Return the fields of a mutant that are known before it is checked."""
    return {
        "stage": stage,
        "room": mutant.room,
        "path": mutant.path,
        "line": mutant.line,
        "column": mutant.column,
        "before": mutant.before,
        "after": mutant.after,
    }


def name(row: Row) -> tuple[str | int, ...]:
    """Return the fields that identify a mutant."""
    return tuple(row[key] for key in ("path", "line", "column", "before", "after"))


def rows(path: Path) -> list[Row]:
    """Return the lines of the file."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []


def summary(checked: Sequence[Row]) -> str:
    """Return the results of each room, and the mutants that no test noticed."""
    lines = [
        "| room | mutants | noticed by its tests | by replays only | by neither | its tests | both |",
        "|---|---|---|---|---|---|---|",
    ]
    alive = {name(row): row for row in checked if row["outcome"] in ("survived", "uncovered")}
    for row in checked:
        if row["stage"] == "replays" and row["outcome"] not in ("survived", "uncovered"):
            alive.pop(name(row), None)
    drawn_of = Counter(str(row["room"]) for row in checked if row["stage"] == "room")
    noticed = Counter(
        (str(row["stage"]), str(row["room"])) for row in checked if row["outcome"] not in ("survived", "uncovered")
    )
    for room, count in drawn_of.items():
        own, late = noticed["room", room], noticed["replays", room]
        shares = f"{own / count:.0%} | {(own + late) / count:.0%}"
        lines.append(f"| {room} | {count} | {own} | {late} | {count - own - late} | {shares} |")
    lines += ["", *(f"{r['path']}:{r['line']}: {r['before']} -> {r['after']} ({r['outcome']})" for r in alive.values())]
    return "\n".join(lines) + "\n"
