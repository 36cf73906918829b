"""Text from files, fit for terminals, tables and reports: whoever wrote a file has no power over those who read it."""

import re
from typing import Final

_FORMULA: Final = re.compile(r"[=+\-@\t\r]")  # begins a cell that spreadsheets compute
_NUMBER: Final = re.compile(r"[+-]?\d+(\.\d*)?(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
_MARKDOWN: Final = re.compile(r"[\\`*\[\]<>|&]")


def printable(text: str) -> str:
    r"""Return a line with every invisible character (escapes, line ends, changes of direction) written as `\x1b`."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def printable_lines(text: str) -> str:
    """Return a text of several lines, each of them printable; only a line feed ends one."""
    return text if text.isascii() and text.isprintable() else "\n".join(map(printable, text.split("\n")))


def cell(text: str) -> str:
    """Return a text as a cell of a CSV file that no spreadsheet takes for a formula."""
    shown = printable(text)
    return f"'{shown}" if _FORMULA.match(shown) and not _NUMBER.fullmatch(shown) else shown


def markdown(text: str) -> str:
    """Return a text as it stands in Markdown or HTML: nothing in it is a mark, a tag or the end of a cell."""
    return _MARKDOWN.sub(lambda mark: f"&#{ord(mark[0])};", printable(text))
