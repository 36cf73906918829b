"""Printed lines: wrapped between words on a terminal, of any length elsewhere; output that is lost stops no command."""

import io
import os
import shutil
import sys
import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final, TextIO

from skolem.tools.words.printable import printable, printable_lines

STANDARD: Final = ("stdin", "stdout", "stderr")
HANGING = 4  # additional indentation of the rest of a wrapped line


if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class Lasting(io.FileIO):
    """An open file that takes everything: what cannot be written is dropped, and the reason is kept.

    Attributes:
        lost: The first error in writing; None if everything was written.
    """

    lost: OSError | None = None

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write, or drop the bytes if that fails."""
        try:
            return super().write(data)
        except OSError as error:
            self.lost = self.lost or error
            return memoryview(data).nbytes


def lasting_output() -> Lasting | None:
    """Let standard output and standard error take everything from now on, and return what the output is written to.

    A stream that was closed before the start gets /dev/null, so that no file that is opened later takes its number.
    """
    for number in range(len(STANDARD)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free
    _lasting(2)
    return _lasting(1)


def _lasting(number: int) -> Lasting | None:
    """Replace a standard stream of this process; None if it is not what the process was started with."""
    name = STANDARD[number]
    before: TextIO | None = getattr(sys, name)
    if before is not None:
        if before is not getattr(sys, f"__{name}__") or before.fileno() != number:
            return None
        before.flush()
    file = Lasting(number, "wb", closefd=False)
    stream = io.TextIOWrapper(
        io.BufferedWriter(file),
        encoding=before.encoding if before else "utf-8",
        errors="backslashreplace",
        line_buffering=number == 2 or file.isatty(),
    )
    setattr(sys, name, stream)
    return file


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
