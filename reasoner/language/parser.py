"""The parser of the goal language: recursive descent, with a position for every fault.

    goal   = { "exists" name {"," name} "." } belief { "&" belief }
    belief = "B(" phi "," p ")" | "B(" quantity "," mu "," Sigma "," Delta "," p ")" | "KRD(" object ")"
    phi    = "Den(" lambda "," object ")" | "Holds((" word {"," word} ")," object ")" | word "(" arguments ")"
    lambda = "lambda" name "." expr
    expr   = expr "&" expr | expr "|" expr | "exists" name {"," name} "." expr | "(" expr ")" | word "(" arguments ")"
           | "And(" expr "," expr ")" | "Or(" expr "," expr ")" | "Exists(" name "," expr ")"

`&` binds tighter than `|`; the body of a lambda or an `exists` reaches as far to the right as it can. A wrong structure
stops the parser at once; wrong words, arities, variables, names and numbers are all collected.
"""

import math
import re
from collections.abc import Callable, Collection, Mapping
from difflib import get_close_matches
from typing import Final, TypeVar

from skolem.reasoner.language.cursor import REFUSED, Cursor, ParseFault, Token, fault_at
from skolem.reasoner.language.descriptions import (
    SPATIAL,
    And,
    Argument,
    Atom,
    Exists,
    Expression,
    Lambda,
    Name,
    Number,
    Object,
    Or,
    Variable,
)
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
    QuantityName,
    arguments_of,
)
from skolem.reasoner.terms import ANY
from skolem.traces.errors import InputError

MAX_NUMBER: Final = 1_000_000  # thousandths of it fit clingo's integers
KEYWORDS: Final = frozenset({"exists", "lambda", ANY, *REFUSED})
_OBJECT_NAME: Final = re.compile(r"_*[a-z]\w*", re.ASCII)

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


class _Parser(Cursor):
    """A cursor that knows the variables in scope, the relation words and the objects."""

    def __init__(self, text: str, words: Mapping[str, int], names: Collection[str] | None) -> None:
        super().__init__(text)
        self.words, self.names = words, names
        self.variables: tuple[str, ...] = ()
        self.bound: list[tuple[str, str]] = []  # (name in the text, unique name), innermost last
        self.binders: dict[str, str] = {}  # every unique name of this lambda, with its name in the text
        self.identifiers = {token.text for token in self.tokens if token.kind == "name"}

    # ---- goals

    def goal(self) -> Goal:
        binders = self.quantifiers()
        for index, token in enumerate(binders):
            if token.text in [earlier.text for earlier in binders[:index]]:
                self.complain(token, f"variable {token.text!r} is bound twice")
        self.variables = tuple(dict.fromkeys(token.text for token in binders))
        conjuncts = self.conjunction()
        used = {argument for conjunct in conjuncts for argument in arguments_of(conjunct)}
        for token in binders:
            if Variable(token.text) not in used:
                self.complain(token, f"variable {token.text!r} is never used")
        return Goal(self.variables, tuple(conjuncts))

    def quantifiers(self) -> list[Token]:
        found: list[Token] = []
        while self.accept("exists"):
            found += self.binding_names()
        return found

    def binding_names(self) -> list[Token]:
        found = [self.binding_name()]
        while self.accept(","):
            found.append(self.binding_name())
        self.expect(".", " after the variable")
        return found

    def binding_name(self) -> Token:
        if self.token.kind != "name" or not _OBJECT_NAME.fullmatch(self.token.text) or self.token.text in KEYWORDS:
            self.stop("expected a variable, a name that starts with a lower-case letter")
        return self.take()

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
        if not self.accept("B"):
            self.stop("expected B(phi, p), B(phi, mu, Sigma, Delta, p) or KRD(o)")
        self.expect("(")
        found = self.estimated() if self.token.text in QUANTITIES else self.believed()
        self.expect(")")
        return [found]

    def believed(self) -> Believed:
        phi = self.phi()
        self.refuse_or("between facts")
        self.expect(",", " and a probability")
        return Believed(phi, self.probability())

    def refuse_or(self, where: str) -> None:
        if self.token.text == "|":
            remedy = "it works inside a lambda: B(Den(lambda x. Green(x) | Red(x), o), 0.9)"
            raise ParseFault(self.token.offset, f"'|' cannot stand {where}; {remedy}")

    def phi(self) -> Den | Holds | Atom:
        if self.accept("Den"):
            self.expect("(")
            description = self.description()
            self.expect(",", " and the object that the description denotes")
            argument = self.object()
            self.expect(")")
            return Den(description, argument)
        if self.accept("Holds"):
            return self.holds()
        return self.atom("a fact such as Den(lambda x. Green(x), o), On(o, s) or Green(o)")

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

    # ---- descriptions

    def description(self) -> Lambda:
        if not self.accept("lambda"):
            self.stop("expected 'lambda x. ..'")
        self.bound, self.binders = [], {name: name for name in self.variables}
        token = self.binding_name()
        self.expect(".", " after the variable")
        variable = self.bind(token)
        body = self.expression()
        self.bound.clear()
        return Lambda(variable, body)

    def bind(self, token: Token) -> str:
        """Open the scope of a variable and return a name that is unique in this description."""
        unique, count = token.text, 1
        while unique in self.binders or (count > 1 and unique in self.identifiers):
            count += 1
            unique = f"{token.text}_{count}"
        self.binders[unique] = token.text
        self.bound.append((token.text, unique))
        return unique

    def expression(self) -> Expression:
        found = self.all_of()
        while self.accept("|"):
            found = Or(found, self.all_of())
        return found

    def all_of(self) -> Expression:
        found = self.unit()
        while self.accept("&"):
            found = And(found, self.unit())
        return found

    def unit(self) -> Expression:
        self.count_part()
        if self.accept("("):
            found = self.expression()
            self.expect(")", ", '&' or '|'")
            return found
        if self.accept("exists"):
            return self.quantified(self.binding_names())
        if self.accept("Exists"):
            self.expect("(")
            token = self.binding_name()
            self.expect(",", " and what holds of it")
            found = self.quantified([token])
            self.expect(")")
            return found
        if self.token.text in ("And", "Or"):
            return self.connective(And if self.take().text == "And" else Or)
        return self.atom("an expression such as Green(x)")

    def connective(self, kind: type[And] | type[Or]) -> Expression:
        self.expect("(")
        found = self.expression()
        self.expect(",", f" and what else {kind.__name__} joins")
        found = kind(found, self.expression())
        while self.accept(","):
            found = kind(found, self.expression())
        self.expect(")")
        return found

    def quantified(self, tokens: list[Token]) -> Expression:
        unique = [self.bind(token) for token in tokens]
        for _ in tokens:
            self.count_part()
        found = self.expression()
        del self.bound[len(self.bound) - len(tokens) :]
        for name in reversed(unique):
            found = Exists(name, found)
        return found

    def atom(self, expected: str) -> Atom:
        first = self.token
        if first.kind != "name" or not first.text[0].isupper() or self.is_refused(first):
            self.stop(f"expected {expected}")
        self.take()
        self.expect("(", f" after the relation {first.text!r}")
        objects_only = first.text in SPATIAL or self.words.get(first.text) == 1 or not self.bound
        args = [self.argument(objects_only)]
        while self.accept(","):
            args.append(self.argument(objects_only))
        self.expect(")", " or ','")
        self.check_word(first, len(args))
        return Atom(first.text, tuple(args))

    # ---- words, objects, numbers

    def word(self, arity: int) -> str:
        if self.token.kind != "name" or not self.token.text[0].isupper() or self.is_refused(self.token):
            self.stop("expected a property such as Green")
        self.check_word(self.token, arity)
        return self.take().text

    def is_refused(self, token: Token) -> bool:
        return token.text.lower() in REFUSED and token.text not in self.words

    def check_word(self, token: Token, arity: int) -> None:
        if token.text not in self.words:
            self.complain(token, f"no relation {token.text!r}{_hint(token.text, self.words)}")
        elif self.words[token.text] != arity:
            wanted = self.words[token.text]
            self.complain(token, f"{token.text} takes {wanted} argument{'s' * (wanted != 1)}, not {arity}")

    def argument(self, objects_only: bool) -> Argument:
        if self.token.kind == "number":
            if objects_only:
                self.complain(self.token, f"expected an object, found the number {self.token.text}")
            elif abs(float(self.token.text)) > MAX_NUMBER:
                self.complain(self.token, f"{self.token.text} is too large a number; at most {MAX_NUMBER}")
            return Number(self.number())
        return self.object()

    def object(self) -> Object:
        token = self.token
        if token.kind != "name" or not _OBJECT_NAME.fullmatch(token.text) or token.text in KEYWORDS:
            self.stop("expected a variable or the name of an object, which start with a lower-case letter")
        self.take()
        for name, unique in reversed(self.bound):
            if name == token.text:
                return Variable(unique)
        if token.text in self.variables:
            if self.bound:
                self.complain(token, f"variable {token.text!r} of the goal cannot stand inside a description")
            return Variable(token.text)
        if self.names is not None and token.text not in self.names:
            if token.text in self.binders.values():
                self.complain(token, f"variable {token.text!r} is not bound here")
            else:
                hint = _hint(token.text, self.names)
                self.complain(token, f"{token.text!r} is neither a bound variable nor a known object{hint}")
        return Name(token.text)

    def number(self) -> float:
        if self.token.kind != "number":
            self.stop("expected a number")
        value = float(self.token.text)
        if not math.isfinite(value):
            self.complain(self.token, f"{self.token.text} is too large a number")
        self.take()
        return value

    def probability(self) -> float:
        token, value = self.token, self.number()
        if not 0.0 < value < 1.0:
            self.complain(token, f"expected a probability between 0 and 1, both excluded, found {token.text}")
        return value


def _hint(wrong: str, known: Collection[str]) -> str:
    close = get_close_matches(wrong, sorted(known), 1)
    if close:
        return f"; did you mean {close[0]!r}?"
    return f" (known: {', '.join(sorted(known))})" if known else ""
