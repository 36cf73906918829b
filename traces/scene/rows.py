"""Rows of a rerun recording, gathered by entity and sent as columns: about a hundred times cheaper than one by one.

Every row stands on two timelines: `sim_time`, and `step`, the number of actions executed before. What happens while
action k is carried out belongs to step k + 1, so that step k shows what was known and true at decision k.
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
    """A place on both timelines: simulated ticks since the start, and executed actions."""

    tick: int
    step: int


@dataclass(frozen=True, slots=True)
class _Values:
    """One component of several rows, end to end."""

    array: pa.Array

    def as_arrow_array(self) -> pa.Array:
        """Return the values."""
        return self.array


class Rows:
    """Rows that wait to be sent to a recording."""

    def __init__(self, stream: rr.RecordingStream) -> None:
        """Begin without any.

        Args:
            stream: The recording; nobody else sends rows to the same entities.
        """
        self.stream = stream
        self._waiting: dict[str, list[tuple[When, dict[Any, pa.Array]]]] = defaultdict(list)

    def static(self, entity: str, *archetypes: rr.AsComponents) -> None:
        """Send what holds at all times."""
        self.stream.log(entity, *archetypes, static=True, strict=True)

    def add(self, entity: str, when: When, *archetypes: rr.AsComponents) -> None:
        """Let a row wait: what the entity is from then on."""
        batches = [batch for archetype in archetypes for batch in archetype.as_component_batches()]
        self._waiting[entity].append((when, {b.component_descriptor(): b.as_arrow_array() for b in batches}))

    def flush(self) -> None:
        """Send all rows that wait."""
        for entity, rows in self._waiting.items():
            names = dict.fromkeys(name for _, values in rows for name in values)
            columns = [_column(name, [values.get(name) for _, values in rows]) for name in names]
            self.send(entity, [when for when, _ in rows], columns)
        self._waiting.clear()

    def send(self, entity: str, whens: list[When], columns: Iterable[rr.ComponentColumn]) -> None:
        """Send columns at once, one value per place on the timelines."""
        seconds = [when.tick / TICKS_PER_SECOND for when in whens]
        index = [
            rr.TimeColumn(SIM_TIME, duration=seconds),
            rr.TimeColumn(STEP, sequence=[when.step for when in whens]),
        ]
        self.stream.send_columns(entity, indexes=index, columns=columns, strict=True)


def _column(name: Any, values: list[pa.Array | None]) -> rr.ComponentColumn:
    """Return one component of an entity's rows; a row without it has none of it."""
    lengths = [0 if value is None else len(value) for value in values]
    present = pa.concat_arrays([value for value in values if value is not None])
    return rr.ComponentColumn(name, _Values(present), lengths=lengths)
