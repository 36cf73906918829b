"""Relations between fluents: entailment, exclusion, and the patterns that rules match them with.

Patterns come from the rules: `any` matches every term, `same(X)` the same term wherever X occurs, `other(X)` a term
that differs from the one `same(X)` matched.
"""

from collections.abc import Iterable, Mapping
from functools import lru_cache
from itertools import product

from skolem.reasoner.terms import ANY, Compound, Term

_AT_MOST = {"b": (1,), "bn": (2, 3, 4)}  # arguments in which a smaller value demands more; never the first one
_MEMORY = 1 << 14  # fluents of which is remembered what they are about


def entails(fluent: Term, wanted: Term) -> bool:
    """Return whether `fluent` makes `wanted` true: it is equal, or a belief at least as strong about the same."""
    if not isinstance(fluent, Compound) or not isinstance(wanted, Compound):
        return fluent == wanted
    if fluent.name != wanted.name:
        return False
    if fluent == wanted:
        return True
    bounds = _AT_MOST.get(fluent.name)
    if bounds is None or len(fluent.args) != len(wanted.args):
        return False
    return all(
        within(have, want) if i in bounds else have == want or (i > 0 and want == ANY)
        for i, (have, want) in enumerate(zip(fluent.args, wanted.args, strict=True))
    )


@lru_cache(_MEMORY)
def about(fluent: Term) -> str:
    """Return a key that two fluents share if one of them entails the other: most pairs need no closer look."""
    if isinstance(fluent, Compound) and fluent.args and fluent.name in _AT_MOST:
        return f"{fluent.name}({fluent.args[0]}"
    return str(fluent)


def within(bound: Term, limit: Term) -> bool:
    """Return whether a bound is at least as tight as another; bounds are numbers or tuples such as sd(8, 8, any)."""
    if limit == ANY:
        return True
    if isinstance(bound, int) and isinstance(limit, int):
        return bound <= limit
    if isinstance(bound, Compound) and isinstance(limit, Compound) and len(bound.args) == len(limit.args):
        return all(map(within, bound.args, limit.args))
    return False


class Mutexes:
    """The mutexes that the rules state as patterns, tested on pairs of ground fluents."""

    def __init__(self, pairs: Iterable[tuple[Term, Term]]) -> None:
        self._pairs: dict[tuple[str, str], list[tuple[Term, Term]]] = {}  # by the names of their fluents
        for f, g in pairs:
            self._pairs.setdefault((_name(f), _name(g)), []).append((f, g))
        self._memo: dict[tuple[Term, Term], bool] = {}
        self._concerned: dict[Term, bool] = {}

    def concerned(self, fluents: Iterable[Term]) -> list[Term]:
        """Return the fluents that some mutex is about, in their order; no other one excludes a fluent."""
        known = self._concerned
        return [f for f in fluents if (known[f] if f in known else self._is_concerned(f))]

    def _is_concerned(self, fluent: Term) -> bool:
        names = (_name(fluent), ANY)
        self._concerned[fluent] = any(
            _bind(pattern, fluent, {})
            for key, pairs in self._pairs.items()
            for side in (0, 1)
            if key[side] in names
            for pattern in (pair[side] for pair in pairs)
        )
        return self._concerned[fluent]

    def exclude(self, fluent: Term, other: Term) -> bool:
        """Return whether two fluents can never hold together."""
        key = (fluent, other)
        if key not in self._memo:
            self._memo[key] = self._one_way(fluent, other) or self._one_way(other, fluent)
        return self._memo[key]

    def forget(self) -> None:
        """Forget the answers about pairs: fluents contain numbers, which change with the belief."""
        self._memo.clear()
        self._concerned.clear()

    def _one_way(self, fluent: Term, other: Term) -> bool:
        names = product((_name(fluent), ANY), (_name(other), ANY))
        return any(_both(f, g, fluent, other) for key in names for f, g in self._pairs.get(key, ()))


def _name(fluent: Term) -> str:
    """Return the name by which patterns are looked up for a fluent; `any` for a pattern that fits several names."""
    if not isinstance(fluent, Compound):
        return str(fluent)
    return ANY if fluent.name in ("same", "other") else fluent.name


def _both(pattern: Term, pattern2: Term, fluent: Term, fluent2: Term) -> bool:
    binding: dict[Term, Term] = {}
    if not _bind(pattern, fluent, binding) or not _bind(pattern2, fluent2, binding):
        return False
    return _differs(pattern, fluent, binding) and _differs(pattern2, fluent2, binding)


def _bind(pattern: Term, term: Term, binding: dict[Term, Term]) -> bool:
    """Match all but `other(..)`, and bind the argument of each `same(..)`."""
    if pattern == ANY:
        return True
    if isinstance(pattern, Compound) and pattern.name == "other":
        return True
    if isinstance(pattern, Compound) and pattern.name == "same":
        return binding.setdefault(pattern.args[0], term) == term
    if not isinstance(pattern, Compound) or not isinstance(term, Compound):
        return pattern == term
    if pattern.name != term.name or len(pattern.args) != len(term.args):
        return False
    return all(_bind(p, t, binding) for p, t in zip(pattern.args, term.args, strict=True))


def _differs(pattern: Term, term: Term, binding: Mapping[Term, Term]) -> bool:
    """Return whether each `other(X)` of a matched pattern stands for a term other than X's."""
    if not isinstance(pattern, Compound):
        return True
    if pattern.name == "other":
        return binding.get(pattern.args[0]) != term
    if pattern.name == "same" or not isinstance(term, Compound):
        return True
    return all(_differs(p, t, binding) for p, t in zip(pattern.args, term.args, strict=True))


def mentions(term: Term, name: str) -> bool:
    """Return whether a compound of that name occurs in the term."""
    if not isinstance(term, Compound) or f"{name}(" not in str(term):  # most terms are settled by their text
        return False
    return term.name == name or any(mentions(a, name) for a in term.args)
