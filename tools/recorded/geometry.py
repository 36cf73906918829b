"""Geometric answers from a trace, without a planner: the same questions about the same beliefs."""

from collections.abc import Callable, Iterable

from skolem.tools.loop.recorded_geometry import Asked, question
from skolem.tools.loop.worlds import Planner
from skolem.traces.errors import NotRecordedError
from skolem.traces.messages import Activity, Belief, Command, Geometry, MoveBase


class RecalledGeometry:
    """Answers geometric questions from the trace; a planner, if given, answers those that are not recorded.

    Attributes:
        unanswered: The question for which `NotRecordedError` was raised; None if it was not raised.
        planned: Number of questions that the planner answered.
    """

    def __init__(
        self, planner: Callable[[], Planner] | None = None, recall: bool = True, suppose_room: bool = False
    ) -> None:
        """Start without recorded answers.

        Args:
            planner: Makes the planner at the first question that the trace does not answer; None: such a question
                raises `NotRecordedError`.
            recall: Whether recorded answers are used at all.
            suppose_room: Whether a support has room for an object if the run did not ask.
        """
        self._make, self._recall, self._suppose_room = planner, recall, suppose_room
        self.unanswered: str | None = None
        self.planned = 0
        self._planner: Planner | None = None
        self._synced = False
        self._belief: Belief | None = None
        self._known: dict[str, Geometry] = {}

    def take(self, answers: Iterable[Geometry]) -> None:
        """Keep the recorded answers about the next belief."""
        self._known = {answer.query: answer for answer in answers} if self._recall else {}

    def sync(self, belief: Belief) -> None:
        """Keep the belief that the next questions are about."""
        self._belief, self._synced = belief, False

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does `activity` from here, or None."""
        known = self._known.get(question("ready", activity))
        return self._ask("ready", activity).ready(activity) if known is None else known.answer

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a drive to where `activity` can be done, or None."""
        known = self._known.get(question("approach", activity))
        if known is None:
            return self._ask("approach", activity).approach(activity)
        return known.answer if isinstance(known.answer, MoveBase) else None

    def tried(self, activity: Activity) -> int:
        """Return after how many stances the search of a drive was given up; 0 if it showed that there is none."""
        known = self._known.get(question("approach", activity))
        return self._ask("approach", activity).tried(activity) if known is None else known.tried

    def blockers(self, activity: Activity) -> tuple[str, ...] | None:
        """Return the objects that block `activity`; None if there is no room for it."""
        known = self._known.get(question("blockers", activity))
        if known is None and self._suppose_room and activity.kind == "place":
            return ()
        return self._ask("blockers", activity).blockers(activity) if known is None else known.blockers

    def close(self) -> None:
        """Close the planner, if one was made."""
        if self._planner is not None:
            self._planner.close()

    def _ask(self, kind: Asked, activity: Activity) -> Planner:
        """Return the planner, which knows the present belief."""
        if self._make is None:
            self.unanswered = question(kind, activity)
            raise NotRecordedError(f"the trace has no answer to: {self.unanswered}")
        self._planner = self._planner or self._make()
        if not self._synced:
            assert self._belief is not None, "sync comes first"
            self._planner.sync(self._belief)
            self._synced = True
        self.planned += 1
        return self._planner
