"""The reasoner beside classical planners on the same problems: time, cost, and which object or region is chosen."""

import re
import resource
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from benchmarks import pddl
from benchmarks.agents import Thinking, first_action, whole_run
from benchmarks.problems import Problem, State, problem
from benchmarks.tables import Table, Target
from skolem.reasoner.queries import Queries
from skolem.reasoner.rulebook import Rulebook

SIZES = (3, 10, 30, 100, 300)
LIMIT_S = 60  # per call of a peer, wall time
SLOW_S = 6  # who takes longer is not given larger problems
REPEATS = 3
_PLAN = re.compile(r"^(?:\[.*\] )?Plan cost: (\d+)", re.MULTILINE)
_CHOICE = re.compile(r"\((examine|find) ([^\s()]+)(?: ([^\s()]+))?")


@dataclass(frozen=True, slots=True)
class Peer:
    """How a planner is called.

    Attributes:
        name: In the table.
        command: Before the files.
        search: After the files.
        costs: Whether it knows costs.
    """

    name: str
    command: tuple[str, ...]
    search: tuple[str, ...] = ()
    costs: bool = True


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a peer did with a problem; `cpu_s` is None if it did not finish, and then `why` says why."""

    cpu_s: float | None
    cost: int | None = None
    choice: str = ""
    why: str = ""

    def __str__(self) -> str:
        return self.why if self.cpu_s is None else f"{self.cpu_s:.2f}"


def peers() -> tuple[Peer, ...]:
    """Return the planners that are compared; Fast Downward's times include its translation."""
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
    """Return what a planner makes of a PDDL problem; CPU time of the process and its children, start included."""
    if not peer.costs:
        domain, text = pddl.without_costs(domain), pddl.without_costs(text)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "domain.pddl").write_text(domain, encoding="utf-8")
        (Path(folder) / "problem.pddl").write_text(text, encoding="utf-8")
        before = _children_s()
        try:
            done = subprocess.run(
                [*peer.command, "domain.pddl", "problem.pddl", *peer.search],
                cwd=folder,
                capture_output=True,
                text=True,
                timeout=LIMIT_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Outcome(None, why=f"> {LIMIT_S}")
        seconds = _children_s() - before
        plans = [path for path in (Path(folder) / "plan", Path(folder) / "problem.pddl.soln") if path.exists()]
        if not plans:
            return Outcome(None, why=f"failed ({done.returncode})")
        plan = plans[0].read_text(encoding="utf-8")
    cost = _PLAN.search(done.stdout)
    return Outcome(seconds, int(cost[1]) if cost else None, _choice(plan))


def tables() -> tuple[Table, Table]:
    """Return the tables of times and of costs."""
    rulebook = Rulebook.load(Queries)
    whole_run(problem(3, "a", 0), rulebook)
    times, costs, faster, optimal = [], [], [], []
    too_slow: set[tuple[str, State]] = set()
    for n in SIZES:
        for state in ("a", "b"):
            given = problem(n, state, 0)
            ours = [first_action(given, rulebook) for _ in range(REPEATS)]
            run = whole_run(given, rulebook)
            theirs = _theirs(given, state, too_slow)
            least = solved_by(peers()[1], pddl.CHOICE, pddl.choice(given))
            first_s = statistics.median(each.first_s for each in ours)
            times.append(_times(n, state, first_s, run, theirs))
            costs.append(_costs(n, state, run, least, theirs))
            lama = theirs["lama-first"].cpu_s
            faster.append(lama is None or first_s < lama)
            optimal.append(run.cost == least.cost)
    about_times = (
        "CPU seconds on the same problems (benchmarks/problems.py, seed 0; state a: some known object may be what is "
        "meant, b: only searching is left). The reasoner is warm and goes from a belief to its first primitive action "
        "(median of three); the last columns add up all decisions of a run in which everything turns out as hoped. "
        "The peers solve the whole problem, flat and determinised, once; start and translation are counted. pyperplan "
        f"knows no costs. After {LIMIT_S} s a peer is stopped; one that took {SLOW_S} s gets no larger problems (-)."
    )
    names = [peer.name for peer in peers()]
    time_table = Table(
        "The reasoner beside classical planners: time",
        about_times,
        ["n", "state", "reasoner, first action", *names, "reasoner, all of a run", "decisions", "actions"],
        times,
        [Target("faster than lama-first from n = 3 on", all(faster), f"{sum(faster)} of {len(faster)} problems")],
    )
    about_costs = (
        "Cost (-ln p) of what is chosen. The reasoner's first plan chooses the object or the region; the optimum of "
        "that choice is found by Fast Downward, astar(lmcut), on CHOICE of `benchmarks/pddl.py`. The peers' costs are "
        "of the whole detailed plan (DETAILED), which the reasoner never makes in one piece."
    )
    cost_table = Table(
        "The reasoner beside classical planners: cost",
        about_costs,
        ["n", "state", "reasoner", "optimum", "chosen", *(f"{name}: cost, choice" for name in names)],
        costs,
        [Target("the choice has the optimal cost", all(optimal), f"{sum(optimal)} of {len(optimal)} problems")],
    )
    return time_table, cost_table


def _theirs(given: Problem, state: State, too_slow: set[tuple[str, State]]) -> dict[str, Outcome]:
    found: dict[str, Outcome] = {}
    for peer in peers():
        if (peer.name, state) in too_slow:
            found[peer.name] = Outcome(None, why="-")
            continue
        found[peer.name] = solved_by(peer, pddl.DETAILED, pddl.detailed(given))
        cpu_s = found[peer.name].cpu_s
        if cpu_s is None or cpu_s > SLOW_S:
            too_slow.add((peer.name, state))
    return found


def _times(n: int, state: State, first_s: float, run: Thinking, theirs: dict[str, Outcome]) -> list[object]:
    ratios = [f"{out} ({out.cpu_s / first_s:.1f}x)" if out.cpu_s is not None else str(out) for out in theirs.values()]
    return [n, state, f"{first_s:.3f}", *ratios, f"{run.run_s:.2f}", run.replans, run.actions]


def _costs(n: int, state: State, run: Thinking, least: Outcome, theirs: dict[str, Outcome]) -> list[object]:
    optimum = "?" if least.cost is None else f"{least.cost / 1e6:.4f}"
    peers_cells = [
        f"{'-' if out.cost is None else f'{out.cost / 1e6:.3f}'}, {out.choice}" if out.cpu_s is not None else str(out)
        for out in theirs.values()
    ]
    return [n, state, f"{run.cost / 1e6:.4f}", optimum, run.choice, *peers_cells]


def _choice(plan: str) -> str:
    """Return what a PDDL plan examines at last, or the region it finds it in."""
    steps = [(kind, first, second) for kind, first, second in _CHOICE.findall(plan)]
    regions = {first: second for kind, first, second in steps if kind == "find"}
    examined = [first for kind, first, _ in steps if kind == "examine"]
    return regions.get(examined[-1], examined[-1]) if examined else "?"


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
