"""Draw mutants, check them by the tests of their rooms, and check the survivors by the recorded runs.

`python -m benchmarks.mutants -o out/mutants.jsonl`; the same command goes on where it was interrupted.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from benchmarks.mutants.checking import apart, name, rows, said, summary
from benchmarks.mutants.drawing import ROOT, drawn

ROOMS: Final[Mapping[str, tuple[int, tuple[str, ...]]]] = {  # how many mutants by default, and the tests of the room
    "reasoner": (84, tuple(sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("tests/reasoner/test_*.py")))),
    "reasoner/language": (84, ("tests/reasoner/language",)),
    "reasoner/rulebook": (84, ("tests/reasoner/rulebook",)),
    "reasoner/planning": (84, ("tests/reasoner/planning",)),
    "reasoner/lint": (40, ("tests/reasoner/lint",)),  # each of these tests reads all rules
    "estimation": (128, ("tests/estimation",)),
}
REPLAYS: Final = ("tests/traces/compare/test_golden.py",)


def main() -> None:
    """Check mutants of the rooms named on the command line; by default of all rooms."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"of {', '.join(ROOMS)}; all by default")
    parser.add_argument("--seed", type=int, default=0, help="decides which mutants are drawn")
    parser.add_argument("--each", type=int, help="how many mutants of each room; by default 504 of all rooms together")
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "out" / "mutants.jsonl", help="a line for each result")
    options = parser.parse_args()
    rooms = options.rooms or list(ROOMS)
    if unknown := sorted(set(rooms) - ROOMS.keys()):
        parser.error(f"no room {unknown[0]!r}; there are: {', '.join(ROOMS)}")
    options.out.parent.mkdir(parents=True, exist_ok=True)
    mutants = [mutant for room in rooms for mutant in drawn(room, options.each or ROOMS[room][0], options.seed)]
    for room in rooms:
        apart("room", ROOMS[room][1], [mutant for mutant in mutants if mutant.room == room], options.out)
    alive = {name(row) for row in rows(options.out) if row["outcome"] in ("survived", "uncovered")}
    apart("replays", REPLAYS, [mutant for mutant in mutants if name(said("room", mutant)) in alive], options.out)
    wanted = {name(said("room", mutant)) for mutant in mutants}
    sys.stdout.write(summary([row for row in rows(options.out) if name(row) in wanted]))


if __name__ == "__main__":
    main()
