"""The options of a replay, the report of one trace, and its exit status."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

BAD_INPUT, BAD_TRACE, INTERNAL = 2, 3, 4
Status = Literal["identical", "diverged", "same", "changed", "bad_input", "unsound", "internal"]
EXIT: dict[Status, int] = {
    "identical": 0,
    "same": 0,
    "diverged": 1,
    "changed": 1,
    "bad_input": BAD_INPUT,
    "unsound": BAD_TRACE,
    "internal": INTERNAL,
}


@dataclass(frozen=True, slots=True)
class Wanted:
    """The options of `skolem replay`."""

    from_step: int
    re_anchor: bool
    plan_motions: bool
    atol: float | None
    rtol: float | None
    keep_all: bool
    rules: Path | None
    overrides: tuple[str, ...]

    @property
    def is_what_if(self) -> bool:
        """Whether the replay is a what-if."""
        return self.rules is not None or bool(self.overrides)


@dataclass(frozen=True, slots=True)
class Report:
    """The result of replaying one trace.

    Attributes:
        status: The result in one word.
        lines: The report for people.
        fields: The report for `--json`.
    """

    status: Status
    lines: list[str]
    fields: Mapping[str, object]
