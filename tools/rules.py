"""The verb `rules`: check rule files, print the reference of the rules."""

import json as json_format
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from skolem.tools.run import fault_rows
from skolem.traces.errors import Fault, InputError

if TYPE_CHECKING:
    from skolem.reasoner.rulebook import Rulebook

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
    """Report every fault and every doubtful thing in rule files, each with its place and a suggestion.

    Exit status: 0 nothing to complain of, 1 warnings only, 2 a fault: such rules are refused.
    """
    from skolem.reasoner.linting import NOT_A_FLUENT, findings

    try:
        rulebook = _load(paths or [])
    except InputError as error:
        rows = [row | {"severity": "error", "code": "refused", "allowed": ""} for row in fault_rows(error)]
        _report(rows, error.faults, json)
        raise typer.Exit(WRONG) from error
    found = findings(rulebook)
    faults = [*rulebook.warnings, *(finding.fault for finding in found)]
    rows = [row | {"severity": "warning", "code": "words", "allowed": ""} for row in _rows(rulebook.warnings)]
    for finding in found:
        severity = "error" if finding.code == NOT_A_FLUENT else "allowed" if finding.allowed else "warning"
        extra = {"severity": severity, "code": finding.code, "allowed": finding.allowed}
        rows += [row | extra for row in _rows([finding.fault])]
    _report(rows, faults, json)
    severities = {row["severity"] for row in rows}
    raise typer.Exit(WRONG if "error" in severities else DOUBTFUL if "warning" in severities else 0)


@app.command()
def doc(
    paths: Paths = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Where to write it. Default: printed.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the same as one JSON object.")] = False,
) -> None:
    """Write the reference of the rules: operators, inference rules, words, exclusions, queries; made from the files.

    Exit status: 0 written, 2 the rules have a fault.
    """
    from skolem.reasoner.rule_docs import reference, sections

    rulebook = _load(paths or [])
    text = json_format.dumps(sections(rulebook)) + "\n" if json else reference(rulebook)
    if out is None:
        print(text, end="")
    else:
        out.write_text(text, encoding="utf-8")


def _load(paths: Sequence[Path]) -> "Rulebook":
    """Return the rules that are meant.

    Raises:
        InputError: With every fault in them.
    """
    from skolem.reasoner.queries import Queries
    from skolem.reasoner.rulebook import RULE_FILES, Rulebook

    own: list[Path] = []
    whole: Path | None = None
    for path in paths:
        inside = sorted(path.glob("*.lp")) if path.is_dir() else [path]
        if not inside:
            raise InputError([Fault(str(path), 0, 0, "a folder without a rule file: expected names that end in .lp")])
        if {f"{name}.lp" for name in RULE_FILES} <= {file.name for file in inside}:
            whole, inside = path, [file for file in inside if file.stem not in RULE_FILES]
        own += inside
    return Rulebook.load(Queries, own, whole)


def _rows(faults: Sequence[Fault]) -> list[dict[str, object]]:
    return fault_rows(InputError(faults))


def _report(rows: Sequence[dict[str, object]], faults: Sequence[Fault], json: bool) -> None:
    """Print complaints; what is allowed is counted, and listed for machines only."""
    if json:
        for row in rows:
            print(json_format.dumps(row))
        return
    count = {"error": 0, "warning": 0, "allowed": 0}
    for row, fault in zip(rows, faults, strict=True):
        severity = str(row["severity"])
        count[severity] += 1
        if severity != "allowed":
            message = fault.message.removeprefix("warning: ")
            hint = f" [{row['code']}]" if severity == "warning" else ""
            print(Fault(fault.file, fault.line, fault.column, f"{severity}: {message}{hint}", fault.at, fault.excerpt))
    print(", ".join(f"{number} {name}" for name, number in count.items() if number) or "nothing to complain of")
