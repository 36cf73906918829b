"""Lines as they are printed: on a terminal wrapped between words, elsewhere as long as they are."""

import shutil
import sys
import textwrap
from collections.abc import Iterable

from skolem.tools.words.printable import printable

HANGING = 4  # by so much the rest of a wrapped line is indented further than its beginning


def say(lines: Iterable[str], hanging: int = HANGING) -> None:
    """Print lines on standard output.

    Args:
        lines: What to print; characters that are not shown are printed as escapes.
        hanging: By how much the rest of a line is indented, beyond its own indentation, when it is wrapped.
    """
    found = [printable(line) for line in lines]
    if sys.stdout.isatty():
        width = shutil.get_terminal_size().columns
        found = [part for line in found for part in wrapped(line, width, hanging)]
    print("\n".join(found))


def wrapped(line: str, width: int, hanging: int = HANGING) -> list[str]:
    """Return a line in parts of at most `width` columns, broken between words; a longer word stands by itself."""
    if len(line) <= width:
        return [line]
    indent = len(line) - len(line.lstrip())
    rest = " " * min(indent + hanging, width // 2)
    return textwrap.wrap(
        line, width, subsequent_indent=rest, break_long_words=False, break_on_hyphens=False, drop_whitespace=True
    )
