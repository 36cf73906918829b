"""Rows of a rerun recording, collected by entity and sent as columns: about a hundred times cheaper than one by one.

Every row stands on two timelines: `sim_time`, and `step`, the number of actions executed before. Rows during action k
belong to step k + 1, so that step k shows belief and truth at decision k.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import rerun as rr

from skolem.traces.messages import TICKS_PER_SECOND

STEP, SIM_TIME = "step", "sim_time"


@dataclass(frozen=True, slots=True)
class When:
    """A point on both timelines: simulated ticks since the start, and executed actions."""

    tick: int
    step: int


@dataclass(frozen=True, slots=True)
class _Values:
    """One component of several rows, concatenated."""

    array: pa.Array

    def as_arrow_array(self) -> pa.Array:
        """Return the values."""
        return self.array


class Rows:
    """Collects rows and sends them to a recording."""

    def __init__(self, stream: rr.RecordingStream) -> None:
        """Start without rows.

        Args:
            stream: The recording; no other code sends rows to the same entities.
        """
        self.stream = stream
        self._waiting: dict[str, list[tuple[When, dict[Any, pa.Array]]]] = defaultdict(list)

    def static(self, entity: str, *archetypes: rr.AsComponents) -> None:
        """Send components that do not depend on time."""
        self.stream.log(entity, *archetypes, static=True, strict=True)

    def add(self, entity: str, when: When, *archetypes: rr.AsComponents) -> None:
        """Add a row: the components of an entity from then on."""
        batches = [batch for archetype in archetypes for batch in archetype.as_component_batches()]
        self._waiting[entity].append((when, {b.component_descriptor(): b.as_arrow_array() for b in batches}))

    def flush(self) -> None:
        """Send all collected rows."""
        for entity, rows in self._waiting.items():
            names = dict.fromkeys(name for _, values in rows for name in values)
            columns = [_column(name, [values.get(name) for _, values in rows]) for name in names]
            self.send(entity, [when for when, _ in rows], columns)
        self._waiting.clear()

    def send(self, entity: str, whens: list[When], columns: Iterable[rr.ComponentColumn]) -> None:
        """Send columns at once, with one value for each point on the timelines."""
        seconds = [when.tick / TICKS_PER_SECOND for when in whens]
        index = [
            rr.TimeColumn(SIM_TIME, duration=seconds),
            rr.TimeColumn(STEP, sequence=[when.step for when in whens]),
        ]
        self.stream.send_columns(entity, indexes=index, columns=columns, strict=True)


def _column(name: Any, values: list[pa.Array | None]) -> rr.ComponentColumn:
    """Return one component of an entity's rows; it is empty in rows without it."""
    lengths = [0 if value is None else len(value) for value in values]
    present = pa.concat_arrays([value for value in values if value is not None])
    return rr.ComponentColumn(name, _Values(present), lengths=lengths)
