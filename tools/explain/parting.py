"""Whether this version of the product thinks as the robot did: an explanation is only as true as that."""

from collections.abc import Iterator
from pathlib import Path

from skolem.tools.recorded.replaying import Options, replay
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun, RecordedStep
from skolem.traces.compare.diff import tolerance_for


def parting(trace: Path, step: int, rulebooks: Rulebooks) -> int | None:
    """Return the first decision, up to `step`, that is thought otherwise than it is recorded; None if none is.

    Last digits of floats do not count, as between two machines.
    """
    replayed = replay(_Beginning(trace, step), Options(tolerance_for("other machine")), rulebooks=rulebooks)
    return next((divergence.step for divergence in replayed.comparison.divergences), None)


class _Beginning(RecordedRun):
    """A recorded run, up to one decision."""

    def __init__(self, path: Path, until: int) -> None:
        super().__init__(path)
        self._until = until

    def steps(self) -> Iterator[RecordedStep]:
        for recorded in super().steps():
            yield recorded
            if recorded.step >= self._until:
                return
