"""The @functions of the rules as clingo calls them."""

from collections.abc import Callable, Sequence

import clingo

from skolem.reasoner.terms import Term, from_symbol, to_symbol
from skolem.traces.errors import NotRecordedError, RuleError

Symbols = clingo.Symbol | list[clingo.Symbol]  # a query's answer, to clingo


class _Remembered:
    """Answers queries in terms; each answer is computed once, as where clingo asks for symbols."""

    def __init__(self, queries: object) -> None:
        self._queries = queries

    def __getattr__(self, name: str) -> Callable[..., object]:
        query, memo = getattr(self._queries, name), dict[tuple[object, ...], object]()

        def ask(*arguments: object) -> object:
            if arguments not in memo:
                memo[arguments] = query(*arguments)
            return memo[arguments]

        setattr(self, name, ask)
        return ask


class Asked:
    """Answers the @functions of the rules from a queries object; each answer is computed once."""

    def __init__(self, queries: object) -> None:
        self._queries = queries
        self._remembered = _Remembered(queries)

    @staticmethod
    def source(asked: "Asked") -> object:
        """Return the queries, answered in terms, each computed once; no method, since other names are queries."""
        return asked._remembered

    def __getattr__(self, name: str) -> Callable[..., Symbols]:
        memo: dict[tuple[clingo.Symbol, ...], Symbols] = {}

        def ask(*symbols: clingo.Symbol) -> Symbols:
            found = memo.get(symbols)
            if found is None:
                found = memo[symbols] = self._answer(name, symbols)
            return found

        setattr(self, name, ask)  # from now on clingo finds the attribute itself
        return ask

    def _answer(self, name: str, symbols: Sequence[clingo.Symbol]) -> Symbols:
        try:
            arguments = tuple(map(from_symbol, symbols))
            found: Term | list[Term] = getattr(self._queries, name)(*arguments)
            return [to_symbol(term) for term in found] if isinstance(found, list) else to_symbol(found)
        except NotRecordedError:
            raise  # no fault of a rule
        except Exception as error:
            text = f"@{name}({', '.join(map(str, symbols))})"
            raise RuleError(f"query {text} failed: {type(error).__name__}: {error}", f"@{name}") from error
