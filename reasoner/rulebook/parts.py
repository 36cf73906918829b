"""Statements of rule files split into head and body, read from the text that clingo prints.

Asking a syntax tree for every node takes a hundred times as long as having a part printed, and the printed text is
regular. An atom is a name with arguments in brackets; only operators of comparisons have spaces on both sides; a
computed term stands in brackets of its own. Aggregates, conditions and texts are left to their trees.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from clingo.ast import AST, ASTType

VARIABLE: Final = re.compile(r"(?<![\w'])_*[A-Z][\w']*")
ANONYMOUS: Final = re.compile(r"(?<![\w'])_(?![\w'])")
_ATOM: Final = re.compile(r"(?P<sign>(?:not )*)(?P<name>_*[a-z][\w']*)(?:\((?P<arguments>.*)\))?")
_COMPARED: Final = re.compile(r" (=|!=|<|<=|>|>=) ")
_LEFT_TO_TREES: Final = re.compile(r'["{&]')
_FUNCTION: Final = re.compile(r"(?P<name>(?:_*[a-z][\w']*)?)\((?P<arguments>.*)\)")
_NOT: Final = "not "
_WITH_BODY: Final = (ASTType.Rule, ASTType.ShowTerm)
_MARK: Final = re.compile(r"[(),;]")

Signature = tuple[str, int]


@dataclass(frozen=True, slots=True, eq=False)
class Atom:
    """A predicate with arguments; a pool is several of the same name.

    Attributes:
        tree: Its literal.
        text: The text that clingo prints.
        sign: `not ` twice, once or not at all.
        name: Its predicate.
        pool: The arguments of each atom; one entry unless it is a pool.
    """

    tree: AST = field(repr=False)
    text: str
    sign: str
    name: str
    pool: tuple[tuple[str, ...], ...]

    @property
    def signatures(self) -> tuple[Signature, ...]:
        """The predicates in it."""
        return tuple((self.name, len(arguments)) for arguments in self.pool)

    @property
    def place(self) -> AST:
        """The part of its syntax tree whose position faults give."""
        symbol: AST = self.tree.atom.symbol
        return symbol


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Terms compared with each other.

    Attributes:
        tree: Its literal.
        text: The text that clingo prints.
        sign: As for an atom.
        terms: The compared terms.
        operators: The operators between the terms.
    """

    tree: AST = field(repr=False)
    text: str
    sign: str
    terms: tuple[str, ...]
    operators: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Nested:
    """Any other element: one that has parts of its own, or is not allowed.

    Attributes:
        tree: Its syntax tree.
        text: The text that clingo prints.
    """

    tree: AST = field(repr=False)
    text: str


Part = Atom | Comparison | Nested


@dataclass(frozen=True, slots=True, eq=False)
class Statement:
    """A statement of a rule file.

    Attributes:
        tree: Its syntax tree.
        kind: Type of the tree.
        head: Head of a rule; None for other statements.
        body: Elements of the body of a rule, or of a `#show` of terms.
    """

    tree: AST = field(repr=False)
    kind: ASTType
    head: Part | None
    body: tuple[Part, ...]

    @classmethod
    def of(cls, tree: AST) -> "Statement":
        """Return the statement of a syntax tree."""
        kind = tree.ast_type
        head = part_of(tree.head) if kind is ASTType.Rule else None
        return cls(tree, kind, head, tuple(map(part_of, tree.body)) if kind in _WITH_BODY else ())


def without_pools(statement: Statement) -> list[Statement]:
    """Return the statements into which the pools of one unfold; without pools, the statement itself."""
    pooled = any(isinstance(part, Atom) and len(part.pool) > 1 for part in (statement.head, *statement.body))
    return [Statement.of(tree) for tree in statement.tree.unpool(condition=False)] if pooled else [statement]


def part_of(tree: AST) -> Part:
    """Return the part of a syntax tree: a head or an element of a body."""
    text = str(tree)
    if tree.ast_type is not ASTType.Literal or _LEFT_TO_TREES.search(text):
        return Nested(tree, text)
    said = _COMPARED.split(text)
    if len(said) > 1:
        first = said[0].removeprefix(_NOT).removeprefix(_NOT)
        sign = text[: len(said[0]) - len(first)]
        return Comparison(tree, text, sign, (first, *said[2::2]), tuple(said[1::2]))
    match = _ATOM.fullmatch(text)
    if match is None:
        return Nested(tree, text)
    pool = ((),) if match["arguments"] is None else tuple(map(tuple, split(match["arguments"])))
    return Atom(tree, text, match["sign"], match["name"], pool)


def split(text: str) -> Iterator[list[str]]:
    """Yield the terms between two brackets, one list for each alternative of a pool."""
    depth, begun = 0, 0
    terms: list[str] = []
    for mark in _MARK.finditer(text):
        what, at = mark[0], mark.start()
        if what == "(":
            depth += 1
        elif what == ")":
            depth -= 1
        elif not depth:
            terms.append(text[begun:at])
            begun = at + 1
            if what == ";":
                yield terms if terms != [""] else []
                terms = []
    terms.append(text[begun:])
    yield terms if terms != [""] else []


def arguments_of(term: str) -> list[str] | None:
    """Return the arguments of a function or tuple; None for other terms, pools and computed terms."""
    match = _FUNCTION.fullmatch(term)
    if match is None:
        return None
    terms, *others = split(match["arguments"])
    if others or not terms or (not match["name"] and len(terms) == 1):
        return None
    return terms[:-1] if terms[-1] == "" else terms  # (X,) has one


def atom_text(name: str, arguments: Sequence[str]) -> str:
    """Return the text that clingo prints for an atom."""
    return f"{name}({','.join(arguments)})" if arguments else name
