"""Values that programs rarely expect, and changes of trees and texts by a keyed generator."""

import copy
from collections.abc import Iterator
from random import Random
from typing import Any, Final

HOSTILE: Final[tuple[Any, ...]] = (
    *(None, True, "", " ", 0, -1, 1, 2**31, 2**63, -(2**63) - 1, 10**400, 1e-320, 1e308, -1e308, 0.1 + 0.2, 1e-9),
    *(
        "nan",
        "inf",
        "\x1b[31m",
        "\u202eabc",
        "\ud7ff\U0001f600",
        "=HYPERLINK(1)",
        "<script>",
        "a" * 5000,
        "../../x",
        "/dev/null",
    ),
    *([], {}, [[]], {"a": 1}, [1, 2, 3], ["a"] * 2000, [0.0, 0.0, 0.0]),
)
TOKENS: Final = (
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ".",
    ":",
    ";",
    "\\n",
    "\n",
    "\t",
    "0",
    "9" * 30,
    '"',
    "'",
    "#",
    "%",
    "&",
    "|",
    "@",
    "\x00",
)

Path = tuple[str | int, ...]


def places(tree: Any, at: Path = ()) -> Iterator[Path]:
    """Yield the path of every node of a tree of dictionaries and lists, but its root."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield (*at, key)
        yield from places(value, (*at, key))


def changed(tree: Any, draw: Random, hostile: float) -> Any:
    """Return a copy of a tree with a few nodes changed: mildly, or with the given probability by a hostile value."""
    tree = copy.deepcopy(tree)
    for _ in range(draw.choice((1, 1, 1, 2, 3, 6))):
        found = list(places(tree))
        if found:
            _change(tree, draw.choice(found), draw, hostile)
    return tree


def _change(tree: Any, at: Path, draw: Random, hostile: float) -> None:
    holder = tree
    for key in at[:-1]:
        holder = holder[key]
    key, value = at[-1], holder[at[-1]]
    if draw.random() < hostile:
        kind = draw.randrange(5)
        if kind == 0:
            del holder[key]
        elif kind == 1 and isinstance(holder, list):
            holder.append(copy.deepcopy(value))
        elif kind == 1:
            holder[f"{key}{draw.choice(TOKENS)}"] = value
        else:
            holder[key] = draw.choice(HOSTILE)
    elif isinstance(value, bool):
        holder[key] = not value
    elif isinstance(value, int | float) and abs(value) < 1e300:
        holder[key] = type(value)(value * draw.uniform(0.7, 1.4))
    elif isinstance(value, list) and len(value) > 1 and not isinstance(value[0], int | float):
        draw.shuffle(value)


def garbled(text: str, draw: Random) -> str:
    """Return a text with a few pieces cut, repeated, moved or replaced."""
    for _ in range(draw.choice((1, 1, 2, 4))):
        begin = draw.randrange(len(text) + 1)
        end = min(len(text), begin + draw.choice((0, 1, 3, 10, 60)))
        piece = draw.choice(("", draw.choice(TOKENS), text[begin:end] * 2, "(" * draw.choice((1, 50, 600))))
        text = text[:begin] + piece + text[end:]
    return text
