"""Printed lines: wrapped between words on a terminal, of any length elsewhere."""

import shutil
import sys
import textwrap
from collections.abc import Iterable
from typing import TextIO

from skolem.tools.words.printable import printable, printable_lines

HANGING = 4  # additional indentation of the rest of a wrapped line


def say(lines: Iterable[str], hanging: int = HANGING) -> None:
    """Print lines on standard output.

    Args:
        lines: The lines; invisible characters are printed as escapes.
        hanging: Additional indentation of the rest of a wrapped line.
    """
    found = [printable(line) for line in lines]
    if sys.stdout.isatty():
        width = shutil.get_terminal_size().columns
        found = [part for line in found for part in wrapped(line, width, hanging)]
    print("\n".join(found))


def output(text: object = "", file: TextIO | None = None, end: str = "\n", flush: bool = False) -> None:
    """Print a text as `print` does, with invisible characters as escapes; every verb prints by this or by `say`."""
    print(printable_lines(str(text)), file=file, end=end, flush=flush)


def wrapped(line: str, width: int, hanging: int = HANGING) -> list[str]:
    """Return a line in parts of at most `width` columns, broken between words; a longer word is a part by itself."""
    if len(line) <= width:
        return [line]
    indent = len(line) - len(line.lstrip())
    rest = " " * min(indent + hanging, width // 2)
    return textwrap.wrap(
        line, width, subsequent_indent=rest, break_long_words=False, break_on_hyphens=False, drop_whitespace=True
    )
