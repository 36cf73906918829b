"""Mutants of a room: small changes of expressions, drawn by a seed."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from random import Random

import libcst as cst
from libcst.metadata import CodeRange, MetadataWrapper, PositionProvider
from mutmut.mutation.mutators import mutation_operators

ROOT = Path(__file__).resolve().parents[2]
SHOWN = 100  # characters of an expression in a report


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one module.

    Attributes:
        room: The room of the module.
        path: The module, from the root of the checkout.
        line: Number of the line where the changed expression starts, from 1.
        column: Column in that line, from 0.
        lines: First and last line of its statement; of a compound statement, of its head.
        before: The expression.
        after: The new expression.
        source: The whole changed module.
    """

    room: str
    path: str
    line: int
    column: int
    lines: tuple[int, int]
    before: str
    after: str
    source: str


@dataclass(frozen=True, slots=True)
class _Site:
    path: str
    text: str
    module: cst.Module
    node: cst.CSTNode
    others: tuple[cst.CSTNode, ...]
    line: int
    column: int
    lines: tuple[int, int]


def drawn(room: str, count: int, seed: int) -> list[Mutant]:
    """Return `count` mutants of a room, each of another expression, or all if there are fewer.

    Every expression is equally likely, and so is every mutant of an expression. Mutants with the bytecode of the
    original, or that are no Python, are left out.
    """
    draw = Random(f"{seed} {room}")
    sites = [site for path in sorted((ROOT / room).glob("*.py")) for site in _sites(path)]
    chosen: list[Mutant] = []
    for site in draw.sample(sites, len(sites)):
        if len(chosen) == count:
            break
        other = draw.choice(site.others)
        changed = site.module.deep_replace(site.node, other)
        assert isinstance(changed, cst.Module)
        if _is_another_program(site.text, source := changed.code):
            before, after = (_shown(site.module.code_for_node(node)) for node in (site.node, other))
            chosen.append(Mutant(room, site.path, site.line, site.column, site.lines, before, after, source))
    return sorted(chosen, key=lambda mutant: (mutant.path, mutant.line, mutant.column, mutant.before))


def _is_another_program(before: str, after: str) -> bool:
    try:
        return compile(before, "module", "exec") != compile(after, "module", "exec")
    except SyntaxError:
        return False


def _shown(code: str) -> str:
    line = " ".join(code.split())
    return line if len(line) <= SHOWN else f"{line[: SHOWN - 2]}.."


def _sites(path: Path) -> Iterator[_Site]:
    """Yield the expressions of a module that have mutants: those in bodies of functions, except annotations."""
    text = path.read_text(encoding="utf-8")
    wrapper = MetadataWrapper(cst.parse_module(text), unsafe_skip_copy=True)  # nobody else has its nodes
    places: Mapping[cst.CSTNode, CodeRange] = wrapper.resolve(PositionProvider)

    def walk(node: cst.CSTNode, statement: tuple[int, int], inside: bool) -> Iterator[_Site]:
        if isinstance(node, cst.FunctionDef):
            yield from walk(node.body, statement, True)
            return
        if isinstance(node, cst.Annotation):
            return
        if isinstance(node, cst.BaseStatement | cst.MatchCase | cst.ExceptHandler):
            statement = _head(node, places)
        others = tuple(other for kind, change in mutation_operators if isinstance(node, kind) for other in change(node))
        if inside and others:
            start = places[node].start
            at = str(path.relative_to(ROOT))
            yield _Site(at, text, wrapper.module, node, others, start.line, start.column, statement)
        for child in node.children:
            yield from walk(child, statement, inside)

    yield from walk(wrapper.module, (1, 1), False)


def _head(node: cst.CSTNode, places: Mapping[cst.CSTNode, CodeRange]) -> tuple[int, int]:
    """Return the first and last line of a statement without those of its body."""
    start, end = places[node].start.line, places[node].end.line
    inner = node.cases if isinstance(node, cst.Match) else getattr(getattr(node, "body", None), "body", ())
    if inner and not isinstance(node, cst.SimpleStatementLine):
        end = max(start, places[inner[0]].start.line - 1)
    return start, end
