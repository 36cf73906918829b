"""The log of a run in a rerun recording: one line for each decision, action and result, in order."""

import math

import rerun as rr

from skolem.traces.messages import DROPPED, Action, ActionResult, Decision, Observation, Plan, RunEnd, Verdict
from skolem.traces.scene.rows import Rows, When
from skolem.traces.wording.verdicts import displaced_text
from skolem.traces.wording.wording import AS_RECORDED, Wording


class Log:
    """Writes the lines.

    Attributes:
        words: Words for operations and fluents.
    """

    def __init__(self, rows: Rows) -> None:
        """Start without lines."""
        self._rows = rows
        self._op = ""
        self.words: Wording = AS_RECORDED

    def decided(self, decision: Decision, when: When) -> None:
        """Write the result of a search."""
        steps = "; ".join(map(self.words.operation, decision.plan))
        found = f"{steps}  (p {math.exp(-decision.cost / 1e6):.3f})" if steps else "none found"
        self._say(when, "DEBUG", f"plan for {self.words.aim(decision.subgoal)}: {found}")

    def planned(self, plan: Plan, when: When) -> None:
        """Write why plans were dropped."""
        if plan.cause in DROPPED:
            self._say(when, "WARN", f"plan dropped: {self.words.drop(plan)}")

    def acted(self, action: Action, when: When) -> None:
        """Write the next action."""
        self._op = self.words.operation(action.op)
        self._say(when, "INFO", f"{action.step}: {self._op}")

    def resulted(self, result: ActionResult, when: When) -> None:
        """Write that an action failed."""
        if result.status != "done":
            self._say(when, "WARN", f"{self._op}: {result.status.replace('_', ' ')}")

    def observed(self, observation: Observation, when: When) -> None:
        """Write the observation."""
        if observation.kind == "look":
            count = len(observation.detections)
            self._say(when, "INFO", f"{self._op}: {count or 'no'} detection{'' if count == 1 else 's'}")
        elif observation.wrench is not None:
            self._say(when, "INFO", f"{self._op}: {-observation.wrench.force_newton[2]:.2f} N")

    def ended(self, end: RunEnd, when: When) -> None:
        """Write the end of the run."""
        about = f" ({end.anchor}, p {end.goal_probability:.3f})" if end.anchor else ""
        level = "INFO" if end.status == "goal_achieved" else "ERROR"
        self._say(when, level, f"{self.words.end(end)}{about}")

    def judged(self, verdict: Verdict, when: When) -> None:
        """Write whether the goal holds in the true world."""
        witness = f" ({verdict.witness})" if verdict.witness else ""
        self._say(when, "INFO", f"true in the simulator: {'yes' if verdict.true else 'no'}{witness}")
        if verdict.displaced:
            self._say(when, "WARN", f"displaced without intent: {displaced_text(verdict.displaced)}")

    def _say(self, when: When, level: str, text: str) -> None:
        self._rows.add("log", when, rr.TextLog(text, level=level))
