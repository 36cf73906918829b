"""Rules that would stop a run: rules about fluents that cannot be evaluated, words without a meaning, unknown commands.

They are found without a belief, on the shapes of `derivable`.
"""

import inspect
from collections.abc import Iterable, Iterator, Sequence
from difflib import get_close_matches
from typing import Final

from clingo.ast import AST, ASTType

from skolem.reasoner.lint.derivable import Kept, Shapes, Source, constants_of, kept, meet, shapes_of, stated
from skolem.reasoner.lint.fluent_kinds import ACTIVITIES, COMMANDS, FLUENTS, pattern, shape, sorted_pattern
from skolem.reasoner.planning.instances import title
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.planning.situation import QUANTITIES
from skolem.reasoner.rulebook.book import ABOUT_DESCRIPTIONS, Rulebook
from skolem.reasoner.rulebook.examination import Examined
from skolem.reasoner.rulebook.files import RuleFile
from skolem.reasoner.rulebook.validate import descend
from skolem.reasoner.rulebook.vocabulary import Vocabulary
from skolem.reasoner.terms import ANY, Compound, Term
from skolem.traces.errors import InputError
from skolem.traces.messages import HANDS

NOT_A_FLUENT: Final = "not_a_fluent"  # the code of all these findings; never allowed

_KINDS: Final[dict[type, str]] = {int: "a number", str: "a constant", Compound: "a tuple"}

Files = Sequence[tuple[RuleFile, Sequence[AST]]]
Found = Iterator[tuple[Source, str, str]]  # a rule, the code of its finding, a message


def refuse_wrong(rulebook: Rulebook) -> None:
    """Refuse rules that would stop a run.

    Raises:
        InputError: With a fault for each such rule.
    """
    files = files_about_steps(rulebook)
    found = wrong(shapes_of(files), files, rulebook.vocabulary)
    faults = sorted({source.fault(message) for source, _, message in found})
    if faults:
        raise InputError(faults)


def files_about_steps(rules: Rulebook | Examined) -> Files:
    """Return the rule files with their statements, without the file about descriptions."""
    return [(file, found) for file, found in rules.sources if file.name != ABOUT_DESCRIPTIONS]


def wrong(shapes: Shapes, files: Files, vocabulary: Vocabulary | None) -> Found:
    """Yield the rules that would stop a run.

    Args:
        shapes: The shapes that the rules derive.
        files: The rules.
        vocabulary: The meanings of words; None if some are not known, then words are not checked.
    """
    yield from _strangers(_spoken_of(shapes, files))
    heads = list(_heads(files))
    for source, (name, arity), args in heads:
        if (name, arity) in (("cost", 3), ("precond", 3)) and _is_no_bound(args[2]):
            yield source, NOT_A_FLUENT, f"{name}/3 ends in a whole number from 0, found {args[2]}"
    yield from _without_number(files)
    if vocabulary is not None:
        yield from _unknown_words(heads, files, vocabulary)
        yield from _other_quantities(heads, vocabulary)
        yield from _wrong_arguments(files, vocabulary)
    for (_, command), source in shapes.every("executes", 2):
        if all(meet(command, pattern(known)) is None for known in COMMANDS):
            yield source, NOT_A_FLUENT, f"the robot cannot carry out {title(command)}; there are: {', '.join(COMMANDS)}"


def _spoken_of(shapes: Shapes, files: Files) -> Iterator[tuple[Source, Term, list[Term]]]:
    """Yield every fluent in rules, with the patterns of the fluents that are allowed at that point."""
    spelt = [text.replace("activity", activity) for text in FLUENTS for activity in ACTIVITIES]
    evaluated = [pattern(text.replace("hand", hand)) for text in spelt for hand in HANDS]
    either = [*map(pattern, FLUENTS), *evaluated]
    yield from ((source, args[1], evaluated) for args, source in shapes.every("precond", 3))
    for name in ("result", "destroys"):
        yield from ((source, args[1], either) for args, source in shapes.every(name, 2))
    yield from ((source, fluent, either) for args, source in shapes.every("mutex", 2) for fluent in args)
    yield from ((source, fluent, either) for source, fluent in _asked(files))


def _strangers(spoken_of: Iterable[tuple[Source, Term, list[Term]]]) -> Found:
    """Yield fluents that neither the belief nor the geometry can answer."""
    for source, fluent, known in spoken_of:
        said = _without_variables(fluent)
        if all(meet(said, other) is None for other in known):
            message = "is not a fluent that the belief or the geometry can answer"
            yield source, NOT_A_FLUENT, f"{_named(fluent)} {message}; {_instead(fluent)}"


_Heads = Iterable[tuple[Source, tuple[str, int], tuple[Term, ...]]]


def _heads(files: Files) -> Iterator[tuple[Source, tuple[str, int], tuple[Term, ...]]]:
    """Yield the heads of rules with `any` for each variable, since the body is not read."""
    constants = constants_of(files)
    for file, statements in files:
        for statement in statements:
            if statement.ast_type is ASTType.Rule:
                yield from ((Source.of(file, statement), *found) for found in stated(statement, constants))


def _without_number(files: Files) -> Found:
    """Yield rules that write `any` for a cost or a level; in a pattern it would stand for what is not known yet."""
    for file, statements in files:
        for statement in statements:
            head = kept(statement).head.atom.symbol if statement.ast_type is ASTType.Rule else None
            for term in () if head is None else head.arguments if head.ast_type is ASTType.Pool else [head]:
                said = list(term.arguments) if term.ast_type is ASTType.Function else []
                if len(said) == 3 and term.name in ("cost", "precond") and str(said[2]) == ANY:
                    message = f"{term.name}/3 ends in a whole number from 0, found {ANY}"
                    yield Source.of(file, statement), NOT_A_FLUENT, message


def _is_no_bound(term: Term) -> bool:
    return term != ANY and not (isinstance(term, int) and term >= 0)


def _unknown_words(heads: _Heads, files: Files, vocabulary: Vocabulary) -> Found:
    """Yield words in fluents that have no meaning."""
    places = {("precond", 3): (1,), ("result", 2): (1,), ("destroys", 2): (1,), ("mutex", 2): (0, 1)}
    fluents = [(source, args[i]) for source, signature, args in heads for i in places.get(signature, ())]
    for source, fluent in [*fluents, *_asked(files)]:
        for word in (word for text in _of_kind(fluent) for word in _words(sorted_pattern(text), fluent)):
            yield from _no_word(source, word, str(fluent), vocabulary)


def _no_word(source: Source, word: str, place: str, vocabulary: Vocabulary) -> Found:
    known = sorted(vocabulary.meanings.keys() | vocabulary.types.keys())
    if word not in known:
        close = get_close_matches(word, known, 1)
        remedy = f"did you mean {close[0]}?" if close else f"there are: {', '.join(known)}"
        yield source, NOT_A_FLUENT, f"{word} in {place} has no meaning; {remedy}"


def _other_quantities(heads: _Heads, vocabulary: Vocabulary) -> Found:
    """Yield words that `measures/2` gives another quantity than their meaning has."""
    for source, signature, args in heads:
        meaning = vocabulary.meanings.get(str(args[0])) if signature == ("measures", 2) else None
        if meaning is not None and args[1] not in (ANY, meaning.quantity):
            said = f"{args[0]} is about the {meaning.quantity} of an object, and no {args[1]} can tell it"
            yield source, NOT_A_FLUENT, f"{said}; leave measures({args[0]}, {args[1]}) out"


def _wrong_arguments(files: Files, vocabulary: Vocabulary) -> Found:
    """Yield names in the arguments of queries that are of the wrong sort."""
    sorts = {"hand": HANDS, "quantity": QUANTITIES}
    constants = constants_of(files)
    for file, statements in files:
        for statement in statements:
            if "@" not in str(statement):
                continue
            source = Source.of(file, statement)
            for call in (n for n, kind in descend(statement) if kind is ASTType.Function and n.external):
                for (sort, kind), term in zip(_parameters(call.name), map(written, call.arguments), strict=False):
                    if term == ANY or str(term) in constants:
                        continue
                    if kind is not None and kind is not _kind(term):
                        yield source, NOT_A_FLUENT, f"{term} in {call} is no {sort}: expected {_KINDS[kind]}"
                    elif not isinstance(term, str) or kind is int:
                        continue
                    elif sort == "word":
                        yield from _no_word(source, term, str(call), vocabulary)
                    elif sort in sorts and term not in sorts[sort]:
                        yield (
                            source,
                            NOT_A_FLUENT,
                            f"{term} in {call} is no {sort}; there are: {', '.join(sorts[sort])}",
                        )


def _parameters(query: str) -> tuple[tuple[str, type | None], ...]:
    """Return the name of each argument of a query and the kind of term it must be; None for any kind."""
    found = getattr(Queries, query, None)
    parameters = list(inspect.signature(found).parameters.values())[1:] if inspect.isfunction(found) else []
    return tuple((each.name, each.annotation if each.annotation in _KINDS else None) for each in parameters)


def _kind(term: Term) -> type:
    """Return the kind of a written term: a number, a constant, or a function or tuple."""
    return int if str(term).lstrip("-").isdigit() else type(term)


def _words(place: Term, term: Term) -> Iterator[str]:
    """Yield the words in a term where a pattern of `FLUENTS` has a word or properties."""
    match place, term:
        case "word", str() if term != ANY:
            yield term
        case "properties", Compound():
            yield from (word for word in term.args if isinstance(word, str) and word != ANY)
        case Compound(), Compound():
            for inner, part in zip(place.args, term.args, strict=False):
                yield from _words(inner, part)


def _named(fluent: Term) -> str:
    """Return a fluent's name in a fault: its kind if the kind is unknown, else its text."""
    return str(fluent) if _of_kind(fluent) else shape(fluent)


def _instead(fluent: Term) -> str:
    """Return a hint at the fluents that may be meant."""
    if alike := _of_kind(fluent):
        sorts = {"activity": ACTIVITIES, "hand": HANDS}
        spelt = [f"{sort} is {', '.join(names)}" for sort, names in sorts.items() if any(sort in a for a in alike)]
        return "; ".join([f"expected {' or '.join(alike)}", *spelt])
    names = sorted({shape(pattern(text)) for text in FLUENTS})
    close = get_close_matches(shape(fluent), names, 1)
    return f"did you mean {close[0]}?" if close else f"there are: {', '.join(names)}"


def _of_kind(fluent: Term) -> list[str]:
    """Return the fluents of the table that are of the same kind."""
    return [text for text in FLUENTS if shape(pattern(text)) == shape(fluent)]


def _asked(files: Files) -> Iterator[tuple[Source, Term]]:
    """Yield the fluents that bodies take from goal/1."""
    for file, statements in files:
        for statement in statements:
            if statement.ast_type is not ASTType.Rule:
                continue
            for literal in kept(statement).body:
                atom = literal.atom.symbol if _is_goal(literal) else None
                if atom is not None:
                    yield Source.of(file, statement), written(atom.arguments[0])


def _is_goal(literal: Kept) -> bool:
    if literal.ast_type is not ASTType.Literal or literal.atom.ast_type is not ASTType.SymbolicAtom:
        return False
    symbol = literal.atom.symbol
    return bool(symbol.ast_type is ASTType.Function and (symbol.name, len(symbol.arguments)) == ("goal", 1))


def written(node: AST | Kept) -> Term:
    """Return a term as a pattern: names and functions as written, `any` for everything else."""
    if node.ast_type is ASTType.Function and not node.external:
        args = tuple(map(written, node.arguments))
        return Compound(node.name, args) if args or not node.name else node.name
    return str(node) if node.ast_type is ASTType.SymbolicTerm else ANY


def _without_variables(term: Term) -> Term:
    """Return a pattern of `mutex.lp` or `destroys/2` with `any` for `same`, `other` and `under`."""
    if not isinstance(term, Compound):
        return term
    if term.name in ("same", "other", "under"):
        return ANY
    return Compound(term.name, tuple(map(_without_variables, term.args)))
