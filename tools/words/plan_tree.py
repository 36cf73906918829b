"""Plans as text: a tree of plans, refinements and actions for a whole run, and the stack at one moment."""

from collections.abc import Iterable, Iterator

from skolem.traces.messages import DROPPED, Action, Plan, PlanStep
from skolem.traces.wording.wording import Wording

_PLANNED = ("start", "refine")
LEGEND = (
    "An indented plan works out one step of the plan above it; at `level 2 of 2` a step is worked out in full. A step "
    "in [brackets] is a conclusion, no action."
)


def tree_lines(plans: Iterable[Plan], actions: Iterable[Action], words: Wording) -> list[str]:
    """Return one line for each plan, executed action and drop, in order, indented by the layer of the plan stack.

    As recorded, a plan's row is `[subgoal]` and its steps: `-op->` for an inference, `op @level/concrete` for an
    operator; an executed action is `(op)`. In words, a row names these kinds.
    """
    merged: list[Plan | Action] = sorted([*plans, *actions], key=lambda item: (item.step, isinstance(item, Action)))
    lines: list[str] = []
    depth = 0
    for item in merged:
        if isinstance(item, Action):
            op = words.operation(item.op)
            lines.append(f"{'  ' * depth}{f'done: {op}' if words.in_words else f'({op})'}")
            continue
        if item.cause in _PLANNED:
            lines.append(_row(item, words))
        elif item.cause in DROPPED:
            lines.append(f"{'  ' * len(item.layers)}{drop_line(item, words)}")
        depth = len(item.layers)
    return lines


def _row(plan: Plan, words: Wording) -> str:
    """Return the row of the latest plan, which is the lowest layer."""
    layer = plan.layers[-1]
    indent, aim = "  " * (len(plan.layers) - 1), words.aim(layer[-1].subgoal)
    if words.in_words:
        return f"{indent}plan for {aim}: {'; '.join(_said(layer, words))}"
    return f"{indent}[{aim}] {' ; '.join(_steps(layer))}"


def _said(layer: Iterable[PlanStep], words: Wording) -> Iterator[str]:
    for step in layer:
        op = words.operation(step.op)
        yield f"{op} (level {step.level} of {step.concrete})" if step.primitive else f"[{op}]"


def _steps(layer: Iterable[PlanStep]) -> Iterator[str]:
    for step in layer:
        yield f"{step.op} @{step.level}/{step.concrete}" if step.primitive else f"-{step.op}->"


def drop_line(plan: Plan, words: Wording) -> str:
    """Return why a plan was given up."""
    return f"plan dropped: {words.drop(plan)}" if words.in_words else f"dropped: {words.drop(plan)}"


def plan_lines(plan: Plan, words: Wording) -> list[str]:
    """Return the plan stack, one line for each layer, with the chosen step in angle brackets."""
    between = "; " if words.in_words else "  "
    return [
        f"{'  ' * depth}" + between.join(f"<{op}>" if i == chosen else op for i, op in enumerate(ops))
        for depth, (ops, chosen) in enumerate(
            ([words.operation(step.op) for step in layer], chosen)
            for layer, chosen in zip(plan.layers, plan.current, strict=True)
        )
    ]
