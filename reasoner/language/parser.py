"""The parser of the goal language: recursive descent, with a position for every fault.

    goal   = { "exists" ["distinct"] name {"," name} "." } belief { "&" belief }
    belief = "B(" phi "," p ")" | "B(" quantity "," mu "," Sigma "," Delta "," p ")" | "KRD(" object ")"
    phi    = part { "&" part } | expr
    part   = "Den(" lambda "," object ")" | "Holds((" word {"," word} ")," object ")" | word "(" arguments ")"
    lambda = ("lambda" | "the" | "heaviest" | "lightest") name "." expr | "nearest" name "to" name "." expr
    expr   = expr "&" expr | expr "|" expr | "not" expr | "(" expr ")" | "Was(" expr ")" | word "(" arguments ")"
           | object "=" object | object "!=" object | "exists" name {"," name} "." expr
           | "every" name "." expr "->" expr | ("exactly" | "at least" | "at most") number name "." expr
           | "And(" expr "," expr ")" | "Or(" expr "," expr ")" | "Exists(" name "," expr ")"

`not` binds tighter than `&`, and `&` tighter than `|`; what follows the dot of a variable reaches as far to the right
as it can. The signs of the paper are read too (`cursor.ALIASES`). A phi of the form `expr` is a sentence: it names no
variable of the goal. A wrong structure stops the parser at once; wrong words, arities, variables, names and numbers are
all collected.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Final, TypeVar

from skolem.reasoner.language.cursor import ParseFault, Token, fault_at
from skolem.reasoner.language.description_parser import MAX_NUMBER, DescriptionParser
from skolem.reasoner.language.descriptions import And, Atom, Expression, Lambda
from skolem.reasoner.language.expressions import (
    DIMENSIONS,
    QUANTITIES,
    Believed,
    Conjunct,
    Den,
    Designated,
    Estimated,
    Goal,
    Holds,
    Phi,
    QuantityName,
    Sentence,
    Together,
)
from skolem.reasoner.terms import ANY
from skolem.traces.errors import InputError

# Words and signs that only a sentence has outside of arguments.
_OF_SENTENCES: Final = frozenset(
    {"not", "exists", "every", "exactly", "at", "Was", "Exists", "And", "Or", "|", "=", "!=", "->"}
)

_T = TypeVar("_T")


def parse_goal(text: str, words: Mapping[str, int], names: Collection[str] | None = None) -> Goal:
    """Return the goal that `text` states.

    Args:
        text: A goal in the notation above.
        words: Every known relation word with its number of arguments.
        names: Every known object; None accepts any name.

    Raises:
        InputError: With every fault, in the file "goal".
    """
    return _read(text, words, names, _Parser.goal)


def parse_lambda(text: str, words: Mapping[str, int], names: Collection[str] | None = None) -> Lambda:
    """Return the description that `text` states; arguments and errors as in `parse_goal`."""
    return _read(text, words, names, _Parser.description)


def read_goal(
    text: str, words: Mapping[str, int], names: Collection[str] | None = None
) -> tuple[Goal | None, list[tuple[int, str]]]:
    """Return the goal that `text` states and every fault of it as (offset, message), in order.

    The goal is None if its structure is wrong; with faults it is of no use. Arguments as in `parse_goal`.
    """
    return _attempt(text, words, names, _Parser.goal)


def _read(text: str, words: Mapping[str, int], names: Collection[str] | None, rule: Callable[["_Parser"], _T]) -> _T:
    value, faults = _attempt(text, words, names, rule)
    if value is None or faults:
        raise InputError(fault_at(text, offset, message) for offset, message in faults)
    return value


def _attempt(
    text: str, words: Mapping[str, int], names: Collection[str] | None, rule: Callable[["_Parser"], _T]
) -> tuple[_T | None, list[tuple[int, str]]]:
    parser, value = None, None
    try:
        parser = _Parser(text, words, names)
        value = rule(parser)
        parser.expect_end()
        faults = parser.faults
    except ParseFault as fault:
        faults = [*(parser.faults if parser else []), (fault.offset, fault.message)]
    return value, sorted(set(faults))


class _Parser(DescriptionParser):
    """A parser of descriptions that knows beliefs and goals too."""

    def goal(self) -> Goal:
        groups = self.heads()
        binders = [token for _, group in groups for token in group]
        for index, token in enumerate(binders):
            if token.text in [earlier.text for earlier in binders[:index]]:
                self.complain(token, f"variable {token.text!r} is bound twice")
        self.variables = tuple(dict.fromkeys(token.text for token in binders))
        conjuncts = self.conjunction()
        for token in binders:
            if token.text not in self.mentioned:
                self.complain(token, f"variable {token.text!r} is never used")
        distinct = tuple(tuple(token.text for token in group) for apart, group in groups if apart)
        return Goal(self.variables, tuple(conjuncts), distinct)

    def heads(self) -> list[tuple[bool, list[Token]]]:
        """Return each group of variables and whether it means different objects."""
        found = []
        while self.accept("exists"):
            apart = self.accept("distinct")
            group = self.binding_names()
            if apart and len(group) == 1:
                self.complain(group[0], "one variable alone is not distinct; write exists distinct o, p.")
            found.append((apart, group))
        return found

    def conjunction(self) -> list[Conjunct]:
        found = self.conjunct()
        while self.accept("&"):
            found += self.conjunct()
        self.refuse_or("between beliefs")
        return found

    def conjunct(self) -> list[Conjunct]:
        self.count_part()
        if self.accept("("):
            inner = self.conjunction()
            self.expect(")", " or '&'")
            return inner
        if self.accept("KRD"):
            self.expect("(")
            argument = self.object()
            self.expect(")")
            return [Designated(argument)]
        if len(self.ahead) > 1 and self.ahead[1].text in ("=", "!="):
            self.take()
            self.stop("expected B(phi, p) or KRD(o)")
        if not self.accept("B"):
            self.stop("expected B(phi, p), B(phi, mu, Sigma, Delta, p) or KRD(o)")
        self.expect("(")
        found = self.estimated() if self.token.text in QUANTITIES else self.believed()
        self.expect(")")
        return [found]

    def believed(self) -> Believed:
        phi: Phi = self.sentence() if self.is_sentence() else _joined(self.parts())
        self.refuse_or("between facts")
        self.expect(",", " and a probability")
        return Believed(phi, self.probability())

    def refuse_or(self, where: str) -> None:
        if self.token.text == "|":
            remedy = "it works inside a lambda: B(Den(lambda x. Green(x) | Red(x), o), 0.9)"
            self.stop_at(self.token, f"'|' cannot stand {where}; {remedy}")

    def is_sentence(self) -> bool:
        """Return whether what is believed has connectives or quantifiers outside of `Den(..)`."""
        outer = list(_outer(self.ahead))
        mark = next((token for token in outer if token.text in _OF_SENTENCES), None)
        if mark and mark.text != "|" and any(token.text in ("Den", "Holds") for token in outer):
            remedy = "write it inside of a description, Den(lambda x. Can(x) & not On(x, table1), o), or apart"
            self.stop_at(mark, f"{mark} cannot stand beside Den(..) or Holds(..); {remedy}: B(.., p) & B(.., p)")
        return bool(mark) and not any(token.text in ("Den", "Holds") for token in outer)

    def sentence(self) -> Phi:
        self.enter("sentence")
        body = self.expression()
        self.leave()
        atoms = _atoms_joined(body)
        return _joined(atoms) if atoms else Sentence(body)

    def parts(self) -> list[Den | Holds | Atom]:
        found = self.part()
        while self.accept("&"):
            found += self.part()
        return found

    def part(self) -> list[Den | Holds | Atom]:
        self.count_part()
        if self.accept("("):
            inner = self.parts()
            self.refuse_or("between facts")
            self.expect(")", " or '&'")
            return inner
        if self.accept("Den"):
            self.expect("(")
            description = self.description()
            self.expect(",", " and the object that the description denotes")
            argument = self.object()
            self.expect(")")
            return [Den(description, argument)]
        if self.accept("Holds"):
            return [self.holds()]
        return [self.atom("a fact such as Den(lambda x. Green(x), o), On(o, s) or Green(o)")]

    def holds(self) -> Holds:
        self.expect("(")
        self.expect("(", " and properties: Holds((Green, Can), o)")
        words = [self.word(1)]
        while self.accept(",") and self.token.text != ")":
            words.append(self.word(1))
        self.expect(")")
        self.expect(",", " and an object")
        argument = self.object()
        self.expect(")")
        return Holds(tuple(words), argument)

    def estimated(self) -> Estimated:
        quantity = QUANTITIES[self.take().text]
        self.expect("(")
        argument = self.object()
        self.expect(")")
        form = " of B(phi, mu, Sigma, Delta, p)"
        self.expect(",", " and mu" + form)
        mean = None if self.accept(ANY) else self.vector(quantity, "mu", -MAX_NUMBER)
        self.expect(",", " and Sigma" + form)
        sd = self.vector(quantity, "Sigma, as standard deviations,", 0.001)
        self.expect(",", " and Delta" + form)
        tolerance = self.vector(quantity, "Delta", 0.001)
        self.expect(",", " and p" + form)
        return Estimated(quantity, argument, mean, sd, tolerance, self.probability())

    def vector(self, quantity: QuantityName, name: str, least: float) -> tuple[float, ...]:
        first, found = self.token, []
        if self.accept("("):
            found.append(self.number())
            while self.accept(",") and self.token.text != ")":
                found.append(self.number())
            self.expect(")")
        else:
            found.append(self.number())
        if len(found) != DIMENSIONS[quantity]:
            self.complain(first, f"{name} of a {quantity} has {DIMENSIONS[quantity]} components, not {len(found)}")
        if not all(least <= component <= MAX_NUMBER for component in found):
            self.complain(first, f"{name} has components from {least:g} to {MAX_NUMBER:g}")
        return tuple(found)

    def probability(self) -> float:
        token, value = self.token, self.number()
        if not 0.0 < value < 1.0:
            self.complain(token, f"expected a probability between 0 and 1, both excluded, found {token.text}")
        return value


def _outer(tokens: Iterable[Token]) -> Iterator[Token]:
    """Yield the tokens up to the comma or the parenthesis that ends what is believed, without arguments of words."""
    calls: list[bool] = []  # of each open parenthesis: whether it holds the arguments of a word
    before = ""
    for token in tokens:
        if token.text == ")" or (token.text == "," and not calls):
            if not calls:
                return
            calls.pop()
        elif not any(calls):
            yield token
        if token.text == "(":
            calls.append(before[:1].isupper() and before not in _OF_SENTENCES)
        before = token.text


def _atoms_joined(expression: Expression) -> list[Atom]:
    """Return the atoms of a conjunction of atoms; none if it is anything else."""
    match expression:
        case Atom():
            return [expression]
        case And(left, right):
            first, second = _atoms_joined(left), _atoms_joined(right)
            return first + second if first and second else []
    return []


def _joined(parts: Sequence[Den | Holds | Atom]) -> Den | Holds | Atom | Together:
    return parts[0] if len(parts) == 1 else Together(tuple(parts))
