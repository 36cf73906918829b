"""Print how a checkout is built, in figures: `python tests/house/figures.py [CHECKOUT ..]`.

Several checkouts, such as one of an older commit, are printed beside one another as a table in Markdown.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # run as a script, this file alone is found

from kit.imports import House, circles

FOLDERS = ("tools", "sim", "reasoner", "traces", "estimation")
LONG = 400  # lines of a file
OWN_BELIEF = (  # what a script with a belief of its own needs: the first of each line that there is
    (("Agent",),),
    (("Limits",),),
    (("PlainBelief",), ("BeliefQueries",)),
    (("load_rules",), ("Rulebook", "Queries")),
    (("parse_goal",),),
)


def figures(root: Path) -> Iterator[tuple[str, str]]:
    """Yield what is counted in a checkout, each with its number."""
    house = House.at(root)
    for folder in FOLDERS:
        arrows = side_by_side(house, folder)
        numbers = len(arrows), sum(map(len, arrows.values())), len(circles(arrows))
        yield f"{folder}: rooms, arrows, circles", ", ".join(map(str, numbers))
    yield "circles of files in the whole product", str(len(circles(house.arrows)))
    folder, longest = longest_list(house)
    yield "longest list a reader meets in one folder", f"{longest} ({folder})"
    yield f"files over {LONG} lines", str(sum(file.text.count("\n") > LONG for file in house.files.values()))
    tests = Counter(path.parent.relative_to(root).as_posix() for path in (root / "tests").rglob("test_*.py"))
    folder, most = max(sorted(tests.items()), key=lambda item: item[1], default=("no tests", 0))
    yield "test files, directories with test files", f"{tests.total()}, {len(tests)}"
    yield "most test files in one directory", f"{most} ({folder})"
    yield "lines of the product, Python", thousands(sum(file.text.count("\n") for file in house.files.values()))
    yield "lines of the rules", thousands(lines(root / "rules", "*.lp"))
    yield "lines of tests", thousands(lines(root / "tests", "*.py"))
    yield "lines of docs and README", thousands(lines(root / "docs", "*.md") + lines(root, "README.md", deep=False))
    modules = own_belief(house)
    yield "imports for a belief of one's own", f"{len(modules)}: {', '.join(modules)}"


def side_by_side(house: House, folder: str) -> dict[str, set[str]]:
    """Return what lies side by side in a folder, files and sub-folders, each with those that it imports from."""
    inside = {
        module: file.path.parts[1].removesuffix(".py")
        for module, file in house.files.items()
        if file.path.parts[0] == folder and file.path.name != "__init__.py"
    }
    arrows: dict[str, set[str]] = {name: set() for name in inside.values()}
    for module, name in inside.items():
        arrows[name] |= {inside[other] for other in house.arrows[module] if other in inside} - {name}
    return arrows


def longest_list(house: House) -> tuple[str, int]:
    """Return the folder of the product with the most files and sub-folders in it, and how many those are."""
    entries: dict[str, set[str]] = {}
    for file in house.files.values():
        for depth, part in enumerate(file.path.parts[1:], 1):
            entries.setdefault("/".join(file.path.parts[:depth]), set()).add(part)
    return max(((folder, len(names)) for folder, names in sorted(entries.items())), key=lambda item: item[1])


def own_belief(house: House) -> list[str]:
    """Return the modules, or faces where there are some, that a script with a belief of its own imports from."""
    offered = {name: face for face, names in sorted(house.faces.items(), reverse=True) for name in names}
    defined = {
        name: module
        for module, file in sorted(house.files.items())
        for name in (word for line in OWN_BELIEF for words in line for word in words)
        if f"\nclass {name}(" in file.text or f"\nclass {name}:" in file.text or f"\ndef {name}(" in file.text
    }
    found = defined | offered
    first = (next((words for words in line if all(word in found for word in words)), ()) for line in OWN_BELIEF)
    return sorted({found[word] for words in first for word in words})


def lines(folder: Path, pattern: str, deep: bool = True) -> int:
    """Return the number of lines in the files of a folder that fit a pattern."""
    found = folder.rglob(pattern) if deep else folder.glob(pattern)
    return sum(path.read_text(encoding="utf-8").count("\n") for path in found)


def thousands(number: int) -> str:
    """Return a number with a comma after the thousands."""
    return f"{number:,}"


def table(roots: list[Path]) -> str:
    """Return the figures of checkouts as a table, each checkout a column."""
    columns = [dict(figures(root)) for root in roots]
    rows = [["", *(root.resolve().name for root in roots)], ["---"] * (len(roots) + 1)]
    rows += [[name, *(column[name] for column in columns)] for name in columns[0]]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


if __name__ == "__main__":
    sys.stdout.write(table([Path(name) for name in sys.argv[1:]] or [Path(__file__).parents[2]]))
