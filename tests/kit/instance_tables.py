"""Offers from a list of hand-made rule instances."""

from collections.abc import Iterable

from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.planning.patterns import Mutexes
from skolem.reasoner.terms import Term, nll, parse_term


def terms(*texts: str) -> frozenset[Term]:
    return frozenset(map(parse_term, texts))


def instance(
    name: str,
    results: Iterable[str],
    needs: Iterable[tuple[str, int]] = (),
    p: float = 0.9,
    destroys: Iterable[str] = (),
    immediate: bool = False,
) -> Instance:
    step = parse_term(name)
    return Instance(
        step=step,
        operation=step,
        costs=frozenset({("chance", nll(p))}) if p < 1 else frozenset(),
        results=terms(*results),
        preconditions=frozenset((parse_term(f), level) for f, level in needs),
        destroys=terms(*destroys),
        executes=None if immediate else step,
        immediate=immediate,
    )


class Table:
    """Offers from a list of instances; the true fluents are a set."""

    def __init__(
        self, instances: Iterable[Instance], now: Iterable[str], mutexes: Iterable[tuple[str, str]] = ()
    ) -> None:
        self.instances = tuple(instances)
        self.now = terms(*now)
        self.mutexes = Mutexes((parse_term(f), parse_term(g)) for f, g in mutexes)

    def offers(self, fluent: Term) -> tuple[Instance, ...]:
        return tuple(i for i in self.instances if fluent in i.results)

    def prepare(self, fluents: Iterable[Term]) -> None:
        del fluents

    def holds(self, fluent: Term) -> bool:
        return fluent in self.now
