"""A geometry that records and times every question to the planner, with its answer."""

from collections.abc import Callable
from typing import Literal

from skolem.reasoner import Geometry
from skolem.tools.loop.stopwatch import MOTION_PLANNING, Stopwatch
from skolem.traces import messages
from skolem.traces.messages import Activity, Command

Asked = Literal["ready", "approach", "blockers"]


def question(kind: Asked, activity: Activity) -> str:
    """Return the text of a question, as the trace records it."""
    return f"{kind} {activity}"


class RecordedGeometry:
    """Passes geometric questions on, and records each with its answer."""

    def __init__(self, geometry: Geometry, write: Callable[[str, messages.Message], None], watch: Stopwatch) -> None:
        """Stand between the reasoner and `geometry`."""
        self._geometry, self._write, self._watch = geometry, write, watch
        self._step, self._version = 0, 0

    def sync(self, belief: messages.Belief) -> None:
        """Pass on the belief that the next questions are about."""
        self._step, self._version = belief.step, belief.version
        with self._watch.part(MOTION_PLANNING):
            self._geometry.sync(belief)

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from here, or None."""
        with self._watch.part(MOTION_PLANNING):
            answer = self._geometry.ready(activity)
        self._log(question("ready", activity), answer)
        return answer

    def approach(self, activity: Activity) -> messages.MoveBase | None:
        """Return a drive to where `activity` can be done, or None."""
        with self._watch.part(MOTION_PLANNING):
            answer = self._geometry.approach(activity)
            tried = 0 if answer is not None else self._geometry.tried(activity)
        self._log(question("approach", activity), answer, tried=tried)
        return answer

    def tried(self, activity: Activity) -> int:
        """Return after how many stances the search of a drive was given up; the record of the drive has it."""
        with self._watch.part(MOTION_PLANNING):
            return self._geometry.tried(activity)

    def blockers(self, activity: Activity) -> tuple[str, ...] | None:
        """Return the objects that block `activity`; None if there is no room for it."""
        with self._watch.part(MOTION_PLANNING):
            found = self._geometry.blockers(activity)
        self._log(question("blockers", activity), blockers=found)
        return found

    def _log(
        self, query: str, answer: Command | None = None, blockers: tuple[str, ...] | None = None, tried: int = 0
    ) -> None:
        asked = messages.Geometry(
            step=self._step,
            query=query,
            belief_version=self._version,
            answer=answer,
            blockers=blockers,
            tried=tried,
        )
        self._write("/geometry", asked)
