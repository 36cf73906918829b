"""`python -m benchmarks.robustness`: try generated inputs for some time, and write docs/robustness.md.

The campaign resumes where it was left: inputs are numbered, each is drawn from the seed and its number alone, and the
counts are kept in a file. Inputs that end badly are kept beside it.
"""

import argparse
import itertools
import json
import tempfile
import time
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from random import Random

from benchmarks.robustness.inputs import KINDS, ROOT, Case
from benchmarks.robustness.trying import ENDINGS, Tried, tried

PAGE = ROOT / "docs" / "robustness.md"
BAD = ENDINGS[2:]
LOADED = ("explain.explaining", "show.command", "run.running", "replay.replayer", "rules.command")
Counts = dict[str, dict[str, int]]  # endings by kind


def drawn(kind: str, seed: int, number: int, folder: Path) -> Case:
    """Return an input by its kind and number."""
    return KINDS[kind](Random(f"{seed} {kind} {number}"), folder)


def campaign(state: Path, seed: int, seconds: float, kinds: Sequence[str], rounds: int | None = None) -> Counts:
    """Try inputs of each kind in turn until time or rounds are over; return the counts of all campaigns so far."""
    for module in LOADED:  # once, not in every child
        import_module(f"skolem.tools.{module}")
    counts: Counts = {}
    if state.exists():
        known = json.loads(state.read_text(encoding="utf-8"))
        seed, counts = known["seed"], known["counts"]
    until = time.monotonic() + seconds
    for _ in itertools.count() if rounds is None else range(rounds):
        if time.monotonic() >= until:
            break
        for kind in kinds:
            of_kind = counts.setdefault(kind, dict.fromkeys(ENDINGS, 0))
            number = sum(of_kind.values())
            with tempfile.TemporaryDirectory() as folder:
                case = drawn(kind, seed, number, Path(folder))
            found = tried(case)
            of_kind[found.ending] += 1
            if found.ending in BAD:
                keep(state.parent / "found" / f"{kind.replace(' ', '-')}-{number}", case, found)
        state.parent.mkdir(parents=True, exist_ok=True)
        state.write_text(json.dumps({"seed": seed, "counts": counts}), encoding="utf-8")
    return counts


def keep(folder: Path, case: Case, found: Tried) -> None:
    """Write an input that ended badly, and how it ended, into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in case.files.items():
        (folder / name).write_bytes(content)
    said = json.dumps({"arguments": case.arguments, "ending": found.ending, "status": found.status, "said": found.said})
    (folder / "case.json").write_text(said, encoding="utf-8")


def page(counts: Mapping[str, Mapping[str, int]], seed: int) -> str:
    """Return docs/robustness.md."""
    lines = [
        "# Generated inputs",
        "",
        "Written by `make fuzz`. It draws scenarios, goals, rule files, traces and command lines, most of them sound",
        "in structure, and does a command with each in a process of its own, for fifteen minutes at most. It goes",
        "on where it was left: the counts are of all inputs so far. A hang is more than 10 s of computing.",
        "",
        f"| kind | inputs | {' | '.join(ENDINGS)} |",
        f"|---{'|---' * (len(ENDINGS) + 1)}|",
    ]
    for kind, found in counts.items():
        lines.append(f"| {kind} | {sum(found.values())} | {' | '.join(str(found[ending]) for ending in ENDINGS)} |")
    return "\n".join(
        [
            *lines,
            "",
            f"Seed {seed}. The last four columns are to be 0; what ends there is kept in `build/fuzz/found`.",
            "",
        ]
    )


def main() -> int:
    """Run the campaign; return 1 if an input ended badly."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=900.0)
    parser.add_argument("--seed", type=int, default=0, help="of a new campaign; one that is resumed keeps its own")
    parser.add_argument("--state", type=Path, default=ROOT / "build" / "fuzz" / "state.json")
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--page", type=Path, default=PAGE)
    options = parser.parse_args()
    counts = campaign(options.state, options.seed, options.seconds, options.kinds)
    options.page.write_text(
        page(counts, json.loads(options.state.read_text(encoding="utf-8"))["seed"]), encoding="utf-8"
    )
    print(page(counts, options.seed))  # noqa: T201
    return int(any(found[ending] for found in counts.values() for ending in BAD))


if __name__ == "__main__":
    raise SystemExit(main())
