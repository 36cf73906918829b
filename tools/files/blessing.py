"""Recording of golden traces: run the scenario, compare with the old trace, replace decisions and manifest."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.tools.recorded.divergences import divergence_lines
from skolem.tools.words.trace_account import account
from skolem.traces import Trace, check, compare
from skolem.traces.compare.diff import tolerance_for
from skolem.traces.compare.golden import (
    MAX_BYTES,
    Golden,
    golden_path,
    is_text,
    keep_decisions,
    read_manifest,
    write_manifest,
)
from skolem.traces.errors import Fault, InputError, TraceError
from skolem.traces.written import give_name


@dataclass(frozen=True, slots=True)
class Blessed:
    """The result of blessing one golden trace.

    Attributes:
        name: Name of the trace.
        golden: Its new description in the manifest.
        old: Its old description; None for a new trace.
        bytes: Size of the file.
        changed: Whether file and manifest were written.
        changes: The differences from the old trace, as lines; empty if there is no old trace.
    """

    name: str
    golden: Golden
    old: Golden | None
    bytes: int
    changed: bool
    changes: tuple[str, ...] = ()


def bless(folder: Path, name: str, recipe: Golden, reason: str) -> Blessed:
    """Run a golden trace's scenario, and keep its decisions and their description; an equal trace is not replaced.

    Args:
        folder: Folder of the golden traces and their manifest.
        name: Name of the trace.
        recipe: The scenario to run and the purpose; its fields about the result are replaced.
        reason: Why the trace may change.

    Raises:
        InputError: With every fault of the scenario, or if the manifest cannot hold the reason, or the trace would be
            too large.
    """
    if not is_text(reason):
        raise InputError([Fault("--reason", 0, 0, "is not text that a file can hold: it has bytes that are not UTF-8")])
    goldens = read_manifest(folder)
    with TemporaryDirectory(dir=folder) as work:
        full, lean = Path(work) / "full.mcap", Path(work) / "lean.mcap"
        setup = prepare(Path(recipe.scenario), recipe.overrides, recipe.seed, recipe.world)
        run(setup, full)
        keep_decisions(full, lean)
        made = _described(recipe, lean, reason)
        path, old, size = golden_path(folder, name), goldens.get(name), lean.stat().st_size
        if size >= MAX_BYTES:
            said = f"would take {size} bytes, allowed are {MAX_BYTES}; choose a shorter run"
            raise InputError([Fault(str(path), 0, 0, said)])
        if old is not None and _alike(old, made) and _up_to_date(path):
            return Blessed(name, old, old, path.stat().st_size, changed=False)
        changes = tuple(_difference(path, lean)) if path.exists() else ()
        give_name(lean, path)
    write_manifest(folder, goldens | {name: made})
    return Blessed(name, made, old, size, changed=True, changes=changes)


def _described(recipe: Golden, trace: Path, reason: str) -> Golden:
    """Return the manifest's description of a sound trace."""
    checked = check(trace)
    if checked.flaw is not None:
        raise TraceError(f"{trace}: {checked.flaw}")
    found = account(Trace(trace))
    assert found.end is not None, "a sound trace has an end"
    return recipe.model_copy(
        update={
            "reason": reason,
            "decision_hash": checked.decision_hash,
            "status": found.end.status,
            "steps": found.steps,
            "operators": tuple(sorted(found.planned)),
            "causes": tuple(sorted(found.causes)),
        }
    )


def _alike(old: Golden, made: Golden) -> bool:
    return old == made.model_copy(update={"reason": old.reason})


def _up_to_date(path: Path) -> bool:
    """Return whether a trace is sound and has the schemas of this version."""
    found = check(path)
    return found.sound and not found.remarks


def _difference(old: Path, new: Path) -> Iterator[str]:
    """Yield the differences of two traces: the first divergence, and how often each field differs."""
    try:
        comparison = compare(Trace(old), Trace(new), tolerance_for("equal machine"))
    except TraceError as error:
        yield f"the old one cannot be read: {error}"
        return
    yield from divergence_lines(comparison) or ["no message differs, but the schemas or the manifest do"]
