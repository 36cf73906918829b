"""The fluents that the belief and the geometry can answer, and the activities that can be carried out, as patterns.

`Situation` evaluates them; this table lists them, so that rule files can be checked and described without a belief.
In a pattern `object`, `region` and `hand` name the sort of an argument; `any` is a bound or a number.
"""

from functools import cache
from typing import Final

from skolem.reasoner.terms import ANY, Compound, Term, parse_term

# pattern -> (its meaning in words, whether a goal can ask for it)
FLUENTS: Final[dict[str, tuple[str, bool]]] = {
    "b(den(expression,object),any)": ("the object is what the description means", True),
    "b(holds(properties,object),any)": ("it has all of the properties", True),
    "b(prop(word,object),any)": ("it has the property, asked by a goal", True),
    "b(supposed(word,object),any)": ("it has the property, supposed by an examination", False),
    "b(type(object,word),any)": ("it is of the type", False),
    "b(exists(object),any)": ("there is such an object", False),
    "b(on(object,object),any)": ("the first rests on the second", True),
    "b(contents(region),any)": ("the contents of the region are known", False),
    "b(exists_in(expression,region),any)": ("the unseen part of the region holds what is meant", False),
    "b(unlike(expression,object),any)": ("the object is not what the description means", False),
    "b(none_in(expression,region),any)": ("the unseen part of the region holds nothing of what is meant", False),
    "b(off(object,object),any)": ("the first does not rest on the second", False),
    "b(beaten(expression,object,object),any)": ("the second is ahead of the first, or the first does not fit", False),
    "b(related(word,object,object),any)": ("the relation holds of the two objects", False),
    "b(holds_of_the_world(expression),any)": ("the sentence is true", True),
    "b(together(any,any),any)": ("both are true in one world", True),
    "bn(pose(object),any,any,any,any)": ("its pose relative to the base is known as well as the bounds say", True),
    "bn(colour(object),any,any,any,any)": ("its colour is known as well as the bounds say, and near the mean", True),
    "bn(weight(object),any,any,any,any)": ("the logarithm of its weight likewise", True),
    "krd(object)": ("the term is an anchor, a rigid designator", True),
    "differ(object,object)": ("they are two objects", True),
    "holding(object)": ("a hand holds it", False),
    "held(hand,object)": ("that hand holds it", False),
    "empty(hand)": ("the hand holds nothing", False),
    "loose(object)": ("no hand holds it", False),
    "at(activity)": ("the activity can be carried out from where the base stands", False),
    "clear(activity)": ("nothing stands in the way of the activity", False),
    "aside(object,activity)": ("the object does not stand in the way of the activity", False),
}
ACTIVITIES: Final = (
    "look(object)",
    "look_region(region)",
    "pick(hand,object)",
    "place(object,object,any)",
    "weigh(object)",
)
COMMANDS: Final = (*ACTIVITIES, "move(activity)")
_SORTS: Final = frozenset({"expression", "object", "region", "hand", "activity", "word", "properties"})


@cache
def sorted_pattern(text: str) -> Term:
    """Return a pattern of the table with the name of its sort for every argument."""
    return parse_term(text)


@cache
def pattern(text: str) -> Term:
    """Return a pattern of the table with `any` for every argument."""
    return _open(parse_term(text))


def _open(term: Term) -> Term:
    if isinstance(term, Compound):
        return Compound(term.name, tuple(map(_open, term.args)))
    return ANY if term in _SORTS else term


def shape(term: Term) -> str:
    """Return the kind of a fluent: `b(on)`, `bn(pose)`, `krd`; `any` if it may be of any kind."""
    if not isinstance(term, Compound):
        return str(term)
    first = term.args[0]
    if term.name in ("b", "bn"):
        return f"{term.name}({first.name if isinstance(first, Compound) else first})"
    return term.name
