"""What is believed, in words: the phi of a fluent `b(phi, p)` as a clause, `sodaE is the green thing`."""

from collections.abc import Callable
from typing import Final

from skolem.traces.wording.amounts import spaced
from skolem.traces.wording.recorded import Recorded
from skolem.traces.wording.things import Things

_Clause = Callable[[Things, tuple[Recorded, ...]], str]

_FACTS: Final[dict[tuple[str, int], _Clause]] = {
    ("den", 2): lambda t, a: t.is_meant(*a),
    ("holds", 2): lambda t, a: t.has(a[1], *a[0].args),
    ("prop", 2): lambda t, a: t.has(a[1], a[0]),
    ("supposed", 2): lambda t, a: t.has(a[1], a[0]),
    ("type", 2): lambda t, a: t.of_type(*a),
    ("exists", 1): lambda t, a: f"{t.name(a[0])} exists",
    ("on", 2): lambda t, a: f"{t.name(a[0])} is on {t.name(a[1])}",
    ("near", 2): lambda t, a: f"{t.name(a[0])} is near {t.name(a[1])}",
    ("contents", 1): lambda t, a: f"all that {t.region(a[0])} holds is known",
    ("off", 2): lambda t, a: f"{t.name(a[0])} is not on {t.name(a[1])}",
    ("unlike", 2): lambda t, a: t.is_not_meant(*a),
    ("beaten", 3): lambda t, a: f"{t.name(a[2])} beats {t.name(a[1])} as {t.described(a[0])}",
    ("related", 3): lambda t, a: f"{t.name(a[1])} is {spaced(str(a[0]))} {t.name(a[2])}",
    ("none_in", 2): lambda t, a: t.hides_none(*a),
    ("holds_of_the_world", 1): lambda t, a: t.sentence(a[0]),
    ("together", 2): lambda t, a: f"{phi_clause(t, a[0])} and {phi_clause(t, a[1])}",
    ("exists_in", 2): lambda t, a: f"{t.described(a[0])} is hidden in {t.region(a[1])}",
}


def phi_clause(things: Things, phi: Recorded) -> str:
    """Return what is believed as a clause; an unknown fact as recorded."""
    believed = _FACTS.get((phi.name, len(phi.args)))
    if believed is not None:
        return believed(things, phi.args)
    if len(phi.args) == 2 and phi.name.endswith("_than"):
        return f"{things.name(phi.args[0])} is {spaced(phi.name)} {things.name(phi.args[1])}"
    return own(things, phi)


def own(things: Things, term: Recorded) -> str:
    """Return a term from a rule file as recorded, but with the names of its objects."""
    inner = ", ".join(things.name(arg) for arg in term.args)
    return f"{term.name}({inner})" if term.args else str(term)
