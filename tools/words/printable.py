"""Text of a trace made safe for a terminal: a trace must not control the screen of its reader."""


def printable(text: str) -> str:
    r"""Return a line with every invisible character (escapes, line ends, changes of direction) written as `\x1b`."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
