"""Contradictions against truth in small worlds: what some world satisfies is never called contradictory."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from hypothesis import event, given, strategies as st
from kit.descriptions import OBJECTS, wide_goals
from kit.draws import examples
from kit.papers import shipped

from skolem.reasoner.language.descriptions import (
    And,
    Argument,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Not,
    Number,
    Or,
    Same,
    Was,
)
from skolem.reasoner.language.expressions import Believed, Den, Goal, Holds, Sentence, parts_of
from skolem.reasoner.planning.contradictions import contradictions

THINGS = (*OBJECTS, "stranger")
Scope = Mapping[str, str]


@dataclass(frozen=True)
class Thing:
    """An object: of one type, of one colour, with a weight, on one support at the start and on one now."""

    soda: bool
    colour: str
    grams: float
    supports: Mapping[str, str]


things = st.builds(
    Thing,
    st.booleans(),
    st.sampled_from(["Green", "Red", "Blue"]),
    st.sampled_from([0.0, 399.0, 400.0, 1000.0]),
    st.fixed_dictionaries({time: st.sampled_from(THINGS) for time in ("was", "now")}),
)
World = Mapping[str, Thing]


def true(said: Expression, world: World, scope: Scope, time: str) -> bool:
    """Return whether an expression is true in a world, by its definition."""

    def of(part: Expression, **more: str) -> bool:
        return true(part, world, {**scope, **more}, time)

    match said:
        case And(left, right):
            return of(left) and of(right)
        case Or(left, right):
            return of(left) or of(right)
        case Not(body):
            return not of(body)
        case Was(body):
            return true(body, world, scope, "was")
        case Same(left, right):
            return name(left, scope) == name(right, scope)
        case Exists(variable, body):
            return any(of(body, **{variable: each}) for each in THINGS)
        case Every(variable, condition, body):
            return all(of(body, **{variable: each}) for each in THINGS if of(condition, **{variable: each}))
        case Count(kind, number, variable, body):
            found = sum(of(body, **{variable: each}) for each in THINGS)
            return {"exactly": found == number, "at least": found >= number, "at most": found <= number}[kind]
        case Atom(word, args):
            return holds(word, args, world, scope, time)


def holds(word: str, args: tuple[Argument, ...], world: World, scope: Scope, time: str) -> bool:
    thing = world[name(args[0], scope)]
    match word:
        case "On" | "In":
            return thing.supports[time] == name(args[1], scope)
        case "HeavierThan" if isinstance(args[1], Number):
            return thing.grams >= args[1].value
        case "Soda":
            return thing.soda
        case "Heavy":
            return thing.grams >= 400.0
    return thing.colour == word


def name(argument: Argument, scope: Scope) -> str:
    assert not isinstance(argument, Number)
    return scope.get(argument.name, argument.name)


def satisfied(goal: Goal, world: World, scope: Scope) -> bool:
    """Return whether all that is to be believed is true; a superlative counts as the property among whose it is."""
    for conjunct in goal.conjuncts:
        for part in parts_of(conjunct.phi) if isinstance(conjunct, Believed) else ():
            match part:
                case Den(description, argument):
                    inner = {**scope, description.variable: name(argument, scope)}
                    found = true(description.body, world, inner, "was" if description.kind == "the" else "now")
                case Holds(words, argument):
                    found = all(holds(word, (argument,), world, scope, "now") for word in words)
                case Sentence(body):
                    found = true(body, world, scope, "now")
                case Atom():
                    found = true(part, world, scope, "now")
            if not found:
                return False
    return True


@given(wide_goals(), st.fixed_dictionaries({each: things for each in THINGS}))
@examples(300)
def test_what_a_world_satisfies_is_never_called_contradictory(goal: Goal, world: World) -> None:
    chosen = product(THINGS, repeat=len(goal.variables))
    possible = any(satisfied(goal, world, dict(zip(goal.variables, each, strict=True))) for each in chosen)
    faults = contradictions(goal, shipped().vocabulary)
    event(f"satisfied: {possible}, called contradictory: {bool(faults)}")
    assert not (possible and faults), faults
