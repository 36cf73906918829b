"""The progress of a run: a live picture on a terminal, otherwise a line for each executed action.

The picture has the paper's belief table, the plan stack, and the progress of the run.
"""

import colorsys
import math
import re
import sys
from collections.abc import Mapping
from types import TracebackType
from typing import Self

from rich.box import SIMPLE_HEAD
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.markup import escape
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from skolem.reasoner import Turn
from skolem.tools.loop.setup import Setup
from skolem.tools.words.belief_table import COLUMNS, belief_rows
from skolem.tools.words.plan_tree import plan_lines
from skolem.tools.words.printable import printable
from skolem.tools.words.terminal import output
from skolem.traces.messages import (
    DROPPED,
    TICKS_PER_SECOND,
    Action,
    ActionResult,
    Belief,
    Decision,
    HsvBelief,
    Meaning,
    Observation,
    Plan,
)
from skolem.traces.wording.of_run import wording
from skolem.traces.wording.wording import AS_RECORDED, Wording

UNSURE = 0.5  # anchors less likely to exist are shown dim
WIDEST = 100  # largest width of a table, also on a wider terminal
NARROW = 80  # columns; on a narrower terminal every cell may be wrapped
LEAST_ROWS = 3  # fewest rows of the belief table, also on a terminal with few lines
_FRAME_LINES = 4  # lines of a table around its rows: title, heads and borders


def wording_for(setup: Setup, raw: bool) -> Wording:
    """Return the wording for a new run; with `raw` it shows terms as recorded."""
    vocabulary = setup.rulebook.vocabulary
    return wording(setup.scenario.goal, vocabulary.types, vocabulary.meanings, raw)


def drop_text(plans: list[Plan], words: Wording) -> str:
    """Return why plans were dropped in a turn; empty if none was."""
    return next((words.drop(plan) for plan in plans if plan.cause in DROPPED), "")


def observed_text(observation: Observation) -> str:
    """Return an observation in a few words."""
    if observation.kind == "look":
        count = len(observation.detections)
        return f"{count or 'no'} detection{'' if count == 1 else 's'}"
    if observation.wrench is not None:
        return f"{-observation.wrench.force_newton[2]:.2f} N"
    return ""


class Lines:
    """Prints one line on standard error for each executed action."""

    def __init__(self, words: Wording = AS_RECORDED) -> None:
        """Start before the first decision.

        Args:
            words: Words for operations and fluents.
        """
        self._words = words
        self._dropped = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Do nothing."""

    def believed(self, belief: Belief, tick: int) -> None:
        """Print nothing."""

    def decided(self, turn: Turn) -> None:
        """Remember why plans were dropped, for the line of the next action."""
        self._dropped = drop_text(turn.plans, self._words)

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Print the action and its result."""
        done = f"{self._words.operation(action.op)} -> {result.status.replace('_', ' ')}"
        parts = [f"step {action.step:2d}  {done}", observed_text(observation)]
        line = ", ".join(part for part in parts if part)
        output(line + (f"  [new plan: {self._dropped}]" if self._dropped else ""), file=sys.stderr, flush=True)


class Quiet(Lines):
    """Prints nothing."""

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Print nothing."""


class Picture(Lines):
    """Shows a live picture on a terminal."""

    def __init__(self, setup: Setup, console: Console, words: Wording) -> None:
        """Prepare an empty picture.

        Args:
            setup: Gives goal, limits and the names of colours.
            console: The terminal.
            words: Words for operations and fluents.
        """
        super().__init__(words)
        self._setup, self._console = setup, console
        self._meanings = setup.rulebook.vocabulary.meanings
        self._belief: Belief | None = None
        self._plan: Plan | None = None
        self._decision: Decision | None = None
        self._tick = 0
        self._now = "starting"
        # refreshed by hand: a separate thread would draw while the physics engine keeps standard error closed
        self._live = Live(console=console, auto_refresh=False, transient=False)

    def __enter__(self) -> Self:
        self._live.start()
        self._draw()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._draw()
        self._live.stop()

    def believed(self, belief: Belief, tick: int) -> None:
        """Show a belief."""
        self._belief, self._tick, self._now = belief, tick, "deciding"
        self._draw()

    def decided(self, turn: Turn) -> None:
        """Show the plan stack and the next action."""
        super().decided(turn)
        self._plan = turn.plans[-1] if turn.plans else self._plan
        self._decision = turn.decisions[-1] if turn.decisions else self._decision
        if turn.action is not None:
            self._now = f"now: {self._words.operation(turn.action.op)}"
        elif turn.end is not None:
            self._now = self._words.end(turn.end)
        self._draw()

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Show the result of the action."""
        said = observed_text(observation)
        done = f"{self._words.operation(action.op)} -> {result.status.replace('_', ' ')}"
        self._now = f"{done}{', ' + said if said else ''}"
        self._draw()

    def _draw(self) -> None:
        self._live.update(self.picture(), refresh=True)

    def picture(self) -> RenderableType:
        """Return the present picture; it fits the terminal."""
        below: list[RenderableType] = []
        if self._plan is not None and self._plan.layers:
            below.append(Text("plan stack, from the goal down to the next step", style="bold"))
            below += [_in_one_line(_marked(line)) for line in plan_lines(self._plan, self._words)]
        if self._dropped:
            below.append(Text(printable(f"new plan: {self._dropped}"), style="yellow"))
        below.append(self._progress())
        goal = Text(printable(f"goal  {self._setup.scenario.goal}"), style="bold")
        if self._belief is None:
            return Group(goal, *below)
        room = self._console.height - 1 - sum(map(self._height, (goal, *below)))
        return Group(goal, self._table(self._belief, room), *below)

    def _table(self, belief: Belief, room: int) -> Table:
        """Return the belief as a table of at most `room` lines; it has at least `LEAST_ROWS` rows, even if too long."""
        width = min(self._console.width, WIDEST)
        rows = max(LEAST_ROWS, min(len(belief.anchors), room - _FRAME_LINES))
        table = belief_table(belief, self._meanings, width, rows, self._steps())
        while rows > LEAST_ROWS and self._height(table) > room:  # a cell may take several lines
            rows -= 1
            table = belief_table(belief, self._meanings, width, rows, self._steps())
        return table

    def _height(self, part: RenderableType) -> int:
        return len(self._console.render_lines(part, pad=False))

    def _steps(self) -> str:
        """Return all steps of the plan stack as text: the objects in it are shown before others."""
        return " ".join(step.op for layer in (self._plan.layers if self._plan else ()) for step in layer)

    def _progress(self) -> RenderableType:
        """Return the present action, and below it the step, a bar towards the limit of steps, and the plan's p."""
        step, limit = (self._belief.step if self._belief else 0), self._setup.scenario.limits.steps
        grid = Table.grid(padding=(0, 1))
        chance = "" if self._decision is None or not self._decision.plan else _probability(self._decision)
        grid.add_row(
            f"step {step} of at most {limit}",
            ProgressBar(total=limit, completed=step, width=16),
            f"{self._tick / TICKS_PER_SECOND:.1f} s simulated",
            chance,
        )
        return Group(Text(printable(self._now)), grid)


def belief_table(belief: Belief, meanings: Mapping[str, Meaning], width: int, most: int, first: str) -> Table:
    """Return the belief as a table.

    Args:
        belief: The belief.
        meanings: Meanings of the words.
        width: Largest width in columns.
        most: Largest number of rows below the heads; the last row counts the objects that are left out.
        first: A text; the objects that it names are shown before others.
    """
    table = Table(title=f"belief at step {belief.step}", title_justify="left", box=SIMPLE_HEAD, width=width)
    for column in COLUMNS:  # without room for all columns, colours are wrapped first
        table.add_column(column, no_wrap=width >= NARROW and not column.startswith("color"))
    rows = belief_rows(belief, meanings)
    kept = rows if len(rows) <= most else _most_wanted(rows, most - 1, first)
    for row in kept:
        known = belief.objects[row[0]]
        cells: list[RenderableType] = [Text(printable(cell)) for cell in row]
        if known.colour_seen:
            cells[3] = _swatch(printable(row[3]), known.colour)
        table.add_row(*cells, style="dim" if known.exists < UNSURE else None)
    if len(kept) < len(rows):
        table.add_row(f"({len(rows) - len(kept)} more)", style="dim")
    return table


def _most_wanted(rows: list[tuple[str, ...]], most: int, first: str) -> list[tuple[str, ...]]:
    """Return at most `most` rows in their order: those of objects that a text names, then the first others."""
    named = set(re.findall(r"\w+", first))
    kept = sorted(range(len(rows)), key=lambda i: (rows[i][0] not in named, i))[:most]
    return [rows[i] for i in sorted(kept)]


def _in_one_line(markup: str) -> Text:
    """Return a line that is cut with an ellipsis at the edge of the terminal."""
    text = Text.from_markup(markup, overflow="ellipsis")
    text.no_wrap = True
    return text


def _swatch(text: str, colour: HsvBelief) -> Text:
    """Return a cell's text behind a square of the believed colour."""
    return Text.assemble(("\u25a0 ", _hex(colour)), text)


def _hex(colour: HsvBelief) -> str:
    h, s, v = colour.mean
    r, g, b = colorsys.hsv_to_rgb(h % 1.0, min(1.0, max(0.0, s)), min(1.0, max(0.0, v)))
    return f"#{round(255 * r):02x}{round(255 * g):02x}{round(255 * b):02x}"


def _marked(line: str) -> str:
    """Return a plan line with the chosen step in bold instead of brackets."""
    return escape(printable(line)).replace("<", "[bold cyan]").replace(">", "[/]")


def _probability(decision: Decision) -> str:
    return f"plan p = {math.exp(-decision.cost / 1e6):.3f}"


def watcher_for(setup: Setup, quiet: bool, raw: bool = False) -> "Lines":
    """Return the display of a run: none, a picture on a terminal, or lines."""
    if quiet:
        return Quiet()
    console, words = Console(stderr=True), wording_for(setup, raw)
    return Picture(setup, console, words) if console.is_terminal else Lines(words)
