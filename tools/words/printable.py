"""Text of a trace, fit for a terminal: whoever wrote the trace has no say over the screen of whoever reads it."""


def printable(text: str) -> str:
    r"""Return a line with every character that is not shown (escapes, line ends, changes of direction) as `\x1b`."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
