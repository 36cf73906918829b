"""Measure, and write what was measured to docs/benchmarks.md: `python -m benchmarks [SECTION ..]`."""

import argparse
import sys
import time
from importlib import import_module
from typing import Final

from benchmarks.tables import keep_only, write

SECTIONS: Final = (
    "reasoner",
    "peers",
    "estimator",
    "detector",
    "detector_crowds",
    "replays",
    "viewer",
    "colours",
)  # modules of this folder; each has tables()


def main() -> None:
    """Run the benchmarks named on the command line; by default all of them, and other sections leave the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", help=f"of {', '.join(SECTIONS)}; all by default")
    names = parser.parse_args().sections or SECTIONS
    unknown = sorted(set(names) - set(SECTIONS))
    if unknown:
        parser.error(f"no section {unknown[0]!r}; there are: {', '.join(SECTIONS)}")
    begun, titles = time.monotonic(), []
    for name in names:
        for table in import_module(f"benchmarks.{name}").tables():
            write(table)
            titles.append(table.title)
            missed = sum(not target.met for target in table.targets)
            seconds = time.monotonic() - begun
            sys.stdout.write(f"{table}\n\n{seconds:6.0f} s  {table.title}: targets missed: {missed}\n\n")
            sys.stdout.flush()
    if set(names) == set(SECTIONS):
        keep_only(titles)


if __name__ == "__main__":
    main()
