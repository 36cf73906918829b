"""Rule instances: the steps that the rules offer to achieve one fluent, read from one answer of clingo."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from skolem.reasoner.planning.patterns import mentions
from skolem.reasoner.terms import Compound, Term
from skolem.traces.errors import RuleError


@dataclass(frozen=True, slots=True)
class Instance:
    """One ground instance of an operator or inference rule.

    Attributes:
        step: The term of the instance.
        operation: Its operation; instances of one operation share their abstraction level.
        costs: -ln p in micro-nats, by reason.
        results: Fluents it makes true.
        preconditions: Fluents it needs, each with the first level that demands it.
        destroys: Patterns of fluents it may make false.
        executes: The primitive that carries it out; None for an inference.
        immediate: Whether it is expanded before all others: an inference without alternative.
        rejected: Why the rules refuse it; empty if they do not.
    """

    step: Term
    operation: Term
    costs: frozenset[tuple[Term, int]] = frozenset()
    results: frozenset[Term] = frozenset()
    preconditions: frozenset[tuple[Term, int]] = frozenset()
    destroys: frozenset[Term] = frozenset()
    executes: Term | None = None
    immediate: bool = False
    rejected: tuple[str, ...] = ()

    @property
    def price(self) -> int:
        """Sum of the costs, micro-nats."""
        return sum(cost for _, cost in self.costs)

    @property
    def concrete(self) -> int:
        """The level at which no precondition is postponed."""
        return max((level for _, level in self.preconditions), default=0)

    @property
    def on_placeholder(self) -> bool:
        """Whether it would act on an object that is only a Skolem constant."""
        return self.executes is not None and mentions(self.step, "sk")

    def demanded(self, level: int) -> list[Term]:
        """Preconditions of levels 0..level, sorted."""
        return sorted((f for f, at in self.preconditions if at <= level), key=str)

    def postponed(self, level: int) -> list[Term]:
        """Preconditions of higher levels, sorted."""
        return sorted((f for f, at in self.preconditions if at > level), key=str)

    def merged(self, other: "Instance") -> "Instance":
        """Return the step with the parts of both offers: this one and another of the same step."""
        return Instance(
            self.step,
            self.operation,
            self.costs | other.costs,
            self.results | other.results,
            self.preconditions | other.preconditions,
            self.destroys | other.destroys,
            self.executes,
            self.immediate and other.immediate,
            tuple(sorted({*self.rejected, *other.rejected})),
        )


@dataclass(slots=True)
class _Parts:
    operation: Term | None = None
    costs: set[tuple[Term, int]] = field(default_factory=set)
    results: set[Term] = field(default_factory=set)
    preconditions: set[tuple[Term, int]] = field(default_factory=set)
    destroys: set[Term] = field(default_factory=set)
    executes: Term | None = None
    immediate: bool = False
    rejected: set[str] = field(default_factory=set)


def read_instances(atoms: Mapping[str, Iterable[tuple[Term, ...]]]) -> tuple[Instance, ...]:
    """Return all instances of one answer, rejected ones included, sorted by text.

    Raises:
        RuleError: If a cost or a level is negative or not an integer.
    """
    parts: defaultdict[Term, _Parts] = defaultdict(_Parts)
    of = parts.__getitem__

    for (step,) in atoms.get("candidate", ()):
        of(step)
    for step, name in (*atoms.get("operation", ()), *atoms.get("called", ())):  # in older traces: called
        of(step).operation = name
    for step, reason, cost in atoms.get("cost", ()):
        of(step).costs.add((reason, _natural(cost, f"cost({step},{reason},..)")))
    for step, fluent in atoms.get("result", ()):
        of(step).results.add(fluent)
    for step, fluent, level in atoms.get("precond", ()):
        of(step).preconditions.add((fluent, _natural(level, f"precond({step},{fluent},..)")))
    for step, pattern in atoms.get("destroys", ()):
        of(step).destroys.add(pattern)
    for step, command in atoms.get("executes", ()):
        of(step).executes = command
    for (step,) in atoms.get("immediate", ()):
        of(step).immediate = True
    for step, reason in atoms.get("rejected", ()):
        of(step).rejected.add(str(reason))
    return tuple(_instance(step, p) for step, p in sorted(parts.items(), key=lambda item: str(item[0])))


def _instance(step: Term, p: _Parts) -> Instance:
    return Instance(
        step=step,
        operation=p.operation if p.operation is not None else step,
        costs=frozenset(p.costs),
        results=frozenset(p.results),
        preconditions=frozenset(p.preconditions),
        destroys=frozenset(p.destroys),
        executes=p.executes,
        immediate=p.immediate,
        rejected=tuple(sorted(p.rejected)),
    )


def _natural(term: Term, where: str) -> int:
    if isinstance(term, int) and term >= 0:
        return term
    about = where.partition("(")[0]
    raise RuleError(f"{where}: the rules gave {term!s} where a whole number from 0 was expected", about)


def title(operation: Term) -> str:
    """Return the text of an operation for people: `look_at(o2)` becomes `LookAt(o2)`."""
    if not isinstance(operation, Compound):
        return str(operation)
    name = "".join(word.capitalize() for word in operation.name.split("_"))
    return f"{name}({', '.join(map(str, operation.args))})"
