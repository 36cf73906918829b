"""Reports of what-if replays: the changes in a run, in words."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from skolem.tools.recorded.rules import Overlay, Rulebooks, files_in
from skolem.tools.recorded.run import RecordedRun
from skolem.tools.replay.other_minds import changes_of, given_with
from skolem.tools.replay.reports import Report
from skolem.tools.replay.what_if import Foreseen, foresee

SHOWN = 200  # characters of a line


class WhatIf:
    """Applies the same changes to one run after another."""

    def __init__(self, folder: Path | None, overrides: Sequence[str]) -> None:
        """Read the changes.

        Args:
            folder: Folder with rule files that replace those of the same name, or are added; None: no other rules.
            overrides: Changed values `a.b=value` of the scenario, goal or threshold.

        Raises:
            InputError: If the folder has no rule files, or an override would change the recorded world.
        """
        self._changes = changes_of(files_in(folder) if folder else {}, overrides)
        self._rulebooks = Rulebooks(folder)

    def report(self, run: RecordedRun) -> Report:
        """Return the changes in a run.

        Raises:
            InputError: If the changed rules, goal or scenario are not sound.
        """
        foreseen = foresee(run, given_with(run, self._changes, self._rulebooks))
        rows = [asdict(altered) for altered in foreseen.altered]
        overlay = Overlay.of(run.attachments, self._changes.rules) if self._changes.rules else None
        fields = {
            "rules": None if overlay is None else asdict(overlay),
            "decisions": foreseen.decisions,
            "recorded": foreseen.recorded,
            "altered": rows,
            "stopped": foreseen.stopped,
            "planned_questions": foreseen.planned,
        }
        lines = [*_lines(foreseen), *([] if overlay is None else [str(overlay)])]
        return Report("changed" if rows else "same", lines, fields)


def _lines(foreseen: Foreseen) -> list[str]:
    if not foreseen.altered:
        return [f"same: {foreseen.decisions} decisions"]
    kinds = Counter(altered.kind for altered in foreseen.altered)
    counts = ", ".join(f"{count} in {kind}" for kind, count in kinds.items())
    lines = [f"CHANGED: {len(foreseen.altered)} of {foreseen.decisions} decisions ({counts})"]
    lines += [_short(str(altered)) for altered in foreseen.altered]
    if foreseen.stopped:
        rest = foreseen.recorded - foreseen.decisions
        lines.append(f"stopped: {foreseen.stopped}; {rest} more decisions were not taken")
    return lines


def _short(text: str) -> str:
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."
