"""Ground terms as plain values, the codec to clingo symbols, and probabilities as integer micro-nats.

A term is an integer, a constant (`str`) or a compound. Fluents, steps and expressions are all terms; their text is the
text of answer set programming, `b(den(e1,var(o)),105361)`.

May import: nothing.
"""

import math
import re
from collections.abc import Mapping
from functools import lru_cache, total_ordering
from typing import Final

import clingo

ANY: Final = "any"  # in a pattern, stands for every term
MICRO: Final = 1_000_000
CAP_MICRONATS: Final = 50 * MICRO  # p = 2e-22; 42 such costs still sum within clingo's 32 bits
DEEPEST: Final = 200  # functions around a term; twice what a rule file may write in one
_MEMORY: Final = 1 << 14  # terms whose symbol, and texts whose term, are remembered
_PART: Final = re.compile(r"([^(),]*)([(),]|$)")  # in a symbol's text: a name or nothing, and the mark that ends it
_DEEPENING: Final = re.compile(r"[()+*/\\&?^~|]|-(?!\d)")
_FOREIGN: Final = re.compile(r'["#]|-(?!\d)')  # marks of a symbol's text that no term has


@total_ordering
class Compound:
    """A function or tuple with arguments; immutable, equal and ordered by its text.

    Attributes:
        name: Its functor; empty for a tuple.
        args: Its arguments; empty only for the empty tuple.
    """

    __slots__ = ("_hash", "_text", "args", "name")
    __match_args__ = ("name", "args")
    name: str
    args: tuple["Term", ...]
    _text: str
    _hash: int

    def __init__(self, name: str, args: tuple["Term", ...]) -> None:
        text = f"{name}({','.join(map(str, args))}{',' if not name and len(args) == 1 else ''})"
        set_once = object.__setattr__
        set_once(self, "name", name)
        set_once(self, "args", args)
        set_once(self, "_text", text)
        set_once(self, "_hash", hash(text))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a term is immutable; cannot set {name!r}")

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"Compound({self.name!r}, {self.args!r})"

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Compound) and self._text == other._text

    def __lt__(self, other: object) -> bool:
        return self._text < str(other) if isinstance(other, Compound | str | int) else NotImplemented

    def __reduce__(self) -> tuple[type["Compound"], tuple[str, tuple["Term", ...]]]:
        return Compound, (self.name, self.args)


Term = int | str | Compound


def compound(name: str, *args: Term) -> Compound:
    """Return the compound `name(args...)`; a tuple if `name` is empty."""
    return Compound(name, args)


@lru_cache(_MEMORY)
def to_symbol(term: Term) -> clingo.Symbol:
    """Return the clingo symbol of a term.

    Raises:
        OverflowError: If an integer does not fit 32 bits.
    """
    if isinstance(term, int):
        return clingo.Number(term)
    if isinstance(term, str):
        return clingo.Function(term, [])
    return clingo.Function(term.name, [to_symbol(argument) for argument in term.args])


@lru_cache(_MEMORY)
def from_symbol(symbol: clingo.Symbol) -> Term:
    """Return the term of a clingo symbol.

    Raises:
        ValueError: For strings, `#inf`, `#sup` and classically negated functions, which the rules do not use.
    """
    return read_term(str(symbol))


@lru_cache(_MEMORY)
def read_term(text: str) -> Term:
    """Return the term of the symbol that clingo prints as `text`.

    Reading the text is cheaper than asking clingo for each part.

    Raises:
        ValueError: As `from_symbol`.
    """
    if _FOREIGN.search(text) or text.count("(") != text.count(")"):
        raise ValueError(f"{text} is not a term of the rules: expected an integer, a constant, f(..) or a tuple")
    around: list[tuple[str, list[Term]]] = []  # compounds that are not closed yet: name and arguments so far
    args: list[Term] = []
    name = ""
    for word, end in _PART.findall(text):
        if end == "(":
            around.append((name, args))
            name, args = word, []
            if len(around) > DEEPEST:
                raise ValueError(f"a term with more than {DEEPEST} functions around one another: {text[:30]}..")
            continue
        if word:
            args.append(word if word[0] not in "-0123456789" else int(word))
        if end == ")":
            closed = Compound(name, tuple(args))
            name, args = around.pop()
            args.append(closed)
    return args[0]


def parse_term(text: str) -> Term:
    """Return the ground term written in `text`.

    Raises:
        ValueError: If it is not a ground term.
    """
    if _depth(text) > DEEPEST:
        raise ValueError(f"a term with more than {DEEPEST} functions or signs around one another: {text[:30]}..")
    complaints: list[str] = []
    try:
        symbol = clingo.parse_term(text, logger=lambda _code, message: complaints.append(message.strip()))
    except RuntimeError as error:
        raise ValueError(f"{text!r} is not a ground term: {' '.join(complaints) or error}") from error
    return from_symbol(symbol)


def _depth(text: str) -> int:
    """Return how deep a written term can be at most: clingo calls itself for each bracket and each sign."""
    deepest = depth = signs = 0
    for mark in _DEEPENING.findall(text):
        if mark in "()":
            depth += 1 if mark == "(" else -1
            deepest = max(deepest, depth)
        else:
            signs += 1
    return deepest + signs


def substitute(term: Term, binding: Mapping[Term, Term]) -> Term:
    """Return `term` with its subterms replaced as `binding` maps them, outermost first."""
    if term in binding:
        return binding[term]
    if not isinstance(term, Compound):
        return term
    args = tuple(substitute(argument, binding) for argument in term.args)
    return term if args == term.args else Compound(term.name, args)


def matches(pattern: Term, term: Term) -> bool:
    """Return whether `term` is an instance of `pattern`.

    In a pattern the constant `any` stands for every term, `under(N)` for every integer below N.
    """
    if pattern == ANY:
        return True
    if isinstance(pattern, Compound) and pattern.name == "under":
        limit = pattern.args[0]
        return isinstance(term, int) and isinstance(limit, int) and term < limit
    if not isinstance(pattern, Compound) or not isinstance(term, Compound):
        return pattern == term
    same_shape = pattern.name == term.name and len(pattern.args) == len(term.args)
    return same_shape and all(map(matches, pattern.args, term.args))


def nll(p: float) -> int:
    """Return -ln p in micro-nats, between 0 (p >= 1) and `CAP_MICRONATS` (p <= 2e-22).

    Raises:
        ValueError: If p is not a number.
    """
    if math.isnan(p):
        raise ValueError("a probability is not a number")
    if p >= 1.0:
        return 0
    if p <= 0.0:
        return CAP_MICRONATS
    return min(CAP_MICRONATS, round(-math.log(p) * MICRO))


def prob(micronats: int) -> float:
    """Return the probability whose -ln is `micronats` millionths."""
    return math.exp(-micronats / MICRO)
