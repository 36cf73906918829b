"""Comparison of the reasoner with classical planners on the same problems: time, cost, and chosen object or region."""

import os
import re
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from benchmarks import pddl
from benchmarks.agents import Thinking, first_action, whole_run
from benchmarks.problems import State, problem
from benchmarks.tables import Table, Target
from skolem.reasoner.planning.queries import load_rules
from skolem.reasoner.rulebook.book import Rulebook

SIZES = (3, 10, 30, 100, 300)
LIMIT_S = 22  # wall time for each call of a peer; most of the benchmark's time is spent on calls that reach it
REPEATS = 3
_PLAN = re.compile(r"^(?:\[.*\] )?Plan cost: (\d+)", re.MULTILINE)
_CHOICE = re.compile(r"\((examine|find) ([^\s()]+)(?: ([^\s()]+))?")


@dataclass(frozen=True, slots=True)
class Peer:
    """A planner and its command.

    Attributes:
        name: Its name in the results.
        command: The words before the files.
        search: The words after the files.
        costs: Whether it supports costs.
    """

    name: str
    command: tuple[str, ...]
    search: tuple[str, ...] = ()
    costs: bool = True


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of a peer on a problem.

    Attributes:
        cpu_s: CPU time of the process and its children; None if there is no plan.
        cost: Cost of the plan, in the unit of the problem; None if the planner does not support costs.
        choice: The object that the plan examines last, or the region in which it finds it.
        timed_out: Whether it was stopped at the time limit.
        why: Its message if it failed otherwise.
    """

    cpu_s: float | None = None
    cost: int | None = None
    choice: str = ""
    timed_out: bool = False
    why: str = ""

    def __str__(self) -> str:
        if self.timed_out:
            return f"> {LIMIT_S}"
        return f"failed: {self.why}" if self.cpu_s is None else f"{self.cpu_s:.2f}"

    def slower_than(self, seconds: float) -> bool:
        """Return whether it took longer or reached the time limit; a peer that failed otherwise does not count."""
        return seconds < (LIMIT_S if self.timed_out else self.cpu_s or 0.0)


def peers() -> tuple[Peer, ...]:
    """Return the planners of the comparison; Fast Downward's times include its translation."""
    spec = find_spec("up_fast_downward")
    assert spec is not None, "install the extra 'bench'"
    assert spec.origin is not None, "up_fast_downward is a package with files"
    driver = (sys.executable, str(Path(spec.origin).parent / "downward" / "fast-downward.py"), "--plan-file", "plan")
    return (
        Peer("lama-first", (*driver, "--alias", "lama-first")),
        Peer("astar(lmcut)", driver, ("--search", "astar(lmcut())")),
        Peer("pyperplan", (sys.executable, "-m", "pyperplan", "-s", "gbf", "-H", "hff"), costs=False),
    )


def solved_by(peer: Peer, domain: str, text: str) -> Outcome:
    """Return the result of a planner on a PDDL problem; its time includes its start."""
    if not peer.costs:
        domain, text = pddl.without_costs(domain), pddl.without_costs(text)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "domain.pddl").write_text(domain, encoding="utf-8")
        (Path(folder) / "problem.pddl").write_text(text, encoding="utf-8")
        before = _children_s()
        status, said = _run([*peer.command, "domain.pddl", "problem.pddl", *peer.search], folder)
        seconds = _children_s() - before
        if status is None:
            return Outcome(timed_out=True)
        plans = [path for path in (Path(folder) / "plan", Path(folder) / "problem.pddl.soln") if path.exists()]
        if not plans:
            return Outcome(why=f"exit code {status}, {_complaint(said)}")
        plan = plans[0].read_text(encoding="utf-8")
    cost = _PLAN.search(said)
    return Outcome(seconds, int(cost[1]) if cost else None, _choice(plan))


def _run(command: list[str], folder: str) -> tuple[int | None, str]:
    """Run a command with its child processes; return its exit code, None at the time limit, and its output."""
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    ) as process:
        try:
            said, _ = process.communicate(timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            return None, ""
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
    return process.returncode, said


@dataclass(frozen=True, slots=True)
class Compared:
    """The results of the reasoner and its peers on one problem.

    Attributes:
        first_s: CPU time of the reasoner from the belief to the first primitive action.
        run: Effort of the reasoner in a whole run.
        theirs: Results of the peers on the detailed problem, by name.
        least: Result of the optimal peer on the choice alone.
    """

    n: int
    state: State
    first_s: float
    run: Thinking
    theirs: dict[str, Outcome]
    least: Outcome


def tables() -> tuple[Table, Table]:
    """Return the tables of times and of costs."""
    rulebook = load_rules()
    whole_run(problem(3, "a", 0), rulebook)
    found = [_compared(n, state, rulebook) for n in SIZES for state in ("a", "b")]
    return _time_table(found), _cost_table(found)


def _compared(n: int, state: State, rulebook: Rulebook) -> Compared:
    given = problem(n, state, 0)
    first_s = statistics.median(first_action(given, rulebook).first_s for _ in range(REPEATS))
    run = whole_run(given, rulebook)
    theirs = {peer.name: solved_by(peer, pddl.DETAILED, pddl.detailed(given)) for peer in peers()}
    least = solved_by(peers()[1], pddl.CHOICE, pddl.choice(given))
    return Compared(n, state, first_s, run, theirs, least)


def _time_table(found: Sequence[Compared]) -> Table:
    faster = [each.theirs["lama-first"].slower_than(each.first_s) for each in found]
    failed = [
        f"lama-first failed at n = {each.n}, state {each.state}: {each.theirs['lama-first'].why}"
        for each in found
        if each.theirs["lama-first"].why
    ]
    return Table(
        "The reasoner beside classical planners: time",
        "CPU seconds on the same problems (benchmarks/problems.py, seed 0; state a: some known object may be what is "
        "meant, b: only searching is left). The reasoner is warm and goes from a belief to its first primitive action "
        "(median of three); the last columns add up all decisions of a run in which everything turns out as hoped. "
        "The peers solve the whole problem once: the example compiled by hand to determinised belief-space PDDL "
        "(DETAILED of `benchmarks/pddl.py`), made for planners of this kind, without axioms, conditional effects and "
        "negative preconditions; looks at pose, kind and colour apart, drives at a price per metre, things in the way "
        "put aside anywhere, room else on the desk only, nothing looked for that is not to be hoped for. Their start "
        "and translation are counted. pyperplan knows no costs. Every peer gets every problem; after "
        f"{LIMIT_S} s of wall time it is stopped (> {LIMIT_S}), so that all of this takes a few minutes.",
        ["n", "state", "reasoner, first action", *_names(), "reasoner, all of a run", "decisions", "actions"],
        [_times(each) for each in found],
        [
            Target(
                "faster than lama-first from n = 3 on",
                all(faster),
                "; ".join([f"{sum(faster)} of {len(faster)} problems", *failed]),
            )
        ],
    )


def _cost_table(found: Sequence[Compared]) -> Table:
    optimal = [each.run.cost == each.least.cost for each in found]
    return Table(
        "The reasoner beside classical planners: cost",
        "Cost (-ln p) of what is chosen. The reasoner's first plan chooses the object or the region; the optimum of "
        "that choice is found by Fast Downward, astar(lmcut), on CHOICE of `benchmarks/pddl.py`. The peers' costs are "
        "of the whole detailed plan, drives included, which the reasoner never makes in one piece: DETAILED has prices "
        "of its own, in hundredths, and drives may make another choice the cheapest.",
        ["n", "state", "reasoner", "optimum", "chosen", *(f"{name}: cost, choice" for name in _names())],
        [_costs(each) for each in found],
        [Target("the choice has the optimal cost", all(optimal), f"{sum(optimal)} of {len(optimal)} problems")],
    )


def _names() -> list[str]:
    return [peer.name for peer in peers()]


def _times(each: Compared) -> list[object]:
    ratios = [
        str(out) if out.cpu_s is None else f"{out} ({out.cpu_s / each.first_s:.1f}x)" for out in each.theirs.values()
    ]
    run = each.run
    return [each.n, each.state, f"{each.first_s:.3f}", *ratios, f"{run.run_s:.2f}", run.replans, run.actions]


def _costs(each: Compared) -> list[object]:
    run, least = each.run, each.least
    optimum = str(least) if least.cost is None else f"{least.cost / 1e6:.4f}"
    cells = [
        str(out) if out.cpu_s is None else f"{'-' if out.cost is None else f'{out.cost / 100:.2f}'}, {out.choice}"
        for out in each.theirs.values()
    ]
    return [each.n, each.state, f"{run.cost / 1e6:.4f}", optimum, run.choice, *cells]


def _complaint(said: str) -> str:
    """Return the line of a planner's output that best explains its failure, short enough for a cell."""
    lines = said.replace("|", "/").strip().splitlines() or ["no message"]
    return next(
        (line for line in reversed(lines) if re.search(r"error|undefined|memory", line, re.IGNORECASE)), lines[-1]
    )


def _choice(plan: str) -> str:
    """Return the object that a PDDL plan examines last, or the region in which it finds it."""
    steps = [(kind, first, second) for kind, first, second in _CHOICE.findall(plan)]
    regions = {first: second for kind, first, second in steps if kind == "find"}
    examined = [first for kind, first, _ in steps if kind == "examine"]
    return regions.get(examined[-1], examined[-1]) if examined else "?"


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
