"""What a person sees while the robot works: on a terminal a live picture, otherwise a line per executed action.

The picture has the paper's belief table, the plan stack, and how far the run has come.
"""

import colorsys
import errno
import math
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType
from typing import Self

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.markup import escape
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from skolem.reasoner import Turn
from skolem.tools.loop.session import DROPPED
from skolem.tools.loop.setup import Setup
from skolem.tools.words.belief_table import COLUMNS, belief_rows
from skolem.tools.words.plan_tree import plan_lines
from skolem.traces.messages import (
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
from skolem.traces.messages.fluents import readable

UNSURE = 0.5  # anchors less likely to exist are shown dim
WIDTH = 100


def drop_text(plans: list[Plan]) -> str:
    """Return why plans were dropped in a turn, or nothing."""
    dropped = [plan for plan in plans if plan.cause in DROPPED]
    if not dropped:
        return ""
    first = dropped[0]
    return f"{first.cause.replace('_', ' ')}: {', '.join(map(readable, first.false_fluents)) or 'no step applies'}"


def observed_text(observation: Observation) -> str:
    """Return what the sensors said, in a few words."""
    if observation.kind == "look":
        count = len(observation.detections)
        return f"{count or 'no'} detection{'' if count == 1 else 's'}"
    if observation.wrench is not None:
        return f"{-observation.wrench.force_newton[2]:.2f} N"
    return ""


@contextmanager
def terminal_may_go() -> Iterator[None]:
    """Let the block write to a terminal that somebody has closed: a signal says so, and ends the run in good order."""
    try:
        yield
    except OSError as error:
        if error.errno != errno.EIO:
            raise


class Lines:
    """One line on standard error per executed action."""

    def __init__(self) -> None:
        """Nothing has been seen yet."""
        self._dropped = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Nothing to put back."""

    def believed(self, belief: Belief, tick: int) -> None:
        """Say nothing."""

    def decided(self, turn: Turn) -> None:
        """Remember why plans were dropped, for the line of the action that follows."""
        self._dropped = drop_text(turn.plans)

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Print the action and what came of it."""
        parts = [f"step {action.step:2d}  {action.op} -> {result.status}", observed_text(observation)]
        line = ", ".join(part for part in parts if part)
        with terminal_may_go():
            print(line + (f"  [after {self._dropped}]" if self._dropped else ""), file=sys.stderr, flush=True)


class Silence(Lines):
    """Nothing at all."""

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Say nothing."""


class Picture(Lines):
    """A live picture on a terminal."""

    def __init__(self, setup: Setup, console: Console) -> None:
        """Prepare an empty picture.

        Args:
            setup: Gives goal, limits and the names of colours.
            console: The terminal.
        """
        super().__init__()
        self._setup = setup
        self._meanings = setup.rulebook.vocabulary.meanings
        self._belief: Belief | None = None
        self._plan: Plan | None = None
        self._decision: Decision | None = None
        self._tick = 0
        self._now = "starting"
        # refreshed by hand: a thread of its own would draw while the physics engine keeps standard error closed
        self._live = Live(console=console, auto_refresh=False, transient=False)

    def __enter__(self) -> Self:
        self._live.start()
        self._draw()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._draw()
        with terminal_may_go():
            self._live.stop()

    def believed(self, belief: Belief, tick: int) -> None:
        """Show a belief."""
        self._belief, self._tick, self._now = belief, tick, "deciding"
        self._draw()

    def decided(self, turn: Turn) -> None:
        """Show the plan stack and the action to come."""
        super().decided(turn)
        self._plan = turn.plans[-1] if turn.plans else self._plan
        self._decision = turn.decisions[-1] if turn.decisions else self._decision
        if turn.action is not None:
            self._now = f"executing {turn.action.op}"
        elif turn.end is not None:
            self._now = turn.end.reason
        self._draw()

    def acted(self, action: Action, result: ActionResult, observation: Observation) -> None:
        """Show what became of the action."""
        said = observed_text(observation)
        self._now = f"{action.op} {result.status}{', ' + said if said else ''}"
        self._draw()

    def _draw(self) -> None:
        with terminal_may_go():
            self._live.update(self.picture(), refresh=True)

    def picture(self) -> RenderableType:
        """Return the whole picture as it stands."""
        parts: list[RenderableType] = [Text(f"goal  {self._setup.scenario.goal}", style="bold")]
        if self._belief is not None:
            parts.append(belief_table(self._belief, self._meanings))
        if self._plan is not None and self._plan.layers:
            parts.append(Text("plan stack", style="bold"))
            parts += [Text.from_markup(_marked(line), overflow="ellipsis") for line in plan_lines(self._plan)]
        if self._dropped:
            parts.append(Text(f"dropped plans: {self._dropped}", style="yellow", overflow="ellipsis"))
        parts.append(self._progress())
        return Group(*parts)

    def _progress(self) -> RenderableType:
        """Return the step, the bar towards the limit of steps, what is going on, and the present plan's probability."""
        step, limit = (self._belief.step if self._belief else 0), self._setup.scenario.limits.steps
        grid = Table.grid(padding=(0, 1))
        chance = "" if self._decision is None or not self._decision.plan else _probability(self._decision)
        grid.add_row(
            f"step {step} of at most {limit}",
            ProgressBar(total=limit, completed=step, width=16),
            Text(self._now, overflow="ellipsis"),
            chance,
            f"{self._tick / TICKS_PER_SECOND:.1f} s simulated",
        )
        return grid


def belief_table(belief: Belief, meanings: Mapping[str, Meaning]) -> Table:
    """Return the belief as a table."""
    table = Table(*COLUMNS, width=WIDTH, title=f"belief at step {belief.step}", title_justify="left")
    for row in belief_rows(belief, meanings):
        known = belief.objects[row[0]]
        cells: list[RenderableType] = [*row]
        if known.colour_seen:
            cells[3] = _swatch(row[3], known.colour)
        table.add_row(*cells, style="dim" if known.exists < UNSURE else None)
    return table


def _swatch(text: str, colour: HsvBelief) -> Text:
    """Return a cell's text behind a square of the believed colour."""
    return Text.assemble(("\u25a0 ", _hex(colour)), text)


def _hex(colour: HsvBelief) -> str:
    h, s, v = colour.mean
    r, g, b = colorsys.hsv_to_rgb(h % 1.0, min(1.0, max(0.0, s)), min(1.0, max(0.0, v)))
    return f"#{round(255 * r):02x}{round(255 * g):02x}{round(255 * b):02x}"


def _marked(line: str) -> str:
    """Return a plan line with the chosen step in bold instead of brackets."""
    return escape(line).replace("<", "[bold cyan]").replace(">", "[/]")


def _probability(decision: Decision) -> str:
    return f"plan p = {math.exp(-decision.cost / 1e6):.3f}"


def watcher_for(setup: Setup, quiet: bool) -> "Lines":
    """Return who watches: nobody, a picture on a terminal, or lines."""
    if quiet:
        return Silence()
    console = Console(stderr=True)
    return Picture(setup, console) if console.is_terminal else Lines()
