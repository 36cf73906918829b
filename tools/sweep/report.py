"""The report of a sweep as Markdown: success with its interval, calibration, effort, and every failure."""

import os
import platform
import re
import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from skolem.reasoner import Goal
from skolem.reasoner.language.expressions import Believed, Estimated
from skolem.tools.loop.source import SOURCE_SHA256
from skolem.tools.loop.stopwatch import PARTS, RECORDING
from skolem.tools.sweep.calibration import Calibration
from skolem.tools.sweep.calibration_tables import calibration_tables
from skolem.tools.sweep.rows import Row
from skolem.tools.sweep.shares import CONFIDENCE, wilson
from skolem.tools.words.printable import markdown, printable
from skolem.traces.messages import RunStatus

ENDS: Mapping[RunStatus, str] = {
    "goal_unachievable": "given up as impossible",
    "no_referent": "nothing fits",
    "no_unique_referent": "several fit",
    "limit_reached": "ended at a limit",
    "error": "ended by an internal error",
}
DIGITS = 12  # printed digits of the hash of rules and program
MANY = 10  # from so many failures with the same reason on, one line stands for all
COUNTS: tuple[tuple[str, Callable[[Row], float]], ...] = (
    ("actions", lambda row: row.actions),
    ("replans", lambda row: row.replans),
    ("clingo calls", lambda row: row.clingo_calls),
)
TIMES: tuple[tuple[str, Callable[[Row], float]], ...] = (
    ("simulated time, s", lambda row: row.simulated_s),
    ("wall time, s", lambda row: row.seconds["total"]),
)
RECORDS: tuple[tuple[str, Callable[[Row], float]], ...] = (
    ("recording, % of the wall time", lambda row: 100.0 * row.seconds[RECORDING] / (row.seconds["total"] or 1.0)),
    ("trace, kB", lambda row: row.size_bytes / 1e3),
    ("trace, kB per simulated minute", lambda row: row.size_bytes / 1e3 / (row.simulated_s or 60.0) * 60.0),
)


@dataclass(frozen=True, slots=True)
class Part:
    """The runs of one scenario, or of one family.

    Attributes:
        name: Name of the scenario or family.
        source: Its name in the printed command: the scenario file, or an option.
        world: Name of the simulator.
        overrides: Changed values of the scenario.
        goals: The goals of the runs, by seed.
        rows: The runs, by seed.
        calibration: The calibration over the runs; None if it was not asked for.
    """

    name: str
    source: str
    world: str
    overrides: Sequence[str]
    goals: Mapping[int, Goal]
    rows: Sequence[Row]
    calibration: Calibration | None = None

    @property
    def goal(self) -> Goal | None:
        """The goal of every run; None if there are several."""
        first, *others = dict.fromkeys(self.goals.values())
        return None if others else first

    @property
    def as_expected(self) -> int:
        """The number of runs that ended as their scenario expects."""
        return sum(row.status == row.expected for row in self.rows)

    @property
    def achievable(self) -> list[Row]:
        """The runs whose goal can be achieved, as their scenario says."""
        return [row for row in self.rows if row.achievable]

    @property
    def command(self) -> str:
        """The command that makes these runs."""
        seeds = sorted(row.seed for row in self.rows)
        words = [f"skolem sweep {self.source}", f"--seeds {_ranges(seeds)}", f"--world {self.world}"]
        return " ".join([*words, *(f"--set {override}" for override in self.overrides), "-o DIR"])

    @property
    def key(self) -> str:
        """The key of this section among the others in a file."""
        return " ".join([self.name, self.world, *self.overrides])

    @property
    def title(self) -> str:
        """Name, world and overrides in one line."""
        return ", ".join([self.name, f"{self.world} world", *self.overrides])


def promised(goal: Goal) -> float | None:
    """Return the lowest bound in the goal, as a probability."""
    return min((item.p for item in goal.conjuncts if isinstance(item, Believed | Estimated)), default=None)


def summary(parts: Iterable[Part]) -> str:
    """Return the whole report."""
    return "\n".join(["# Sweep", "", *(text for _, text in sections(list(parts)))])


def sections(parts: Sequence[Part]) -> list[tuple[str, str]]:
    """Return the section of each scenario with its key, and an overview before them if there are several."""
    found = [(part.key, section(part)) for part in parts]
    if len(parts) > 1:
        first = parts[0]
        found.insert(0, (" ".join(["overview", first.world, *first.overrides]), _overview(parts)))
    return found


def _overview(parts: Sequence[Part]) -> str:
    """Return a line for each scenario: how its runs ended, and the medians of their effort."""
    lines = [
        f"## {markdown(', '.join(['All scenarios', f'{parts[0].world} world', *parts[0].overrides]))}",
        "",
        "Of a run: medians.",
        "",
        "| scenario | runs | ended as expected | achieved of achievable | believed | of these true | true of another "
        "object | actions | wall time, s | simulated over wall time |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for part in parts:
        believed, true = sum(row.believed for row in part.rows), sum(row.succeeded for row in part.rows)
        ended = [row for row in part.rows if row.status != "error"]
        medians = [_median(ended, lambda row: row.actions), _median(ended, lambda row: row.seconds["total"])]
        another, could = sum(map(_of_another, part.rows)), part.achievable
        achieved = f"{sum(row.succeeded for row in could)} of {len(could)}"
        ends = f"{part.as_expected} | {achieved} | {believed} | {true} | {another}"
        counts = f"{part.name} | {len(part.rows)} | {ends}"
        lines.append(f"| {counts} | {' | '.join(medians)} | {_median(ended, _speed)} |")
    return "\n".join([*lines, ""])


def _of_another(row: Row) -> bool:
    """Return whether the goal is believed and true, but not of the object that the robot has in mind."""
    return row.believed and row.true is True and not row.own


def _speed(row: Row) -> float:
    """Return the ratio of simulated to wall time."""
    return row.simulated_s / (row.seconds["total"] or 1.0)


def _median(rows: Sequence[Row], value: Callable[[Row], float]) -> str:
    return _number(statistics.median(map(value, rows))) if rows else "-"


def section(part: Part) -> str:
    """Return the section of one scenario."""
    rows = part.rows
    ended = [row for row in rows if row.status != "error"]
    asked = f"Goal: `{_code(part.goal)}`" if part.goal else f"{len(part.goals)} worlds, each with a goal and an answer."
    lines = [f"## {markdown(part.title)}", "", asked, "", *_shares(part), ""]
    if ended:
        lines += [*_efforts(ended), "", _variety(rows), ""]
    if part.calibration is not None:
        lines += [*calibration_tables(part.calibration), ""]
    failed = [row for row in rows if not row.well_ended]
    lines += [*_failures(failed), *([""] if failed else [])]
    if rows:
        lines += [f"<sub>`{_code(part.command)}`; rules and program {SOURCE_SHA256[:DIGITS]}</sub>", ""]
    return "\n".join(lines)


def line(part: Part) -> str:
    """Return the result of one scenario as a line for a terminal."""
    rows, believed = part.rows, sum(row.believed for row in part.rows)
    true = sum(row.succeeded for row in part.rows)
    effort = f"median {_number(statistics.median(row.actions for row in rows))} actions" if rows else "nothing done"
    could = part.achievable
    shares = f"{believed} of {len(rows)} believed, {true} of these true"
    if part.goal is None:
        shares = f"{sum(row.succeeded for row in could)} of {len(could)} achieved that can be; {shares}"
    return f"{part.title}: {shares}; {effort}"


def with_section(text: str, key: str, section: str) -> str:
    """Return a text with the section of a key inserted, or replaced, between its markers."""
    key = printable(key).replace("--", "- -")  # which would end the comment
    begin, end = f"<!-- results {key} -->", f"<!-- end of results {key} -->"
    block = f"{begin}\n{section}{end}"
    pattern = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
    if pattern.search(text):
        return pattern.sub(lambda _: block, text)
    return f"{text.rstrip()}\n\n{block}\n"


def _shares(part: Part) -> list[str]:
    """Return success as a table."""
    rows, could = part.rows, part.achievable
    believed, succeeded = sum(row.believed for row in rows), sum(row.succeeded for row in rows)
    unaware = sum(row.true is True and not row.believed for row in rows)
    floor = None if part.goal is None else promised(part.goal)
    return [
        f"| of {len(rows)} runs | number | share | {CONFIDENCE:.0%} interval |",
        "|---|---|---|---|",
        *_of_the_answer(part),
        _share("goal believed achieved", believed, len(rows)),
        _share("believed and true", succeeded, len(rows)),
        _share("believed, but true of another object alone", sum(map(_of_another, rows)), len(rows)),
        _share("true but not believed", unaware, len(rows)),
        _share("true among the believed" + (f" (promised: {floor:.0%})" if floor else ""), succeeded, believed),
        *([] if part.goal and len(could) == len(rows) else _ends(part)),
    ]


def _of_the_answer(part: Part) -> list[str]:
    """Return the success among achievable and impossible goals; nothing if every goal is the same and achievable."""
    could, rows = part.achievable, part.rows
    if part.goal and len(could) == len(rows):
        return []
    hopeless = [row for row in rows if not row.achievable]
    if part.goal:
        return [_share(f"ended as expected: {hopeless[0].expected}", part.as_expected, len(rows))]
    return [
        _share("achieved, of the achievable", sum(row.succeeded for row in could), len(could)),
        _share("found impossible, of the impossible", sum(row.well_ended for row in hopeless), len(hopeless)),
    ]


def _ends(part: Part) -> list[str]:
    """Return the ends of runs that did not achieve an achievable goal: giving up is a failure there."""
    could = part.achievable
    return [
        _share(f"achievable, but {said}", sum(row.status == status for row in could), len(could))
        for status, said in ENDS.items()
    ]


def _share(title: str, hits: int, of: int) -> str:
    low, high = wilson(hits, of)
    share = f"{hits / of:.1%}" if of else "-"
    return f"| {title} | {hits} of {of} | {share} | {low:.1%} to {high:.1%} |"


def _efforts(rows: Sequence[Row]) -> list[str]:
    """Return medians and ranges of the runs that ended by themselves, as a table."""
    parts = [(f"- {name.replace('_', ' ')}", lambda row, name=name: row.seconds[name]) for name in PARTS]
    return [
        "| of a run | median | least | most |",
        "|---|---|---|---|",
        *(_effort(title, [value(row) for row in rows]) for title, value in [*COUNTS, *TIMES, *parts, *RECORDS]),
        "",
        f"Simulated over wall time: median {_median(rows, _speed)}. Wall times of single-threaded processes on a "
        f"machine with {os.cpu_count()} processors ({platform.machine()}), Python {platform.python_version()}.",
    ]


def _effort(title: str, values: Sequence[float]) -> str:
    return f"| {title} | {_number(statistics.median(values))} | {_number(min(values))} | {_number(max(values))} |"


def _number(value: float) -> str:
    return f"{value:g}" if float(value).is_integer() else f"{value:.2f}"


def _variety(rows: Sequence[Row]) -> str:
    """Return the number of different action sequences that led to success."""
    ways = Counter(row.sequence for row in rows if row.succeeded)
    if not ways:
        return "No run succeeded."
    common, times = min(ways.items(), key=lambda item: (-item[1], item[0]))
    return (
        f"Distinct successful action sequences: {len(ways)}. The most frequent ({times} of {ways.total()}): "
        f"{markdown(', '.join(common))}."
    )


def _failures(rows: Sequence[Row]) -> list[str]:
    """Return the reasons of failed runs: a line for each, but one line for many equal ones."""
    said: dict[str, list[Row]] = {}
    for row in rows:
        said.setdefault(_why(row), []).append(row)
    lines = []
    for why, alike in said.items():
        if len(alike) > MANY:
            lines.append((alike[0].seed, f"- seeds {_ranges([row.seed for row in alike])}: {why}"))
        else:
            lines += [
                (row.seed, f"- seed {row.seed}: {why}{_nearest(row)}; {row.trace or 'no trace'}") for row in alike
            ]
    return [text for _, text in sorted(lines)]


def _why(row: Row) -> str:
    """Return why a run failed."""
    if _of_another(row):
        return f"believed of {markdown(str(row.anchor))}, but true of {markdown(str(row.witness))} alone"
    return "believed, but not true" if row.believed else f"{row.status}: {markdown(' '.join(row.reason.split()))}"


def _nearest(row: Row) -> str:
    """Return the probability of the best candidate, and the share of the regions that was seen."""
    about = f" ({markdown(', '.join(row.conjuncts))})" if row.conjuncts else ""
    found = f"; best candidate {markdown(row.anchor)}, p = {row.goal_probability:.3f}{about}" if row.anchor else ""
    return found + (f"; seen of the regions: {markdown(', '.join(row.regions))}" if row.regions else "")


def _code(text: object) -> str:
    """Return a text as it stands between two backticks."""
    return printable(str(text)).replace("`", "'")


def _ranges(seeds: Sequence[int]) -> str:
    """Return ascending numbers as ranges: 0-3, 7, 9-10."""
    ranges: list[list[int]] = []
    for seed in seeds:
        if ranges and seed == ranges[-1][-1] + 1:
            ranges[-1][1:] = [seed]
        else:
            ranges.append([seed])
    return ", ".join("-".join(map(str, ends)) for ends in ranges)
