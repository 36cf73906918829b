"""The verb `rules`: check rule files, print the reference of the rules."""

import json as json_format
import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from skolem.tools.words.faults import fault_rows
from skolem.tools.words.terminal import output
from skolem.traces.errors import Fault, InputError
from skolem.traces.written import put

if TYPE_CHECKING:
    from skolem.reasoner.rulebook.files import RuleFile

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    help="Check rule files, or print the reference of rules, words and queries.",
)
DOUBTFUL, WRONG = 1, 2
Paths = Annotated[
    list[Path] | None,
    typer.Argument(
        help="Rule files of your own, or folders of them; a folder with a file of every name that ships is a set of "
        "rules by itself. Default: the rules that ship."
    ),
]


@app.command()
def check(
    paths: Paths = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object per complaint, and only that.")] = False,
) -> None:
    """Report every fault and every doubtful rule in rule files, each with its position and a suggestion.

    Exit status: 0 no complaint, 1 warnings only, 2 a fault: such rules are refused.
    """
    complaints, certain = _complaints(paths or [])
    _report(complaints, certain, json)
    severities = {complaint.severity for complaint in complaints}
    raise typer.Exit(WRONG if "error" in severities else DOUBTFUL if "warning" in severities else 0)


@dataclass(frozen=True, slots=True)
class Complaint:
    """A complaint about rule files: `error`, `warning`, or `allowed` with the reason that the file gives."""

    fault: Fault
    severity: str
    code: str
    allowed: str = ""


def _complaints(paths: Sequence[Path]) -> tuple[list[Complaint], bool]:
    """Return all complaints about rule files, sorted by position, and whether the list is complete."""
    from skolem.reasoner.rulebook.book import rule_files
    from skolem.tools.loop.apart import bounded

    try:
        sources, unread = rule_files(*_meant(paths))
        return bounded(sources, lambda: _examined(sources, unread))
    except InputError as error:
        return [Complaint(fault, "error", "refused") for fault in error.faults], False


def _examined(sources: "Sequence[RuleFile]", unread: Sequence[Fault]) -> tuple[list[Complaint], bool]:
    """Return everything to say of rule files that are read."""
    from skolem.reasoner.lint.linting import findings
    from skolem.reasoner.lint.wrong_rules import NOT_A_FLUENT
    from skolem.reasoner.planning.queries import Queries
    from skolem.reasoner.rulebook.examination import examine

    examined = examine(sources, Queries, complete=not unread)
    found = [Complaint(fault, "error", "refused") for fault in (*unread, *examined.faults)]
    found += [Complaint(fault, "warning", "words") for fault in examined.warnings]
    for finding in findings(examined):
        severity = "error" if finding.code == NOT_A_FLUENT else "allowed" if finding.allowed else "warning"
        found.append(Complaint(finding.fault, severity, finding.code, finding.allowed))
    return sorted(found, key=lambda complaint: complaint.fault), not unread and not examined.doubt


@app.command()
def doc(
    paths: Paths = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Where to write the reference. Default: print it.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the same as one JSON object.")] = False,
) -> None:
    """Write the reference of the rules: operators, inference rules, words, exclusions, queries; made from the files.

    Exit status: 0 written, 2 the rules have a fault.
    """
    from skolem.reasoner.lint.docs import reference, sections
    from skolem.reasoner.planning.queries import Queries
    from skolem.reasoner.rulebook.book import Rulebook, rule_files
    from skolem.tools.loop.apart import bounded

    sources, unread = rule_files(*_meant(paths or []))
    if unread:
        raise InputError(unread)

    def written() -> str:
        rulebook = Rulebook.of(Queries, sources)
        return json_format.dumps(sections(rulebook)) + "\n" if json else reference(rulebook)

    text = bounded(sources, written)
    if out is None:
        output(text, end="")
        return
    put(out, text.encode())


def _meant(paths: Sequence[Path]) -> tuple[list[Path], Path | None]:
    """Return the user's own rule files, and the folder that replaces the rules that ship; None if they are kept.

    Raises:
        InputError: If a folder has no rule file.
    """
    from skolem.reasoner.rulebook.book import RULE_FILES

    own: list[Path] = []
    whole: Path | None = None
    for path in paths:
        inside = sorted(path.glob("*.lp")) if os.path.isdir(path) else [path]
        if not inside:
            raise InputError([Fault(str(path), 0, 0, "a folder without a rule file: expected names that end in .lp")])
        if {f"{name}.lp" for name in RULE_FILES} <= {file.name for file in inside}:
            whole, inside = path, [file for file in inside if file.stem not in RULE_FILES]
        own += inside
    return own, whole


def _report(complaints: Sequence[Complaint], certain: bool, json: bool) -> None:
    """Print complaints; allowed ones are only counted, except with `json`."""
    if json:
        faults = fault_rows(InputError([complaint.fault for complaint in complaints]))
        for row, found in zip(faults, complaints, strict=True):
            extra = {"severity": found.severity, "code": found.code, "allowed": found.allowed, "complete": certain}
            output(json_format.dumps(row | extra))
        return
    for found in complaints:
        if found.severity != "allowed":
            hint = f" [{found.code}]" if found.severity == "warning" else ""
            message = f"{found.severity}: {found.fault.message.removeprefix('warning: ')}{hint}"
            output(replace(found.fault, message=message))
    counts = Counter(complaint.severity for complaint in complaints)
    said = [f"{counts[s]} {s}{'s' if counts[s] > 1 else ''}" for s in ("error", "warning") if counts[s]]
    allowed = (
        f"; {counts['allowed']} allowed for a reason that stands in the file (--json)" if counts["allowed"] else ""
    )
    output((", ".join(said) or "nothing to complain of") + allowed)
    if not certain:
        output("more may follow once these are mended")
