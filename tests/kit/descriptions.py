"""Hypothesis strategies for goals and descriptions, shared by the tests of the language and of its meaning.

`lambdas` and `goals` draw from the language of the paper, `wide_lambdas` and `wide_goals` from all of it.
"""

from collections.abc import Iterator
from itertools import count

from hypothesis import strategies as st

from skolem.reasoner.language.descriptions import (
    And,
    Atom,
    Count,
    CountKind,
    DescriptionKind,
    Every,
    Exists,
    Expression,
    Lambda,
    Name,
    Not,
    Number,
    Object,
    Or,
    Same,
    Variable,
    Was,
)
from skolem.reasoner.language.expressions import (
    DIMENSIONS,
    Believed,
    Conjunct,
    Den,
    Designated,
    Estimated,
    Goal,
    Holds,
    QuantityName,
    Sentence,
    Together,
)

PROPERTIES = ("Green", "Red", "Soda", "Heavy")
RELATIONS = {**dict.fromkeys(PROPERTIES, 1), "On": 2, "In": 2, "HeavierThan": 2}
OBJECTS = ("table1", "sodaE", "_o1_")


@st.composite
def expressions(draw: st.DrawFn, scope: tuple[str, ...], depth: int = 3, numbers: bool = False) -> Expression:
    """Draw an expression whose free variables are in `scope`. Two of its binders may share a name."""
    kinds = ["atom"] if depth == 0 else ["atom", "and", "or", "exists"]
    match draw(st.sampled_from(kinds)):
        case "and":
            return And(draw(expressions(scope, depth - 1, numbers)), draw(expressions(scope, depth - 1, numbers)))
        case "or":
            return Or(draw(expressions(scope, depth - 1, numbers)), draw(expressions(scope, depth - 1, numbers)))
        case "exists":
            variable = f"y{depth}"
            return Exists(variable, draw(expressions((*scope, variable), depth - 1, numbers)))
    return draw(_atoms(scope, numbers))


@st.composite
def _atoms(draw: st.DrawFn, scope: tuple[str, ...], numbers: bool) -> Atom:
    arguments = _objects(scope)
    if numbers and draw(st.booleans()):
        return Atom("HeavierThan", (draw(arguments), Number(draw(st.floats(-1e3, 1e3)))))
    if draw(st.booleans()):
        return Atom(draw(st.sampled_from(["On", "In"])), (draw(arguments), draw(arguments)))
    return Atom(draw(st.sampled_from(PROPERTIES)), (draw(arguments),))


def _objects(scope: tuple[str, ...]) -> st.SearchStrategy[Object]:
    return st.sampled_from([*map(Variable, scope), *map(Name, OBJECTS)])


@st.composite
def wide_expressions(draw: st.DrawFn, scope: tuple[str, ...], depth: int = 3) -> Expression:
    """Draw an expression of the whole language; otherwise as `expressions`."""
    if depth == 0:
        return draw(st.one_of(_atoms(scope, True), st.builds(Same, _objects(scope), _objects(scope))))
    variable = f"y{depth}"
    inside, inner = wide_expressions(scope, depth - 1), wide_expressions((*scope, variable), depth - 1)
    match draw(st.sampled_from(["leaf", "and", "or", "not", "exists", "every", "count", "was"])):
        case "and":
            return And(draw(inside), draw(inside))
        case "or":
            return Or(draw(inside), draw(inside))
        case "not":
            return Not(draw(inside))
        case "exists":
            return Exists(variable, draw(inner))
        case "every":
            return Every(variable, draw(inner), draw(inner))
        case "count":
            kind = draw(st.sampled_from(list[CountKind](["exactly", "at least", "at most"])))
            return Count(kind, draw(st.integers(0, 20)), variable, draw(inner))
        case "was":
            return Was(draw(inside))
    return draw(wide_expressions(scope, 0))


@st.composite
def lambdas(draw: st.DrawFn, numbers: bool = False) -> Lambda:
    """Draw a description, whose binders are called x, y1, y2, .. from left to right."""
    return Lambda("x", _numbered(draw(expressions(("x",), 3, numbers)), {"x": "x"}, count(1)))


@st.composite
def wide_lambdas(draw: st.DrawFn) -> Lambda:
    """Draw a description of any kind, whose binders are called x, y1, y2, .. from left to right."""
    kind = draw(st.sampled_from(list[DescriptionKind](["lambda", "the", "heaviest", "lightest", "nearest"])))
    to = Name(draw(st.sampled_from(OBJECTS))) if kind == "nearest" else None
    return Lambda("x", _numbered(draw(wide_expressions(("x",))), {"x": "x"}, count(1)), kind, to)


@st.composite
def sentences(draw: st.DrawFn) -> Sentence:
    """Draw a statement about the world; it is no mere conjunction of atoms."""
    body = _numbered(draw(wide_expressions(())), {}, count(1))
    return Sentence(Not(body) if _are_atoms(body) else body)


def _are_atoms(body: Expression) -> bool:
    return isinstance(body, Atom) or (isinstance(body, And) and _are_atoms(body.left) and _are_atoms(body.right))


def _numbered(expression: Expression, names: dict[str, str], numbers: Iterator[int]) -> Expression:
    """Return the expression with its binders numbered; `names` maps each variable in scope to its new name."""
    match expression:
        case And(left, right):
            return And(_numbered(left, names, numbers), _numbered(right, names, numbers))
        case Or(left, right):
            return Or(_numbered(left, names, numbers), _numbered(right, names, numbers))
        case Exists(variable, body):
            new = f"y{next(numbers)}"
            return Exists(new, _numbered(body, {**names, variable: new}, numbers))
        case Count(kind, number, variable, body):
            new = f"y{next(numbers)}"
            return Count(kind, number, new, _numbered(body, {**names, variable: new}, numbers))
        case Every(variable, condition, body):
            new = f"y{next(numbers)}"
            inner = {**names, variable: new}
            return Every(new, _numbered(condition, inner, numbers), _numbered(body, inner, numbers))
        case Not(body):
            return Not(_numbered(body, names, numbers))
        case Was(body):
            return Was(_numbered(body, names, numbers))
        case Same(left, right):
            return Same(_renamed(left, names), _renamed(right, names))
        case Atom(relation, arguments):
            return Atom(relation, tuple(a if isinstance(a, Number) else _renamed(a, names) for a in arguments))


def _renamed(argument: Object, names: dict[str, str]) -> Object:
    return Variable(names[argument.name]) if isinstance(argument, Variable) else argument


@st.composite
def goals(draw: st.DrawFn) -> Goal:
    """Draw a goal with one or two existential variables, each used."""
    variables = draw(st.sampled_from([("o",), ("o", "q")]))
    first: list[Conjunct] = [Designated(Variable(name)) for name in variables]
    return Goal(variables, (*first, *draw(st.lists(_conjuncts(variables), max_size=4))))


@st.composite
def wide_goals(draw: st.DrawFn) -> Goal:
    """Draw a goal of the whole language with up to three existential variables, each used."""
    variables = draw(st.sampled_from([(), ("o",), ("o", "q"), ("o", "q", "r")]))
    groups = draw(st.sampled_from([(), (variables[:2],), (variables[-2:],)])) if len(variables) > 1 else ()
    used: list[Conjunct] = [Designated(Variable(name)) for name in variables]
    conjuncts = st.one_of(_conjuncts(variables), _wide_conjuncts(variables))
    return Goal(variables, (*used, *draw(st.lists(conjuncts, min_size=1, max_size=3))), groups)


@st.composite
def _wide_conjuncts(draw: st.DrawFn, variables: tuple[str, ...]) -> Believed:
    about, dens = _objects(variables), st.builds(Den, wide_lambdas(), _objects(variables))
    atoms = st.builds(lambda a: Atom("On", (a, Name("table1"))), about)
    holds = st.builds(lambda a: Holds(("Green", "Heavy"), a), about)
    parts = st.lists(st.one_of(dens, atoms, holds), min_size=2, max_size=3)
    together = st.builds(lambda found: Together(tuple(found)), parts)
    return Believed(draw(st.one_of(dens, sentences(), together)), draw(st.floats(0.001, 0.999)))


@st.composite
def _conjuncts(draw: st.DrawFn, variables: tuple[str, ...]) -> Conjunct:
    about: Object = draw(_objects(variables))
    p = draw(st.floats(0.001, 0.999))
    match draw(st.sampled_from(["den", "atom", "on", "holds", "estimated"])):
        case "den":
            return Believed(Den(draw(lambdas(numbers=True)), about), p)
        case "atom":
            return Believed(Atom(draw(st.sampled_from(PROPERTIES)), (about,)), p)
        case "on":
            return Believed(Atom("On", (about, Name("table1"))), p)
        case "holds":
            words = draw(st.lists(st.sampled_from(PROPERTIES), min_size=1, max_size=3, unique=True))
            return Believed(Holds(tuple(words), about), p)
    quantity = draw(st.sampled_from(list[QuantityName](["pose", "colour", "weight"])))

    def vector(low: float) -> st.SearchStrategy[tuple[float, ...]]:
        n = DIMENSIONS[quantity]
        return st.lists(st.floats(low, 100.0), min_size=n, max_size=n).map(tuple)

    mean = draw(st.one_of(st.none(), vector(-100.0)))
    return Estimated(quantity, about, mean, draw(vector(0.001)), draw(vector(0.001)), p)
