"""The reference of the rules, made from the comments, rules and words of their files."""

import inspect
import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Final

from clingo.ast import AST, ASTType

from skolem.reasoner.lint.derivable import Shapes, Source, meet, shapes_of
from skolem.reasoner.lint.fluent_kinds import FLUENTS, pattern, shape
from skolem.reasoner.lint.wrong_rules import files_about_steps
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.colours import in_words
from skolem.reasoner.rulebook.files import RuleFile
from skolem.reasoner.rulebook.vocabulary import WORD_FACTS, Vocabulary
from skolem.reasoner.terms import Compound, Term, prob
from skolem.traces.messages import HsvUnion, HsvVolume, TypeIs, WeightInterval

PARTS: Final = ("result", "precond", "cost", "destroys", "rejected", "executes", "immediate")
_HEADINGS: Final = {
    "result": "Achieves",
    "precond": "Needs",
    "cost": "Costs (-ln p, micro-nats)",
    "destroys": "May make false",
    "rejected": "Refused as",
    "executes": "Carried out as",
}
_BLOCK: Final = re.compile(r"%\*!\s*(?P<signature>[^\n]+)\n(?P<text>.*?)\*%", re.DOTALL)
_INTERFACE: Final = re.compile(r"(Input|Query|Use|Output):")
_ALLOWANCE: Final = re.compile(r"allow \w+: ")


@dataclass(frozen=True, slots=True)
class Clause:
    """One rule about a step.

    Attributes:
        says: The fluent, cost or command it gives.
        level: The first level that demands a precondition; empty for other parts.
        where: The rest of its body.
        comment: The comment above it.
        line: Its line in its file.
    """

    says: str
    level: str
    where: str
    comment: str
    line: int


@dataclass(frozen=True, slots=True)
class StepDoc:
    """An operator or inference rule.

    Attributes:
        signature: The step with its variables.
        operator: Whether it is an operator, not an inference rule.
        clauses: The rules about it, by part.
    """

    signature: str
    operator: bool
    clauses: dict[str, list[Clause]]


@dataclass(frozen=True, slots=True)
class FileDoc:
    """One rule file.

    Attributes:
        name: Its name without `.lp`.
        title: Its first line.
        about: The rest of its header.
        constants: Name, value and comment of every `#const`.
        predicates: Signature and text of every documented predicate.
        steps: The operators and inference rules it defines.
        exclusions: Pairs of `mutex/2` with their comment.
        others: Every other rule with its comment; those above refer to them.
    """

    name: str
    title: str
    about: str
    constants: list[tuple[str, str, str]]
    predicates: list[tuple[str, str]]
    steps: list[StepDoc]
    exclusions: list[tuple[str, str]]
    others: list[tuple[str, str]]


def sections(rulebook: Rulebook) -> dict[str, object]:
    """Return the reference as plain data: files, fluents, words, queries."""
    files = _files(rulebook)
    return {
        "files": [asdict(file) for file in files],
        "fluents": [dict(zip(("fluent", "means", "goal", "by"), row, strict=True)) for row in _fluents(rulebook)],
        "words": [dict(zip(("word", "means"), row, strict=True)) for row in _words(rulebook.vocabulary)],
        "queries": [dict(zip(("query", "answers"), row, strict=True)) for row in _queries()],
    }


def reference(rulebook: Rulebook) -> str:
    """Return the reference as a page of Markdown."""
    lines = [
        "# Reference of the rules",
        "",
        "Made from the rule files by `skolem rules doc -o docs/rules-reference.md`; a test compares the two.",
        "Variables and notation are those of the files (answer set programming). Bounds and costs are -ln p in "
        "micro-nats; a step's cost is the sum of its parts. A precondition of level n is demanded from level n of the "
        "hierarchy on.",
    ]
    for file in _files(rulebook):
        lines += _page(file)
    lines += ["", "## Fluents", "", *_rows(("fluent", "says", "in goals", "brought about by"), _fluents(rulebook))]
    lines += ["", "## Words", "", *_rows(("word", "means"), _words(rulebook.vocabulary))]
    lines += ["", "## Queries", "", "What rules may ask of the belief and the geometry, as `@name(..)`.", ""]
    lines += _rows(("query", "answer"), _queries())
    return "\n".join(lines) + "\n"


# ---------------------------------------------------------------- reading


def _files(rulebook: Rulebook) -> list[FileDoc]:
    shapes = shapes_of(files_about_steps(rulebook))
    return [_file(file, statements, shapes) for file, statements in rulebook.sources]


def _file(file: RuleFile, statements: Sequence[AST], shapes: Shapes) -> FileDoc:
    lines = file.content.decode().splitlines()
    header = [line.removeprefix("%").strip() for line in _leading(lines)]
    title = header[0].removeprefix("#").strip() if header and header[0].startswith("#") else file.name
    body = header[1:] if header and header[0].startswith("#") else header
    about = " ".join(line for line in body if line and not _INTERFACE.match(line))
    constants = [(s.name, str(s.value), _comment(lines, s)) for s in statements if s.ast_type is ASTType.Definition]
    blocks = [(m["signature"].strip(), _text(m["text"])) for m in _BLOCK.finditer(file.content.decode())]
    exclusions = [
        (f"{', '.join(map(str, s.head.atom.symbol.arguments))}", _group_comment(lines, s))
        for s in statements
        if _head(s) == "mutex"
    ]
    others = [(str(s), _comment(lines, s)) for s in statements if _is_other(s)]
    steps = _steps(file, statements, shapes, lines)
    return FileDoc(file.name, title, about, constants, blocks, steps, exclusions, others)


def _is_other(statement: AST) -> bool:
    """Return whether a statement is a rule that no other part of the page shows."""
    return statement.ast_type is ASTType.Rule and _head(statement) not in {*PARTS, *WORD_FACTS, "mutex", "operation"}


def _text(block: str) -> str:
    """Return the text of a doc block as Markdown: its arguments as a list."""
    text, _, arguments = block.strip().partition("Args:\n")
    return text.strip() + ("\n\n" + textwrap.dedent(arguments).rstrip() if arguments else "")


def _leading(lines: Sequence[str]) -> Iterator[str]:
    for line in lines:
        if not line.startswith("%") or line.startswith("%*"):
            return
        yield line


def _comment(lines: Sequence[str], statement: AST) -> str:
    """Return the comment lines directly above a statement."""
    above = statement.location.begin.line - 2
    found: list[str] = []
    while above >= 0 and lines[above].startswith("% "):
        found.insert(0, lines[above].removeprefix("%").strip())
        above -= 1
    return " ".join(line for line in found if not _ALLOWANCE.match(line))


def _group_comment(lines: Sequence[str], statement: AST) -> str:
    """Return the comment above the paragraph of a statement."""
    above = statement.location.begin.line - 1
    while above > 0 and lines[above - 1] and not lines[above - 1].startswith("%"):
        above -= 1
    return lines[above - 1].removeprefix("%").strip() if above and lines[above - 1].startswith("% ") else ""


def _head(statement: AST) -> str:
    symbol = statement.head.atom.symbol if statement.ast_type is ASTType.Rule else None
    return str(symbol.name) if symbol is not None and symbol.ast_type is ASTType.Function else ""


def _steps(file: RuleFile, statements: Sequence[AST], shapes: Shapes, lines: Sequence[str]) -> list[StepDoc]:
    names: dict[str, None] = {}
    for (step,), sources in shapes.of("step", 1).items():
        if isinstance(step, Compound) and any(source.name == file.name for source in sources):
            names[step.name] = None
    found = []
    for name in names:
        clauses = {
            part: [
                _clause(s, part, lines, about)
                for s in statements
                if _head(s) == part and (about := _about(Source.of(file, s), part, name, shapes))
            ]
            for part in PARTS
        }
        found.append(StepDoc(_signature(name, statements), bool(clauses["executes"]), clauses))
    return found


def _about(source: Source, part: str, name: str, shapes: Shapes) -> list[tuple[Term, ...]]:
    """Return the shapes of the atoms with which a rule gives a part of a named step."""
    arity = len(source.statement.head.atom.symbol.arguments)
    return [
        args
        for args, sources in shapes.of(part, arity).items()
        if isinstance(args[0], Compound) and args[0].name == name and source in sources
    ]


def _clause(statement: AST, part: str, lines: Sequence[str], about: Sequence[tuple[Term, ...]]) -> Clause:
    args = [str(argument) for argument in statement.head.atom.symbol.arguments]
    step = args[0]
    where = [str(literal) for literal in statement.body]
    where = [text for text in where if text != f"step({step})" and not text.startswith(f"{step} = ")]
    says = " = ".join(args[1:]) if part == "cost" else args[1] if len(args) > 1 else ""
    if part in ("result", "precond") and says.isidentifier():
        says += f": {', '.join(sorted({shape(each[1]) for each in about}))}"
    level = args[2] if part == "precond" else ""
    return Clause(says, level, "; ".join(where), _comment(lines, statement), statement.location.begin.line)


def _signature(name: str, statements: Iterable[AST]) -> str:
    """Return the head that writes the step with most detail."""
    written: list[AST] = []

    def note(node: AST) -> None:
        if node.ast_type is ASTType.Function and node.name == name and node.arguments:
            written.append(node)
        for argument in node.arguments if node.ast_type is ASTType.Function else ():
            note(argument)

    for statement in statements:
        if _head(statement):
            note(statement.head.atom.symbol)
    variables = [node for node in written if all(a.ast_type is ASTType.Variable for a in node.arguments)]
    return str((variables or written)[0]) if written else name


def _fluents(rulebook: Rulebook) -> list[tuple[str, str, str, str]]:
    shapes = shapes_of(files_about_steps(rulebook))
    rows = []
    for text, (means, by_goal) in FLUENTS.items():
        by = {
            step.name
            for step, fluent in shapes.of("result", 2)
            if isinstance(step, Compound) and meet(fluent, pattern(text)) is not None
        }
        by_text = ", ".join(sorted(by)) or "nothing"
        rows.append((f"`{text.replace(',', ', ')}`", means, "yes" if by_goal else "", by_text))
    return rows


def _words(vocabulary: Vocabulary) -> list[tuple[str, str]]:
    rows = []
    for word, meaning in vocabulary.meanings.items():
        match meaning:
            case TypeIs():
                kind = vocabulary.types[word]
                x, y, z = (round(1000 * size) for size in kind.size_m)
                grasp = "a hand can close on it" if kind.graspable else "no hand can close on it"
                rows.append((word, f"a {kind.shape} of {x} x {y} x {z} mm; {grasp}"))
            case HsvVolume() | HsvUnion():
                rows.append((word, f"colour: {'; or '.join(map(in_words, meaning.boxes))}"))
            case WeightInterval(at_least_kg=low, below_kg=high):
                below = "" if high is None else f", below {round(1000 * high)} g"
                rows.append((word, f"weight: at least {round(1000 * low)} g{below}"))
    rows += [(word, f"two objects at most {round(1000 * far)} mm apart") for word, far in vocabulary.near_m.items()]
    rows += [(word, f"the {quantity} of an object exceeds a number") for word, quantity in vocabulary.exceeds.items()]
    return rows


def _queries() -> list[tuple[str, str]]:
    rows = []
    for name, function in inspect.getmembers(Queries, inspect.isfunction):
        if not name.startswith("_"):
            parameters = list(inspect.signature(function).parameters)[1:]
            rows.append((f"`@{name}({', '.join(parameters)})`", " ".join((inspect.getdoc(function) or "").split())))
    return rows


# ---------------------------------------------------------------- writing


def _page(file: FileDoc) -> list[str]:
    lines = ["", f"## {file.title.rstrip('.')} (`{file.name}.lp`)"]
    lines += ["", file.about] if file.about else []
    if file.constants:
        rows = [(f"`{name}`", value, _readable(value, comment)) for name, value, comment in file.constants]
        lines += ["", *_rows(("constant", "value", "means"), rows)]
    for signature, text in file.predicates:
        lines += ["", f"### `{signature}`", "", text]
    for step in file.steps:
        kind = "operator" if step.operator else "inference rule"
        kind += ", expanded before anything else" if step.clauses["immediate"] else ""
        lines += ["", f"### `{step.signature}`: {kind}"]
        for part, heading in _HEADINGS.items():
            if step.clauses[part]:
                lines += ["", *_part(part, heading, step.clauses[part])]
    if file.others:
        others = [(_code(rule), comment) for rule, comment in file.others]
        lines += ["", *_rows(("rules that these refer to" if file.steps else "rules", "why"), others)]
    if file.exclusions:
        pairs = [(_code(pair), comment) for pair, comment in file.exclusions]
        lines += ["", *_rows(("exclude each other", "because"), pairs)]
    return lines


def _readable(value: str, comment: str) -> str:
    p = f"p = {prob(int(value)):.3g}" if value.isdecimal() and "-ln" in comment else ""
    return "; ".join(text for text in (comment, p) if text)


def _part(part: str, heading: str, clauses: Sequence[Clause]) -> list[str]:
    if part == "precond":
        rows = [(c.level, _code(c.says), _code(c.where), c.comment) for c in sorted(clauses, key=lambda c: c.level)]
        return _rows(("level", heading, "where", "why"), rows)
    return _rows((heading, "where", "why"), [(_code(c.says), _code(c.where), c.comment) for c in clauses])


def _code(text: str) -> str:
    return f"`{text}`" if text else ""


def _rows(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return rows in Markdown, without the columns that are empty in every row."""
    rows = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    used = [i for i in range(len(head)) if any(row[i] for row in rows)] or [0]
    lines = [[head[i] for i in used], ["---"] * len(used), *([row[i] for i in used] for row in rows)]
    return [f"| {' | '.join(cells)} |" for cells in lines]
