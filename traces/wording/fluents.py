"""Fluents in words: `P(sodaE is the green thing) >= .9`, `the left hand is empty`.

Bounds are given as probabilities, never in micro-nats, and the quantities of a Gaussian belief have units.
"""

from collections.abc import Callable, Iterable
from typing import Final

from skolem.traces.wording import amounts
from skolem.traces.wording.activities import do, doing
from skolem.traces.wording.facts import own, phi_clause
from skolem.traces.wording.recorded import Recorded
from skolem.traces.wording.things import Things

_Clause = Callable[[Things, tuple[Recorded, ...]], str]

_OTHERS: Final[dict[tuple[str, int], _Clause]] = {
    ("krd", 1): lambda t, a: f"{t.name(a[0])} {'has been found' if a[0].name == 'sk' else 'is known by name'}",
    ("differ", 2): lambda t, a: f"{t.name(a[0])} and {t.name(a[1])} are two objects",
    ("holding", 1): lambda t, a: f"a hand holds {t.name(a[0])}",
    ("held", 2): lambda t, a: f"the {a[0]} hand holds {t.name(a[1])}",
    ("empty", 1): lambda t, a: f"the {a[0]} hand is empty",
    ("loose", 1): lambda t, a: f"no hand holds {t.name(a[0])}",
    ("at", 1): lambda t, a: f"the robot stands where it can {do(t, a[0])}",
    ("clear", 1): lambda t, a: f"nothing is in the way of {doing(t, a[0])}",
    ("aside", 2): lambda t, a: f"{t.name(a[0])} is not in the way of {doing(t, a[1])}",
}


def known(term: Recorded) -> bool:
    """Return whether a term is a fluent of a kind that skolem defines."""
    return (term.name in ("b", "bn") and len(term.args) > 1) or (term.name, len(term.args)) in _OTHERS


def clause(things: Things, term: Recorded) -> str:
    """Return a fluent in words; an unknown one as recorded."""
    match term:
        case Recorded("b", (phi, bound)) if bound.number is not None:
            return f"P({phi_clause(things, phi)}) >= {amounts.probability(bound.number)}"
        case Recorded("bn", (Recorded(quantity, (thing,)), mean, sd, tolerance, bound)) if bound.number is not None:
            said = f"{quantity} of {things.name(thing)} is {_known(things, quantity, mean, sd, tolerance)}"
            return f"P({said}) >= {amounts.probability(bound.number)}"
    other = _OTHERS.get((term.name, len(term.args)))
    return other(things, term.args) if other else own(things, term)


def _known(things: Things, quantity: str, mean: Recorded, sd: Recorded, tolerance: Recorded) -> str:
    """Return the uncertainty of a quantity, and its value if the fluent gives one."""
    match quantity:
        case "pose" if len(sd.args) == 3:
            near = f", near {amounts.pose_place(mean.args)}" if mean.args else ""
            return f"known within {amounts.pose_spread(sd.args)}{near}"
        case "colour" if len(sd.args) == 3:
            if mean.args and tolerance.args:
                return f"known to be about {amounts.colour_place(mean.args, things.colours)}"
            return f"known within {amounts.colour_spread(sd.args)}"
        case "weight" if len(sd.args) == 1:
            within = f"known within {amounts.weight_spread(sd.args[0])}"
            both = mean.args and tolerance.args
            return f"{within}, between {amounts.weight_range(mean.args[0], tolerance.args[0])}" if both else within
    return f"known within {sd}"


def weakest(texts: Iterable[tuple[str, Recorded | None]]) -> list[str]:
    """Return the false fluents that are worth mentioning.

    Among several bounds on one probability the lowest says most. No fluent is true of an object before it is found:
    such a fluent is mentioned only if there is no other.
    """
    every = list(texts)
    found = [(text, term) for text, term in every if "sk(" not in text] or every
    least: dict[str, int] = {}
    for _, term in found:
        if term is not None and term.name == "b" and len(term.args) == 2 and (bound := term.args[1].number) is not None:
            phi = str(term.args[0])
            least[phi] = max(bound, least.get(phi, 0))
    return [
        text
        for text, term in found
        if term is None or term.name != "b" or least.get(str(term.args[0])) in (None, term.args[-1].number)
    ]
