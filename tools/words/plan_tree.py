"""Plans as text: of a whole run as a tree of plans, refinements and what was done; of one moment as a stack."""

from collections.abc import Iterable, Iterator
from itertools import groupby

from skolem.traces.messages import Action, Plan, PlanStep
from skolem.traces.messages.fluents import readable

_PLANNED = ("start", "refine")
DROPPED = ("preimage_lost", "refused")  # causes for which plans are given up


def tree_lines(plans: Iterable[Plan], actions: Iterable[Action]) -> list[str]:
    """Return one line per plan, executed action and drop, in order, indented by the layer of the plan stack.

    A plan's row is `[subgoal]` and its steps: `-op->` for an inference, `op @level/concrete` for what is carried out.
    An executed action is `(op)`.
    """
    merged: list[Plan | Action] = sorted([*plans, *actions], key=lambda item: (item.step, isinstance(item, Action)))
    lines: list[str] = []
    depth = 0
    for item in merged:
        if isinstance(item, Action):
            lines.append(f"{'  ' * depth}({item.op})")
            continue
        if item.cause in _PLANNED:
            lines.append(_row(item))
        elif item.cause in DROPPED:
            lines.append(f"{'  ' * len(item.layers)}{drop_line(item)}")
        depth = len(item.layers)
    return lines


def _row(plan: Plan) -> str:
    """Return the row of the plan that was made last: the lowest layer."""
    layer = plan.layers[-1]
    goal = " & ".join(readable(fluent) for fluent in layer[-1].subgoal)
    return f"{'  ' * (len(plan.layers) - 1)}[{goal}] {' ; '.join(_steps(layer))}"


def _steps(layer: Iterable[PlanStep]) -> Iterator[str]:
    for primitive, steps in groupby(layer, key=lambda step: step.primitive):
        for step in steps:
            yield f"{step.op} @{step.level}/{step.concrete}" if primitive else f"-{step.op}->"


def drop_line(plan: Plan) -> str:
    """Return why a plan was given up."""
    false = ", ".join(map(readable, plan.false_fluents))
    return f"dropped, no longer so: {false}" if plan.cause == "preimage_lost" else f"cannot be done here: {false}"


def plan_lines(plan: Plan) -> list[str]:
    """Return the plan stack, a line per layer, the chosen step of each in angle brackets."""
    return [
        f"{'  ' * depth}" + "  ".join(f"<{step.op}>" if i == chosen else step.op for i, step in enumerate(layer))
        for depth, (layer, chosen) in enumerate(zip(plan.layers, plan.current, strict=True))
    ]
