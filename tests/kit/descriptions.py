"""Hypothesis strategies for goals and descriptions, shared by the tests of the language and of its meaning."""

from collections.abc import Iterator
from itertools import count

from hypothesis import strategies as st

from skolem.reasoner.language.descriptions import (
    And,
    Argument,
    Atom,
    Exists,
    Expression,
    Lambda,
    Name,
    Number,
    Object,
    Or,
    Variable,
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
    arguments: st.SearchStrategy[Argument] = st.one_of(
        st.sampled_from(scope).map(Variable), st.sampled_from(OBJECTS).map(Name)
    )
    if numbers and draw(st.booleans()):
        return Atom("HeavierThan", (draw(arguments), Number(draw(st.floats(-1e3, 1e3)))))
    if draw(st.booleans()):
        return Atom(draw(st.sampled_from(["On", "In"])), (draw(arguments), draw(arguments)))
    return Atom(draw(st.sampled_from(PROPERTIES)), (draw(arguments),))


@st.composite
def lambdas(draw: st.DrawFn, numbers: bool = False) -> Lambda:
    """Draw a description, whose binders are called x, y1, y2, .. from left to right."""
    return Lambda("x", _numbered(draw(expressions(("x",), 3, numbers)), {"x": "x"}, count(1)))


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
        case Atom(relation, arguments):
            renamed = tuple(Variable(names[a.name]) if isinstance(a, Variable) else a for a in arguments)
            return Atom(relation, renamed)
    raise AssertionError(f"{expression} is not of the paper's language")


@st.composite
def goals(draw: st.DrawFn) -> Goal:
    """Draw a goal with one or two existential variables, each used."""
    variables = draw(st.sampled_from([("o",), ("o", "q")]))
    first: list[Conjunct] = [Designated(Variable(name)) for name in variables]
    return Goal(variables, (*first, *draw(st.lists(_conjuncts(variables), max_size=4))))


@st.composite
def _conjuncts(draw: st.DrawFn, variables: tuple[str, ...]) -> Conjunct:
    about: Object = draw(st.one_of(st.sampled_from(variables).map(Variable), st.sampled_from(OBJECTS).map(Name)))
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
