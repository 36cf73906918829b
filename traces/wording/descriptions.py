"""Descriptions of a goal in words: `lambda x. Soda(x) & Green(x)` is the green soda.

The goal is read as text, without the reasoner's parser: that needs the rules of the run, and an older run is put into
words even if its rules can no longer be read.
"""

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from skolem.traces.wording.amounts import listed, spaced

# A description with its kind and its variable, as the reasoner reads them; `nearest` says what else it is of.
_LAMBDA: Final = re.compile(
    r"(?:\b(?P<kind>lambda|the|iota|heaviest|lightest|nearest)\s+|(?P<sign>[λι])\s*)"
    r"(?P<variable>\w+)(?:\s+to\s+\w+)?\s*\."
)
_SIGNS: Final = str.maketrans({"λ": "lambda ", "ι": "the ", "∧": "&", "∨": "|"})  # noqa: RUF001 - signs are meant
_SUPERLATIVES: Final = ("heaviest", "lightest")
_NOT: Final = "not__"  # begins the name of a complement
_OF: Final = re.compile(r",\s*(\w+)\s*\)")
_BOTH: Final = re.compile(r"(And|Or)\((.*),(.*)\)")


@dataclass(frozen=True, slots=True)
class Description:
    """One description of a goal.

    Attributes:
        text: Its text in the goal.
        words: Its properties, as constants of the rules, if it consists of properties alone.
        either: Whether one of them is enough.
        most: The superlative among all that have them, if there is one.
    """

    text: str
    words: tuple[str, ...] = ()
    either: bool = False
    most: str = ""

    def phrase(self, nouns: Collection[str]) -> str:
        """Return the described object: `the green thing`; the text in quotes if it has more than properties.

        Args:
            nouns: The words that name types of objects.
        """
        if not self.words:
            return f'what "{self.text}" describes'
        first = f"the {self.most}" if self.most else "the"
        kinds = [word for word in self.words if word in nouns]
        others = [spaced(word) for word in self.words if word not in nouns]
        if self.either and len(self.words) > 1:
            return f"{first} thing that is {' or '.join(predicate([word], nouns) for word in self.words)}"
        if len(kinds) > 1:
            return f"{first} thing that is {predicate(self.words, nouns)}"
        return " ".join([first, *others, *(map(spaced, kinds) if kinds else ["thing"])])


def predicate(words: Sequence[str], nouns: Collection[str]) -> str:
    """Return properties as a predicate: `green and heavy`, `a heavy can`, `not a can`."""
    lacking = [_lacking(word, nouns) for word in words if word.startswith(_NOT)]
    if lacking:
        rest = [word for word in words if not word.startswith(_NOT)]
        return listed([*([predicate(rest, nouns)] if rest else []), *lacking])
    kinds = [spaced(word) for word in words if word in nouns]
    others = [spaced(word) for word in words if word not in nouns]
    if not kinds:
        return listed(others)
    first, *rest = [" ".join([*others, kinds[0]]), *kinds[1:]]
    return listed([_with_article(each) for each in (first, *rest)])


def _lacking(word: str, nouns: Collection[str]) -> str:
    """Return the complement of a property as a predicate."""
    name, _, side = word.removeprefix(_NOT).partition("__")
    return f"{side} {spaced(name)}" if side else f"not {predicate([name], nouns)}"


def _with_article(name: str) -> str:
    return f"{'an' if name[:1] in 'aeiou' else 'a'} {name}"


def descriptions(goal: str) -> tuple[dict[str, Description], dict[str, str]]:
    """Return the descriptions of a goal by their constants e1, e2, .., and the constant of each variable or name.

    The constants number the different descriptions in order of appearance, as the reasoner does.
    """
    found: dict[object, str] = {}
    named: dict[str, Description] = {}
    of: dict[str, str] = {}
    for text, kind, variable, body, about in _lambdas(goal):
        description = _description(text, kind, variable, body)
        key: object = (kind, variable, description.words, description.either)
        if not description.words:
            key = re.sub(r"\s", "", text.translate(_SIGNS))
        constant = found.setdefault(key, f"e{len(found) + 1}")
        named.setdefault(constant, description)
        of.setdefault(about, constant)
    return named, of


def _lambdas(goal: str) -> Iterator[tuple[str, str, str, str, str]]:
    """Yield each lambda with its kind, its variable, its body, and the name or variable that it must denote."""
    for start in _LAMBDA.finditer(goal):
        depth, end = 0, start.end()
        while end < len(goal) and (depth or goal[end] not in ",)"):
            depth += {"(": 1, ")": -1}.get(goal[end], 0)
            end += 1
        about = _OF.match(goal, end)
        kind = (start["kind"] or start["sign"].translate(_SIGNS).strip()).replace("iota", "the")
        text, body = goal[start.start() : end].strip(), goal[start.end() : end]
        yield text, kind, start["variable"], body, about[1] if about else ""


def _description(text: str, kind: str, variable: str, body: str) -> Description:
    body = re.sub(r"\s", "", body.translate(_SIGNS))
    both = _BOTH.fullmatch(body)
    if both is not None:
        body = f"{both[2]}{'&' if both[1] == 'And' else '|'}{both[3]}"
    atoms = [re.fullmatch(rf"([A-Z]\w*)\({variable}\)", part) for part in re.split(r"[&|]", body)]
    if not all(atoms) or {"&", "|"} <= set(body) or kind == "nearest":
        return Description(text)
    words = tuple(spaced(atom[1]).replace(" ", "_") for atom in atoms if atom is not None)
    return Description(text, words, "|" in body, kind if kind in _SUPERLATIVES else "")
