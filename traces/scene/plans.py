"""The plan stack in a rerun recording, laid out as a tree: a layer refines the marked step of the layer above.

Green: the step that is carried out next. White: the steps that it refines. Grey: later steps; blue: inferences among
these. Red, below: plans that were dropped in this step, with the reason.
"""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import rerun as rr

from skolem.traces.messages import DROPPED, Plan, PlanStep
from skolem.traces.scene.rows import Rows, When
from skolem.traces.wording.wording import Wording

_NEXT, _MARKED, _LATER, _INFERRED, _DROPPED, _LOST = (
    (90, 230, 90),
    (255, 255, 255),
    (150, 150, 150),
    (120, 160, 235),
    (240, 90, 80),
    (170, 95, 90),
)
_LETTER, _MARGIN, _GAP, _ROW = 6.6, 18.0, 14.0, 62.0  # in units of the view, which are points at its natural size
_LONGEST, _LONGEST_REASON = 24, 40  # most letters of a line in a box
_MOST_LINES = 6  # most lines of a reason
Rgb = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Node:
    """A box of the drawn tree.

    Attributes:
        id: Unique in the tree.
        label: A few lines.
        colour: Colour of box and text.
        parent: Its parent node; empty: none.
    """

    id: str
    label: str
    colour: Rgb
    parent: str = ""

    @property
    def width(self) -> float:
        """Width of the box."""
        return _LETTER * max(map(len, self.label.split("\n"))) + _MARGIN


class Plans:
    """Draws the plan stack whenever it changes."""

    def __init__(self, rows: Rows, goal: str, words: Wording) -> None:
        """Start with the goal alone.

        Args:
            rows: Rows of the recording.
            goal: The goal of the run.
            words: Words for operations and fluents.
        """
        self._rows, self._goal, self._words = rows, goal, words
        self._layers: tuple[tuple[PlanStep, ...], ...] = ()
        self._current: tuple[int, ...] = ()
        self._dropped: list[list[Node]] = []

    def step_begins(self, when: When) -> None:
        """Hide the dropped plans of the step before."""
        if self._dropped:
            self._dropped = []
            self._draw(when)

    def changed(self, plan: Plan, when: When) -> None:
        """Draw the present stack."""
        if plan.cause in DROPPED and len(plan.layers) < len(self._layers):
            self._dropped.append(self._what_was_dropped(plan))
        self._layers, self._current = plan.layers, plan.current
        self._draw(when)

    def _what_was_dropped(self, plan: Plan) -> list[Node]:
        """Return the reason and the uppermost dropped plan as a row of nodes."""
        kept, number = len(plan.layers), len(self._dropped)
        lines = textwrap.wrap(self._words.drop(plan), _LONGEST_REASON, break_long_words=False)
        more = [".."] if len(lines) > _MOST_LINES else []
        reason = "\n".join(["dropped:", *lines[:_MOST_LINES], *more])
        below = len(self._layers) - kept - 1
        steps = [
            Node(f"x{number}.{i}", in_lines(self._words.operation(step.op)), _LOST)
            for i, step in enumerate(self._layers[kept])
        ]
        rest = [Node(f"x{number}.rest", f"and what\nrefined it ({below})", _LOST)] if below else []
        return [Node(f"x{number}", reason, _DROPPED), *steps, *rest]

    def _draw(self, when: When) -> None:
        rows = [*tree(self._goal, self._layers, self._current, self._words), *self._dropped]
        nodes = [node for row in rows for node in row]
        self._rows.add(
            "plan",
            when,
            rr.GraphNodes(
                [node.id for node in nodes],
                positions=positions(rows),
                colors=[node.colour for node in nodes],
                labels=[node.label for node in nodes],
                show_labels=True,
            ),
            rr.GraphEdges([(node.parent, node.id) for node in nodes if node.parent], graph_type="directed"),
        )


def tree(goal: str, layers: Sequence[Sequence[PlanStep]], current: Sequence[int], words: Wording) -> list[list[Node]]:
    """Return the rows of the tree, the goal first; the parent of each row is the marked step of the row above."""
    rows = [[Node("goal", goal, _MARKED)]]
    parent = "goal"
    for depth, (layer, chosen) in enumerate(zip(layers, current, strict=True)):
        last = depth == len(layers) - 1
        row = []
        for i, step in enumerate(layer):
            colour = _INFERRED if not step.primitive else _LATER
            if i == chosen:
                colour = _NEXT if last else _MARKED
            row.append(Node(f"{depth}.{i}", in_lines(words.operation(step.op)), colour, parent))
        rows.append(row)
        parent = f"{depth}.{chosen}"
    return rows


def positions(rows: Sequence[Sequence[Node]]) -> list[tuple[float, float]]:
    """Return the middle of each node, row by row; rows are centred and nothing overlaps."""
    found: list[tuple[float, float]] = []
    y = 0.0
    for row in rows:
        x = -(sum(node.width for node in row) + _GAP * (len(row) - 1)) / 2.0
        for node in row:
            found.append((x + node.width / 2.0, y))
            x += node.width + _GAP
        y += _ROW
    return found


def in_lines(text: str) -> str:
    """Return a text in short lines, broken between words."""
    return "\n".join(textwrap.wrap(text, _LONGEST, break_long_words=False, break_on_hyphens=False))
