"""Steps that were refused in one belief, each with the reason; only what was shown is called impossible."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

from skolem.reasoner.planning.instances import Instance, title
from skolem.reasoner.terms import Term

IMPOSSIBLE: Final = "found impossible in the believed world"
UNLIKELY: Final = "too unlikely in detail"
NOT_FOUND: Final = "not found in detail within the limits"
SPENT: Final = "budget of the motion planner spent"
NOT_ENOUGH: Final = "not believed yet though all that the rules ask for holds"
IN_VAIN: Final = "without a way but by what had no success"  # every other way was shown to be impossible
_OF_LIMITS: Final = (SPENT, NOT_FOUND)


def weakest(reasons: Iterable[str]) -> str:
    """Return the reason of a search that met steps with these reasons: it shows no more than the weakest of them."""
    met = set(reasons)
    if met.intersection(_OF_LIMITS):
        return NOT_FOUND
    return next((reason for reason in (UNLIKELY, IN_VAIN, NOT_ENOUGH) if reason in met), IMPOSSIBLE)


def why_none(exhausted: bool, priced_out: bool, met: Iterable[str]) -> str:
    """Return why a search found no plan.

    Args:
        exhausted: Whether it has tried all that there is.
        priced_out: Whether it left out steps for their cost.
        met: The reasons for which it left out other steps.
    """
    if not exhausted:
        return NOT_FOUND
    return weakest([*met, UNLIKELY] if priced_out else met)


@dataclass(frozen=True, slots=True)
class _Refusal:
    operation: Term
    reason: str
    tried: int

    def __str__(self) -> str:
        return title(self.operation) + (f" (tried {self.tried} stances)" if self.tried else "")


@dataclass(slots=True)
class Refusals:
    """The steps that are not planned with in one belief, by name and level."""

    _found: dict[tuple[Term, int], _Refusal] = field(default_factory=dict)

    def note(self, instance: Instance, level: int, reason: str, tried: int = 0) -> None:
        """Refuse a step at a level; `tried` is the number of stances after which the motion planner gave up."""
        self._found[instance.step, level] = _Refusal(instance.operation, reason, tried)

    def reason(self, instance: Instance, level: int) -> str:
        """Return why a step is refused at a level; empty if it is not."""
        found = self._found.get((instance.step, level))
        return "" if found is None else found.reason

    def clear(self) -> None:
        """Forget all: the belief is another one."""
        self._found.clear()

    def forget_limits(self) -> None:
        """Forget what was not found within limits, since these are higher now."""
        self._found = {step: found for step, found in self._found.items() if found.reason != NOT_FOUND}

    def told(self) -> str:
        """Return the reasons, each with the operations that were refused for it, as a continued sentence."""
        parts = ""
        for reason in (IMPOSSIBLE, SPENT, UNLIKELY, NOT_FOUND, IN_VAIN):
            names = sorted({str(found) for found in self._found.values() if found.reason == reason})
            parts += f"; {reason}: {', '.join(names)}" if names else ""
        return parts
