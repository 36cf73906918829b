"""Warnings about rules that are allowed but hardly meant, such as preconditions that no step achieves.

The warnings need no belief; they come from the shapes of `derivable`. A comment `% allow CODE: why` above a rule
silences one that is intended.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Final

from clingo.ast import ASTType

from skolem.reasoner.lint.derivable import Shapes, Source, meet, shapes_of
from skolem.reasoner.lint.fluent_kinds import COMMANDS, FLUENTS, pattern, shape, sorted_pattern
from skolem.reasoner.lint.wrong_rules import Files, Found, files_about_steps, wrong
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.examination import Doubt, Examined
from skolem.reasoner.rulebook.files import RuleFile
from skolem.reasoner.rulebook.parts import Signature
from skolem.reasoner.rulebook.validate import OUTPUT
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.terms import ANY, Compound, Term
from skolem.traces.errors import Fault

CODES: Final = {  # code that may be allowed -> its meaning
    "unreachable": "a precondition that no operator and no inference rule brings about",
    "unused_result": "a result that no rule needs and no goal can ask for",
    "without_krd": "an operator on an object that need not be known by a rigid designator",
    "without_result": "a step that brings nothing about",
    "level_gap": "preconditions whose levels leave one out",
    "unobservable": "a property for which no operator yields the quantity",
}
_TURNS_ON: Final[dict[str, frozenset[Signature]]] = {  # predicates whose missing rules could remove a finding
    "unreachable": frozenset({("result", 2)}),
    "unused_result": frozenset({("precond", 3)}),
    "without_krd": frozenset({("precond", 3)}),
    "without_result": frozenset({("result", 2)}),
    "level_gap": frozenset({("precond", 3)}),
    "unobservable": frozenset({("result", 2), ("executes", 2), ("measures", 2)}) | OUTPUT,
}
NO_SUCH_CODE: Final = "no_such_code"  # for an allowance with an unknown code; never allowed itself
_ALLOW: Final = re.compile(r"%\s*allow (?P<code>\w+): (?P<reason>\S.*)")


@dataclass(frozen=True, slots=True, order=True)
class Finding:
    """A warning or an error about a rule.

    Attributes:
        fault: Position and message.
        code: One of `CODES`, `NO_SUCH_CODE` or `wrong_rules.NOT_A_FLUENT`.
        allowed: The reason in the file for allowing it; empty if it is not allowed.
    """

    fault: Fault
    code: str
    allowed: str = ""


def findings(rules: Rulebook | Examined) -> list[Finding]:
    """Return all findings about rules, allowed ones included, sorted by position.

    If rules have faults, only findings are returned that remain once the faults are mended.
    """
    doubt = rules.doubt if isinstance(rules, Examined) else Doubt()
    files = files_about_steps(rules)
    shapes = shapes_of(files, doubt.uncertain)
    refused = list(wrong(shapes, files, None if doubt.words else rules.vocabulary))
    sources = [source for source, _, _ in refused]
    doubtful = [*_unreachable(shapes), *_unused(shapes), *_steps(shapes)]
    doubtful += _unobservable(shapes, files, rules.vocabulary, doubt.words)
    sure = [finding for finding in doubtful if not doubt.about(_TURNS_ON[finding[1]])]
    found = refused + [finding for finding in sure if finding[0] not in sources]
    about_rules = {Finding(source.fault(message), code, _allowance(source, code)) for source, code, message in found}
    return sorted(about_rules.union(*(_misspelt(file) for file, _ in files)))


def _misspelt(file: RuleFile) -> Iterator[Finding]:
    """Yield a finding for each allowance with an unknown code."""
    for number, line in enumerate(file.content.decode(errors="replace").splitlines(), 1):
        match = _ALLOW.match(line)
        if match and match["code"] not in CODES:
            near = get_close_matches(match["code"], CODES, 1)
            meant = f"did you mean {near[0]}?" if near else f"there are: {', '.join(CODES)}"
            message = f"{match['code']!r} is nothing that can be allowed; {meant}"
            yield Finding(file.fault(number, match.start("code") + 1, message), NO_SUCH_CODE)


def _allowance(source: Source, code: str) -> str:
    """Return the reason for allowing a finding, from the comment directly above the rule; empty if there is none."""
    lines = source.file.content.decode().splitlines()
    above = source.line - 2
    while above >= 0 and lines[above].startswith("%"):
        match = _ALLOW.match(lines[above])
        if match and match["code"] == code:
            return match["reason"]
        above -= 1
    return ""


def _unreachable(shapes: Shapes) -> Found:
    given = [args[1] for args, _ in shapes.every("result", 2)]
    for source, fluents in _by_source(shapes, "precond", 3):
        if all(meet(fluent, other) is None for fluent in fluents for other in given):
            remedy = "it holds, or the step is not taken; let a step have it as its result"
            yield source, "unreachable", f"nothing brings about {_shapes(fluents)}: {remedy}"


def _unused(shapes: Shapes) -> Found:
    wanted = [args[1] for args, _ in shapes.every("precond", 3)]
    wanted += [pattern(text) for text, (_, by_goal) in FLUENTS.items() if by_goal]
    for source, fluents in _by_source(shapes, "result", 2):
        if all(meet(fluent, other) is None for fluent in fluents for other in wanted):
            remedy = "let a step need it, by precond/3, or leave it out"
            yield source, "unused_result", f"nothing needs {_shapes(fluents)}, and no goal can ask for it; {remedy}"


def _by_source(shapes: Shapes, name: str, arity: int) -> Iterator[tuple[Source, list[Term]]]:
    """Yield every rule of a predicate about fluents, with the shapes of its fluents."""
    sources: list[Source] = []
    fluents: list[list[Term]] = []
    for args, source in shapes.every(name, arity):
        if source not in sources:
            sources.append(source)
            fluents.append([])
        fluents[sources.index(source)].append(args[1])
    yield from zip(sources, fluents, strict=True)


def _shapes(fluents: Iterable[Term]) -> str:
    return " or ".join(sorted({shape(fluent) for fluent in fluents}))


# ---------------------------------------------------------------- steps


def _steps(shapes: Shapes) -> Found:
    results = {_functor(args[0]) for args, _ in shapes.every("result", 2)}
    places: dict[str, Source] = {}
    for (step,), source in shapes.every("step", 1):
        places.setdefault(_functor(step), source)
    for name, source in places.items():
        if name not in results and ANY not in (name, *results):
            remedy = f"state what it does by result(S, F) :- step(S), S = {_written(step)}, .."
            yield source, "without_result", f"{name} has no result: it is never taken; {remedy}"
        levels = {args[2] for args, _ in shapes.every("precond", 3) if _functor(args[0]) in (name, ANY)}
        numbers = sorted(level for level in levels if isinstance(level, int))
        missing = sorted(set(range(numbers[0], numbers[-1])) - set(numbers)) if numbers else []
        if missing:
            gap = f"{name} has no precondition of level {', '.join(map(str, missing))}"
            yield source, "level_gap", f"{gap}; number them without a gap, from {numbers[0]}"
    yield from _without_krd(shapes)


def _without_krd(shapes: Shapes) -> Found:
    needed = [args for args, _ in shapes.every("precond", 3)]
    sure = {_functor(step) for step, fluent, level in needed if shape(fluent) == "krd" and level == 0}
    reported = set()
    for (step, command), source in shapes.every("executes", 2):
        name = _functor(step)
        on_object = any(isinstance(c, Compound) and "object" in c.args for c in _known_commands(command))
        if on_object and name not in reported and sure.isdisjoint((name, ANY)):
            reported.add(name)
            yield source, "without_krd", f"{name} acts on an object but has no precond(S, krd(O), 0); add it"


# ---------------------------------------------------------------- words


def _unobservable(shapes: Shapes, files: Files, vocabulary: Vocabulary, incomplete: bool) -> Found:
    operators = {_functor(args[0]) for args, _ in shapes.every("executes", 2)}
    seen = [fluent for (step, fluent), _ in shapes.every("result", 2) if _functor(step) in operators]
    measured = [(args, source) for args, source in shapes.every("measures", 2)]
    for (word, quantity), source in measured:
        if isinstance(quantity, str) and quantity != ANY and not any(_gives(fluent, quantity) for fluent in seen):
            fluent = "b(type(O, T), P)" if quantity == "type" else f"bn({quantity}(O), V, S, T, P)"
            remedy = f"let a step that is carried out have the result {fluent}, or measure another quantity"
            yield source, "unobservable", f"no operator yields the {quantity} of an object; {remedy}"
        if word != ANY and word not in vocabulary.meanings and not incomplete:
            yield source, "unobservable", f"{word} is measured but has no meaning: state what it is, as colour/7 does"
    for word, meaning in vocabulary.meanings.items():
        fact = Compound("", (word, meaning.quantity))
        if all(meet(Compound("", args), fact) is None for args, _ in measured):
            remedy = f"state measures({word}, {meaning.quantity})."
            for source in _facts(files, word):
                yield source, "unobservable", f"nothing says how to observe it; {remedy}"


def _gives(fluent: Term, quantity: str) -> bool:
    wanted = "b(type(any,any),any)" if quantity == "type" else f"bn({quantity}(any),any,any,any,any)"
    return meet(fluent, pattern(wanted)) is not None


def _facts(files: Files, word: str) -> Iterator[Source]:
    """Yield the source of the fact that gives a word its meaning."""
    for file, statements in files:
        for statement in statements:
            symbol = statement.head.atom.symbol if statement.ast_type is ASTType.Rule else None
            if symbol is None or symbol.ast_type is not ASTType.Function or not symbol.arguments:
                continue
            if (symbol.name, len(symbol.arguments)) in OUTPUT and str(symbol.arguments[0]) == word:
                yield Source.of(file, statement)


# ---------------------------------------------------------------- reading the shapes


def _known_commands(command: Term) -> list[Term]:
    """Return the patterns of the known commands with the name of a command."""
    return [known for known in map(sorted_pattern, COMMANDS) if _functor(known) == _functor(command)]


def _written(term: Term) -> str:
    """Return a pattern in the notation of rules."""
    return str(Compound(term.name, ("_",) * len(term.args))) if isinstance(term, Compound) else str(term)


def _functor(term: Term) -> str:
    return term.name if isinstance(term, Compound) else str(term)
