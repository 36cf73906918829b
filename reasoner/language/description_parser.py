"""The parser of descriptions and of what they say; its grammar stands in `parser`."""

import math
import re
from collections.abc import Collection, Mapping
from typing import Final, get_args

from skolem.reasoner.language.cursor import Cursor, Token
from skolem.reasoner.language.descriptions import (
    SPATIAL,
    And,
    Argument,
    Atom,
    Count,
    CountKind,
    DescriptionKind,
    Every,
    Exists,
    Expression,
    Lambda,
    Name,
    Not,
    Number,
    Object,
    Or,
    Same,
    Variable,
    Was,
)
from skolem.reasoner.language.remedies import KEYWORDS, hint, hint_at_keyword, remedy_of_word

MAX_NUMBER: Final = 1_000_000  # thousandths of it fit clingo's integers
MAX_COUNT: Final = 20
MAX_BINDERS: Final = 4  # inside one another, besides that of a description; each multiplies what is tried
KINDS: Final[tuple[DescriptionKind, ...]] = get_args(DescriptionKind)
_OBJECT_NAME: Final = re.compile(r"_*[a-z]\w*", re.ASCII)


class DescriptionParser(Cursor):
    """A cursor that knows the variables in scope, the relation words and the objects."""

    def __init__(self, text: str, words: Mapping[str, int], names: Collection[str] | None) -> None:
        super().__init__(text, words)
        self.names = names
        self.variables: tuple[str, ...] = ()  # of the goal
        self.mentioned: set[str] = set()  # those of them that stand for an object somewhere
        self.inside = ""  # what is parsed: a description, a sentence or, if empty, neither
        self.bound: list[tuple[str, str]] = []  # (name in the text, unique name), innermost last
        self.binders: dict[str, str] = {}  # every unique name of this expression, with its name in the text
        self.identifiers = {token.text for token in self.tokens if token.kind == "name"}

    # ---- descriptions

    def description(self) -> Lambda:
        """Read a description."""
        kind = next((each for each in KINDS if self.accept(each)), None)
        if kind is None:
            self.stop("expected a description such as lambda x. Can(x) or the x. Can(x)")
        self.enter("description")
        token = self.binding_name()
        to = self.nearest_to() if kind == "nearest" else None
        self.expect(".", " after the variable")
        variable = self.bind(token)
        body = self.expression()
        self.leave()
        return Lambda(variable, body, kind, to)

    def enter(self, what: str) -> None:
        """Begin a description or a sentence."""
        self.inside, self.bound, self.binders = what, [], {name: name for name in self.variables}

    def leave(self) -> None:
        """End a description or a sentence."""
        self.inside, self.bound = "", []

    def nearest_to(self) -> Name:
        """Read what follows the variable of `nearest`."""
        self.expect("to", " and the name of an object: nearest x to table1. Can(x)")
        token = self.token
        if token.text in self.variables:
            self.complain(token, f"expected the name of an object after 'to', found the variable {token}")
            return Name(self.take().text)
        return Name(self.object().name)

    def binding_names(self) -> list[Token]:
        """Read variables and the dot after them."""
        found = [self.binding_name()]
        while self.accept(","):
            found.append(self.binding_name())
        self.expect(".", " after the variable")
        return found

    def binding_name(self) -> Token:
        """Read a variable that is bound here."""
        if self.token.text in KEYWORDS - {"distinct"}:
            word = f"{self.token}, a word of the goal language"
            self.stop_at(self.token, f"expected a variable, found {word}; choose another name")
        if self.token.kind == "number":
            self.stop_at(
                self.token, f"expected a variable, found {self.token}; counts are written at least 2 x. Can(x)"
            )
        if self.token.kind != "name" or not _OBJECT_NAME.fullmatch(self.token.text) or self.token.text in KEYWORDS:
            self.stop("expected a variable, a name that starts with a lower-case letter")
        return self.take()

    def bind(self, token: Token) -> str:
        """Open the scope of a variable and return a name that is unique in this description or sentence."""
        if len(self.bound) == MAX_BINDERS + (self.inside == "description"):
            self.stop_at(token, f"more than {MAX_BINDERS} quantifiers inside one another; state a simpler goal")
        unique, count = token.text, 1
        while unique in self.binders or (count > 1 and unique in self.identifiers):
            count += 1
            unique = f"{token.text}_{count}"
        self.binders[unique] = token.text
        self.bound.append((token.text, unique))
        return unique

    # ---- expressions

    def expression(self) -> Expression:
        """Read as much of an expression as there is."""
        found = self.all_of()
        while self.accept("|"):
            found = Or(found, self.all_of())
        return found

    def all_of(self) -> Expression:
        """Read expressions joined by `&`."""
        found = self.unit()
        while self.accept("&"):
            found = And(found, self.unit())
        return found

    def unit(self) -> Expression:
        """Read an expression without `&` and `|` outside of parentheses."""
        self.count_part()
        if self.accept("("):
            found = self.expression()
            self.expect(")", ", '&' or '|'")
            return found
        match self.token.text:
            case "not":
                self.take()
                return Not(self.unit())
            case "exists":
                return self.some()
            case "every":
                return self.every()
            case "exactly" | "at":
                return self.counted()
            case "Was" | "Exists" | "And" | "Or":
                return self.prefixed()
        if len(self.ahead) > 1 and self.ahead[1].text in ("=", "!="):
            return self.same()
        return self.atom("an expression such as Green(x)")

    def prefixed(self) -> Expression:
        """Read `Was(..)`, `Exists(..)`, `And(..)` or `Or(..)`."""
        word = self.take().text
        self.expect("(")
        if word in ("And", "Or"):
            return self.connective(And if word == "And" else Or)
        if word == "Was":
            found: Expression = Was(self.expression())
        else:
            token = self.binding_name()
            self.expect(",", " and what holds of it")
            found = self.quantified([token])
        self.expect(")", ", '&' or '|'")
        return found

    def connective(self, kind: type[And] | type[Or]) -> Expression:
        """Read the arguments of `And(..)` or `Or(..)`."""
        found = self.expression()
        self.expect(",", f" and what else {kind.__name__} joins")
        found = kind(found, self.expression())
        while self.accept(","):
            found = kind(found, self.expression())
        self.expect(")")
        return found

    def same(self) -> Expression:
        """Read `x = y` or `x != y`."""
        left = self.object()
        negated = self.take().text == "!="
        found = Same(left, self.object())
        return Not(found) if negated else found

    def some(self) -> Expression:
        """Read `exists x, y. phi`."""
        self.take()
        return self.quantified(self.binding_names())

    def quantified(self, tokens: list[Token]) -> Expression:
        """Read what holds of some objects, called by the names at `tokens`."""
        unique = [self.bind(token) for token in tokens]
        for _ in tokens:
            self.count_part()
        found = self.expression()
        del self.bound[len(self.bound) - len(tokens) :]
        for name in reversed(unique):
            found = Exists(name, found)
        return found

    def every(self) -> Expression:
        """Read `every x. phi -> psi`."""
        self.take()
        variable = self.one_variable()
        condition = self.expression()
        if not self.accept("->"):
            self.stop("expected '->' and what holds of every such object: every x. Can(x) -> On(x, table1)")
        body = self.expression()
        self.bound.pop()
        return Every(variable, condition, body)

    def counted(self) -> Expression:
        """Read `exactly 2 x. phi` and its kind."""
        kind = self.count_kind()
        token, number = self.token, self.number()
        if not (0 <= number <= MAX_COUNT and number.is_integer()):
            self.complain(token, f"expected a whole number from 0 to {MAX_COUNT}, found {token.written}")
            number = 0.0
        variable = self.one_variable()
        body = self.expression()
        self.bound.pop()
        return Count(kind, int(number), variable, body)

    def count_kind(self) -> CountKind:
        """Read `exactly`, `at least` or `at most`."""
        if self.accept("exactly"):
            return "exactly"
        self.expect("at")
        if self.accept("least"):
            return "at least"
        if not self.accept("most"):
            close = hint_at_keyword(self.token.text, ())
            self.stop_at(self.token, f"expected 'least' or 'most' after 'at', found {self.token}{close}")
        return "at most"

    def one_variable(self) -> str:
        """Read a variable and its dot; return its unique name."""
        token = self.binding_name()
        self.expect(".", " after the variable")
        return self.bind(token)

    def atom(self, expected: str) -> Atom:
        """Read a relation with its arguments; `expected` says what else could stand here."""
        first = self.token
        if first.kind != "name" or not first.text[0].isupper() or self.is_left_out(first):
            self.stop(f"expected {expected}")
        self.take()
        self.expect("(", f" after the relation {first.text!r}")
        objects_only = first.text in SPATIAL or self.words.get(first.text) == 1 or not self.inside
        args = [self.argument(objects_only, f"{first.text}(o, ..)")]
        while self.accept(","):
            args.append(self.argument(objects_only, f"{first.text}(.., o)"))
        self.expect(")", " or ','")
        self.check_word(first, len(args))
        return Atom(first.text, tuple(args))

    # ---- words, objects, numbers

    def word(self, arity: int) -> str:
        """Read a word of so many arguments."""
        if self.token.kind != "name" or not self.token.text[0].isupper() or self.is_left_out(self.token):
            self.stop("expected a property such as Green")
        self.check_word(self.token, arity)
        return self.take().text

    def is_left_out(self, token: Token) -> bool:
        """Return whether the language says this in another way."""
        return token.text not in self.words and bool(remedy_of_word(token.text, self.words))

    def check_word(self, token: Token, arity: int) -> None:
        """Record a fault of a relation that is unknown or has another number of arguments."""
        if token.text not in self.words:
            self.complain(token, f"no relation {token.text!r}{hint(token.text, self.words)}")
        elif self.words[token.text] != arity:
            wanted = self.words[token.text]
            self.complain(token, f"{token.text} takes {wanted} argument{'s' * (wanted != 1)}, not {arity}")

    def argument(self, objects_only: bool, place: str) -> Argument:
        """Read an object or a number; `place` is an example of where it stands."""
        if self.token.kind == "number":
            if objects_only:
                self.complain(self.token, f"expected an object, found the number {self.token.text}")
            elif abs(float(self.token.text)) > MAX_NUMBER:
                self.complain(self.token, f"{self.token.text} is too large a number; at most {MAX_NUMBER}")
            return Number(self.number())
        return self.object(f"B({place}, p)")

    def object(self, place: str = "KRD(o)") -> Object:
        """Read an object; `place` is an example of where it stands."""
        token = self.token
        if token.text in KINDS:
            remedy = f"name what it denotes: exists o. B(Den({token.text} x. .., o), p) & {place}"
            self.stop_at(token, f"a description cannot stand in the place of an object; {remedy}")
        if token.kind != "name" or not _OBJECT_NAME.fullmatch(token.text) or token.text in KEYWORDS:
            self.stop("expected a variable or the name of an object, which start with a lower-case letter")
        self.take()
        for name, unique in reversed(self.bound):
            if name == token.text:
                return Variable(unique)
        if token.text in self.variables:
            self.mentioned.add(token.text)
            self.check_goal_variable(token)
            return Variable(token.text)
        if self.names is not None and token.text not in self.names:
            if token.text in self.binders.values():
                self.complain(token, f"variable {token.text!r} is not bound here")
            else:
                close = hint(token.text, self.names)
                self.complain(token, f"{token.text!r} is neither a bound variable nor a known object{close}")
        return Name(token.text)

    def check_goal_variable(self, token: Token) -> None:
        """Record a fault of a variable of the goal that stands inside something closed."""
        if self.inside:
            remedy = "; describe the object: B(Den(lambda x. .., o), p)" if self.inside == "sentence" else ""
            where = f"cannot stand inside a {self.inside}{remedy}"
            self.complain(token, f"variable {token.text!r} of the goal {where}")

    def number(self) -> float:
        """Read a number."""
        if self.token.kind != "number":
            self.stop("expected a number")
        value = float(self.token.text)
        if not math.isfinite(value):
            self.complain(self.token, f"{self.token.text} is too large a number")
        self.take()
        return value
