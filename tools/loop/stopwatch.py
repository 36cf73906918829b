"""Wall time by part of the work; the only place where the product reads a clock."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

LOADING, SENSING, PHYSICS = "loading", "rendering_and_detection", "physics"
ESTIMATION, REASONING, MOTION_PLANNING = "estimation", "reasoning", "motion_planning"
RECORDING = "recording"
PARTS = (SENSING, ESTIMATION, REASONING, MOTION_PLANNING, PHYSICS, RECORDING, LOADING)


class Stopwatch:
    """Adds up the seconds spent in named parts; an inner part pauses the outer one."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        """Start with no time in any part.

        Args:
            clock: Seconds since any moment.
        """
        self._clock = clock
        self._begun = clock()
        self._since = self._begun
        self._open: list[str] = []
        self._seconds: dict[str, float] = {}

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Add the block's time to a part."""
        self._charge()
        self._open.append(name)
        try:
            yield
        finally:
            self._charge()
            self._open.pop()

    def seconds(self) -> dict[str, float]:
        """Return the seconds of each part, in order of first use."""
        self._charge()
        return dict(self._seconds)

    def total(self) -> float:
        """Return the seconds since the start, inside and outside parts."""
        return self._clock() - self._begun

    def _charge(self) -> None:
        now = self._clock()
        if self._open:
            self._seconds[self._open[-1]] = self._seconds.get(self._open[-1], 0.0) + now - self._since
        self._since = now
