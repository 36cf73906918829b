"""Tables of measurements, and the page that holds each of them in a section between markers."""

import os
import platform
import re
import subprocess
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "benchmarks.md"
INTRODUCTION = """# Benchmarks

Made by `make bench`. Times are of one machine and differ from another's; what is compared was measured in one run.
"""


@dataclass(frozen=True, slots=True)
class Target:
    """A target of a measurement.

    Attributes:
        text: The target in words.
        met: Whether the measurement meets it.
        found: The figure that decides.
    """

    text: str
    met: bool
    found: str

    def __str__(self) -> str:
        return f"- {'met' if self.met else '**missed**'}: {self.text} ({self.found})"


@dataclass(frozen=True, slots=True)
class Table:
    """One measurement.

    Attributes:
        title: Title of its section; the name of its markers derives from it.
        about: What was measured, and how.
        header: Names of the columns.
        rows: The cells.
        targets: The targets.
        notes: Paragraphs below, such as a profile if a target is missed.
    """

    title: str
    about: str
    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    targets: Sequence[Target] = ()
    notes: Sequence[str] = field(default_factory=tuple)

    def __str__(self) -> str:
        """Return the section in Markdown."""
        lines = [f"## {self.title}", "", self.about, "", _row(self.header), _row(["---"] * len(self.header))]
        lines += [_row(row) for row in self.rows]
        if self.targets:
            lines += ["", *map(str, self.targets)]
        for note in self.notes:
            lines += ["", note]
        return "\n".join([*lines, "", f"<sub>{_where()}</sub>"])


def write(table: Table, page: Path = PAGE) -> None:
    """Put a section into the page: it replaces the one of the same title, or is added at the end."""
    text = page.read_text(encoding="utf-8") if page.exists() else INTRODUCTION
    name = _name(table.title)
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    section = f"{begin}\n{table}\n{end}\n"
    before, found, rest = text.partition(f"{begin}\n")
    text = before + section + rest.partition(f"{end}\n")[2] if found else f"{text.rstrip()}\n\n{section}"
    page.write_text(text, encoding="utf-8")


def keep_only(titles: Collection[str], page: Path = PAGE) -> None:
    """Remove the sections with other titles from the page."""
    names = {_name(title) for title in titles}

    def kept(section: re.Match[str]) -> str:
        return section[0] if section[1] in names else ""

    text = page.read_text(encoding="utf-8")
    text = re.sub(r"\n<!-- begin (\S+) -->\n.*?<!-- end \1 -->\n", kept, text, flags=re.DOTALL)
    page.write_text(text, encoding="utf-8")


def _name(title: str) -> str:
    """Return the name of a section's markers."""
    return re.sub(r"\W+", "-", title.lower()).strip("-")


def _row(cells: Sequence[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def _where() -> str:
    """Return commit and machine; changes of the page itself do not count as local changes."""
    git, others = ["git", "-C", str(ROOT)], [".", f":(exclude){PAGE.relative_to(ROOT)}"]
    commit = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    status = [*git, "status", "--porcelain", "--", *others]
    dirty = subprocess.run(status, capture_output=True, text=True, check=False).stdout
    changed = " with local changes" if dirty.strip() else ""
    machine = f"{platform.machine()}, {os.cpu_count()} cores, {_processor()}"
    return f"commit {commit.stdout.strip() or 'unknown'}{changed}; {machine}; Python {platform.python_version()}"


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    names = re.findall(r"model name\s*: (.*)", info.read_text(encoding="utf-8")) if info.exists() else []
    return names[0] if names else platform.processor() or "unknown processor"
