"""Sentences of a goal, read as text: what is believed of the world, `exactly 2 x. Can(x) & On(x, table1)`."""

import re
from collections.abc import Iterator
from typing import Final

_BELIEF: Final = re.compile(r"\bB\s*\(")
_NAMED: Final = re.compile(r"\b(?:Den|Holds|Color|Weight|Pose)\s*\(")  # what is believed is no sentence then
# What only a sentence has outside of the arguments of words; `&` and And join facts of named objects too.
_MARK: Final = re.compile(
    r"[|=∃∀∨¬→≠!]|->|\b(?:not|exists|every|forall|exactly|at\s+least|at\s+most)\b|\b(?:Was|Exists|Or)\s*\("  # noqa: RUF001 - signs are meant
)


def sentences(goal: str) -> dict[str, str]:
    """Return the texts of a goal's sentences by their constants s1, s2, .. in order of appearance, each once."""
    found: dict[str, str] = {}
    for text in _believed(goal):
        if _MARK.search(text) and not _NAMED.search(text):
            found.setdefault(re.sub(r"\s", "", text), " ".join(text.split()))
    return {f"s{number}": text for number, text in enumerate(found.values(), 1)}


def _believed(goal: str) -> Iterator[str]:
    """Yield what stands before the bound of each belief."""
    for start in _BELIEF.finditer(goal):
        depth, end = 0, start.end()
        while end < len(goal) and (depth or goal[end] not in ",)"):
            depth += {"(": 1, ")": -1}.get(goal[end], 0)
            end += 1
        yield goal[start.end() : end].strip()
