"""How the runs of a sweep went, as Markdown: success with its interval, calibration, effort, and every failure."""

import math
import os
import platform
import re
import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from skolem.reasoner import Goal
from skolem.reasoner.language.expressions import Believed, Estimated
from skolem.tools.loop.source import SOURCE_SHA256
from skolem.tools.loop.stopwatch import PARTS, RECORDING
from skolem.tools.sweep.rows import Row
from skolem.traces.messages import RunStatus

CONFIDENCE = 0.95  # of the intervals
ACHIEVED: RunStatus = "goal_achieved"
DIGITS = 12  # of the hash of rules and program
MANY = 10  # failures that say the same and are told in one line
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
    """The runs of one scenario.

    Attributes:
        name: Of the scenario.
        file: The file it was read from, as the command that is shown calls it.
        world: Which simulator.
        overrides: What was changed of the scenario.
        goal: What was to be achieved.
        expected: How the scenario says that runs end.
        rows: The runs, by seed.
    """

    name: str
    file: str
    world: str
    overrides: Sequence[str]
    goal: Goal
    expected: RunStatus
    rows: Sequence[Row]

    @property
    def as_expected(self) -> int:
        """How many runs ended as the scenario says."""
        return sum(row.status == self.expected for row in self.rows)

    @property
    def command(self) -> str:
        """What makes these runs."""
        seeds = sorted(row.seed for row in self.rows)
        words = [f"skolem sweep {self.file}", f"--seeds {_ranges(seeds)}", f"--world {self.world}"]
        return " ".join([*words, *(f"--set {override}" for override in self.overrides), "-o DIR"])

    @property
    def key(self) -> str:
        """What tells this account from others in one file."""
        return " ".join([self.name, self.world, *self.overrides])

    @property
    def title(self) -> str:
        """Name, world and overrides in one line."""
        return ", ".join([self.name, f"{self.world} world", *self.overrides])


def wilson(hits: int, of: int) -> tuple[float, float]:
    """Return Wilson's score interval of a share, at `CONFIDENCE` (J. Am. Stat. Assoc. 22, 1927)."""
    if of == 0:
        return (0.0, 1.0)
    z = statistics.NormalDist().inv_cdf((1.0 + CONFIDENCE) / 2.0)
    share, scale = hits / of, 1.0 + z * z / of
    middle = (share + z * z / (2 * of)) / scale
    reach = z / scale * math.sqrt(share * (1.0 - share) / of + z * z / (4 * of * of))
    return (max(0.0, middle - reach), min(1.0, middle + reach))


def promised(goal: Goal) -> float | None:
    """Return the least probability with which the goal asks anything to be believed."""
    return min((item.p for item in goal.conjuncts if isinstance(item, Believed | Estimated)), default=None)


def summary(parts: Iterable[Part]) -> str:
    """Return the whole account."""
    return "\n".join(["# Sweep", "", *(text for _, text in sections(list(parts)))])


def sections(parts: Sequence[Part]) -> list[tuple[str, str]]:
    """Return the account of each scenario under its key, and before them an overview if there are several."""
    found = [(part.key, section(part)) for part in parts]
    if len(parts) > 1:
        first = parts[0]
        found.insert(0, (" ".join(["overview", first.world, *first.overrides]), _overview(parts)))
    return found


def _overview(parts: Sequence[Part]) -> str:
    """Return a line per scenario: how many runs went well, and the medians of what they took."""
    lines = [
        f"## {', '.join(['All scenarios', f'{parts[0].world} world', *parts[0].overrides])}",
        "",
        "Of a run: medians.",
        "",
        "| scenario | runs | ended as expected | believed | of these true | actions | wall time, s | simulated over "
        "wall time |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for part in parts:
        believed, true = sum(row.believed for row in part.rows), sum(row.succeeded for row in part.rows)
        ended = [row for row in part.rows if row.status != "error"]
        medians = [_median(ended, lambda row: row.actions), _median(ended, lambda row: row.seconds["total"])]
        counts = f"{part.name} | {len(part.rows)} | {part.as_expected} | {believed} | {true}"
        lines.append(f"| {counts} | {' | '.join(medians)} | {_median(ended, _speed)} |")
    return "\n".join([*lines, ""])


def _speed(row: Row) -> float:
    """Return simulated over wall time."""
    return row.simulated_s / (row.seconds["total"] or 1.0)


def _median(rows: Sequence[Row], value: Callable[[Row], float]) -> str:
    return _number(statistics.median(map(value, rows))) if rows else "-"


def section(part: Part) -> str:
    """Return the account of one scenario."""
    rows = part.rows
    ended = [row for row in rows if row.status != "error"]
    lines = [f"## {part.title}", "", f"Goal: `{part.goal}`", "", *_shares(part), ""]
    if ended:
        lines += [*_efforts(ended), "", _variety(rows), ""]
    failed = [row for row in rows if not row.succeeded]
    lines += [*_failures(failed), *([""] if failed else [])]
    if rows:
        lines += [f"<sub>`{part.command}`; rules and program {SOURCE_SHA256[:DIGITS]}</sub>", ""]
    return "\n".join(lines)


def line(part: Part) -> str:
    """Return one line for a terminal."""
    rows, believed = part.rows, sum(row.believed for row in part.rows)
    true = sum(row.succeeded for row in part.rows)
    effort = f"median {_number(statistics.median(row.actions for row in rows))} actions" if rows else "nothing done"
    return f"{part.title}: {believed} of {len(rows)} believed, {true} of these true; {effort}"


def with_section(text: str, key: str, section: str) -> str:
    """Return a text with the section of that key put in, or replaced, between its markers."""
    begin, end = f"<!-- results {key} -->", f"<!-- end of results {key} -->"
    block = f"{begin}\n{section}{end}"
    pattern = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
    if pattern.search(text):
        return pattern.sub(lambda _: block, text)
    return f"{text.rstrip()}\n\n{block}\n"


def _shares(part: Part) -> list[str]:
    """Return success and calibration as a table."""
    rows, floor = part.rows, promised(part.goal)
    believed, succeeded = sum(row.believed for row in rows), sum(row.succeeded for row in rows)
    unaware = sum(row.true is True and not row.believed for row in rows)
    return [
        f"| of {len(rows)} runs | number | share | {CONFIDENCE:.0%} interval |",
        "|---|---|---|---|",
        *(
            []
            if part.expected == ACHIEVED
            else [_share(f"ended as expected: {part.expected}", part.as_expected, len(rows))]
        ),
        _share("goal believed achieved", believed, len(rows)),
        _share("believed and true", succeeded, len(rows)),
        _share("true but not believed", unaware, len(rows)),
        _share("true among the believed" + (f" (promised: {floor:.0%})" if floor else ""), succeeded, believed),
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
    """Return how many ways to success there were."""
    ways = Counter(row.sequence for row in rows if row.succeeded)
    if not ways:
        return "No run succeeded."
    common, times = min(ways.items(), key=lambda item: (-item[1], item[0]))
    return (
        f"Distinct successful action sequences: {len(ways)}. The most frequent ({times} of {ways.total()}): "
        f"{', '.join(common)}."
    )


def _failures(rows: Sequence[Row]) -> list[str]:
    """Return why runs did not succeed: a line each, but one for many that say the same."""
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
    """Return why a run did not succeed."""
    return "believed, but not true" if row.believed else f"{row.status}: {' '.join(row.reason.split())}"


def _nearest(row: Row) -> str:
    """Return how near the robot thought it came, and how much it has seen."""
    about = f" ({', '.join(row.conjuncts)})" if row.conjuncts else ""
    found = f"; best candidate {row.anchor}, p = {row.goal_probability:.3f}{about}" if row.anchor else ""
    return found + (f"; seen of the regions: {', '.join(row.regions)}" if row.regions else "")


def _ranges(seeds: Sequence[int]) -> str:
    """Return ascending numbers with runs of neighbours drawn together: 0-3, 7, 9-10."""
    ranges: list[list[int]] = []
    for seed in seeds:
        if ranges and seed == ranges[-1][-1] + 1:
            ranges[-1][1:] = [seed]
        else:
            ranges.append([seed])
    return ", ".join("-".join(map(str, ends)) for ends in ranges)
