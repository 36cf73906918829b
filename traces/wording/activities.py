"""Operations, activities and rule instances in words: `drive to pick sodaC with the left hand`."""

from collections.abc import Callable
from typing import Final

from skolem.traces.wording.amounts import spaced
from skolem.traces.wording.facts import own, phi_clause
from skolem.traces.wording.recorded import Recorded
from skolem.traces.wording.things import Things

_Of = Callable[[Things, tuple[Recorded, ...]], str]


def _hand(hand: Recorded) -> str:
    return f"with the {hand} hand"


def _place(things: Things, item: Recorded, support: Recorded, other: Recorded) -> str:
    where = f"{things.name(item)} on {things.name(support)}"
    return where if str(other) == "nothing" else f"{where}, out of the way of {doing(things, other)}"


# (name, number of arguments) -> verb, the same with -ing, and what follows
_VERBS: Final[dict[tuple[str, int], tuple[str, str, _Of]]] = {
    **dict.fromkeys((("look", 1), ("look_at", 1)), ("look at", "looking at", lambda t, a: t.name(a[0]))),
    **dict.fromkeys(
        (("look_region", 1), ("look_at_region", 1)), ("look at", "looking at", lambda t, a: t.region(a[0]))
    ),
    ("pick", 1): ("pick", "picking", lambda t, a: t.name(a[0])),
    ("pick", 2): ("pick", "picking", lambda t, a: f"{t.name(a[1])} {_hand(a[0])}"),
    ("place", 2): ("place", "placing", lambda t, a: f"{t.name(a[0])} on {t.name(a[1])}"),
    ("place", 3): ("place", "placing", lambda t, a: _place(t, *a)),
    ("put", 4): ("place", "placing", lambda t, a: f"{_place(t, *a[1:])}, {_hand(a[0])}"),
    ("weigh", 1): ("weigh", "weighing", lambda t, a: t.name(a[0])),
    ("weigh", 2): ("weigh", "weighing", lambda t, a: f"{t.name(a[1])} {_hand(a[0])}"),
    ("move", 1): ("drive to", "driving to", lambda t, a: do(t, a[0])),
    **dict.fromkeys(
        (("examine", 4), ("examine_obj", 2)),
        ("find out", "finding out", lambda t, a: f"whether {t.is_meant(a[0], a[-2] if len(a) == 4 else a[1])}"),
    ),
    **dict.fromkeys(
        (("find", 4), ("find_obj", 3)),
        ("find", "finding", lambda t, a: f"{t.described(a[0])} in {t.region(a[1])}"),
    ),
    **dict.fromkeys(
        (("count_objs", 1), ("count", 3)), ("find out", "finding out", lambda t, a: f"whether {t.sentence(a[0])}")
    ),
    **dict.fromkeys(
        (("the_obj", 2), ("only", 3)),
        ("conclude", "concluding", lambda t, a: f"that {t.is_meant(*a[:2])}, and no other"),
    ),
    **dict.fromkeys(
        (("refute_obj", 2), ("put_away", 4), ("put_right", 4)),
        ("make sure", "making sure", lambda t, a: f"that {t.is_not_meant(*a[:2])}"),
    ),
    ("refute", 4): ("make sure", "making sure", lambda t, a: f"that {t.is_not_meant(a[0], a[2])}"),
    **dict.fromkeys(
        (("witness_obj", 3), ("witness", 4)),
        ("find out", "finding out", lambda t, a: f"whether {t.is_meant(*a[:2])} because of {t.name(a[2])}"),
    ),
    ("compare", 2): ("compare", "comparing", lambda t, a: f"{t.name(a[0])} with {t.name(a[1])}"),
    ("compare", 4): ("compare", "comparing", lambda t, a: f"{t.name(a[1])} with {t.name(a[2])}"),
    **dict.fromkeys(
        (("unfit", 2), ("unfit", 4)),
        ("make sure", "making sure", lambda t, a: f"that {t.name(a[1])} is no rival"),
    ),
    ("see_both", 2): ("see", "seeing", lambda t, a: f"how {t.name(a[0])} and {t.name(a[1])} stand"),
    ("see", 4): ("see", "seeing", lambda t, a: f"how {t.name(a[1])} and {t.name(a[2])} stand"),
    **dict.fromkeys(
        (("rule_out", 2), ("rule_out", 3)),
        ("make sure", "making sure", lambda t, a: f"that {t.hides_none(*a[:2])}"),
    ),
    **dict.fromkeys(
        (("believe_together", 2), ("both", 3)),
        ("conclude", "concluding", lambda t, a: f"that {phi_clause(t, a[0])} and {phi_clause(t, a[1])}, both at once"),
    ),
    **dict.fromkeys((("infer", 2), ("infer", 3)), ("conclude", "concluding", lambda t, a: f"that {t.has(a[1], a[0])}")),
    ("split", 3): ("sum up", "summing up", lambda t, a: f"that {t.has(a[1], *a[0].args)}"),
    **dict.fromkeys(
        (("remove", 1), ("remove_obst", 1)), ("clear", "clearing", lambda t, a: f"the way to {do(t, a[0])}")
    ),
}


def verb(term: Recorded) -> tuple[str, str, _Of] | None:
    """Return the verb of an operation; None for one from a rule file."""
    return _VERBS.get((spaced(term.name).replace(" ", "_"), len(term.args)))


def do(things: Things, term: Recorded) -> str:
    """Return an operation as an infinitive: `pick sodaC`; an unknown one as recorded."""
    known = verb(term)
    return f"{known[0]} {known[2](things, term.args)}" if known else own(things, term)


def doing(things: Things, term: Recorded) -> str:
    """Return an operation as a noun: `picking sodaC`; an unknown one as recorded."""
    known = verb(term)
    return f"{known[1]} {known[2](things, term.args)}" if known else own(things, term)
