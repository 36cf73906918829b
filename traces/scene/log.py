"""What was decided, done and found in a rerun recording: one line each, in order."""

import math

import rerun as rr

from skolem.traces.messages import Action, ActionResult, Decision, Observation, Plan, RunEnd, Verdict
from skolem.traces.messages.fluents import readable
from skolem.traces.scene.rows import Rows, When

_REASONS = {"preimage_lost": "no longer so", "refused": "cannot be done here"}


class Log:
    """Writes the lines."""

    def __init__(self, rows: Rows) -> None:
        """Begin without lines."""
        self._rows = rows
        self._op = ""

    def decided(self, decision: Decision, when: When) -> None:
        """Tell what a search found."""
        goal = " & ".join(map(readable, decision.subgoal))
        if decision.plan:
            found = f"{' ; '.join(decision.plan)}  p {math.exp(-decision.cost / 1e6):.3f}"
        else:
            found = "no plan"
        self._say(when, "DEBUG", f"[{goal}] {found}  ({decision.expansions} expansions)")

    def planned(self, plan: Plan, when: When) -> None:
        """Tell why plans were dropped."""
        if plan.cause in _REASONS:
            false = ", ".join(map(readable, plan.false_fluents)) or "no step applies"
            self._say(when, "WARN", f"dropped, {_REASONS[plan.cause]}: {false}")

    def acted(self, action: Action, when: When) -> None:
        """Tell what is going to be done."""
        self._op = action.op
        self._say(when, "INFO", f"{action.step}: {action.op}")

    def resulted(self, result: ActionResult, when: When) -> None:
        """Tell an action that did not get done."""
        if result.status != "done":
            self._say(when, "WARN", f"{self._op}: {result.status.replace('_', ' ')}")

    def observed(self, observation: Observation, when: When) -> None:
        """Tell what the sensors said."""
        if observation.kind == "look":
            count = len(observation.detections)
            self._say(when, "INFO", f"{self._op}: {count or 'no'} detection{'' if count == 1 else 's'}")
        elif observation.wrench is not None:
            self._say(when, "INFO", f"{self._op}: {-observation.wrench.force_newton[2]:.2f} N")

    def ended(self, end: RunEnd, when: When) -> None:
        """Tell the end."""
        about = f" ({end.anchor}, p {end.goal_probability:.3f})" if end.anchor else ""
        level = "INFO" if end.status == "goal_achieved" else "ERROR"
        self._say(when, level, f"{end.status.replace('_', ' ')}{about}: {end.reason}")

    def judged(self, verdict: Verdict, when: When) -> None:
        """Tell whether the goal holds in the true world."""
        witness = f" ({verdict.witness})" if verdict.witness else ""
        self._say(when, "INFO", f"true in the simulator: {'yes' if verdict.true else 'no'}{witness}")

    def _say(self, when: When, level: str, text: str) -> None:
        self._rows.add("log", when, rr.TextLog(text, level=level))
