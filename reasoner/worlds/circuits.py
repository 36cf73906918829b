"""Circuits: the axioms of `denote.lp` give a description the nodes that compute its value.

A node stands for an expression over variables. Which value it has, the evaluation says: the product of the paper
(`reasoner/planning/denotation.py`), or the probability of the worlds in which it is true (`grounding`).
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Final

from skolem.reasoner.language.descriptions import (
    And,
    Atom,
    Count,
    Every,
    Exists,
    Expression,
    Lambda,
    Not,
    Or,
    Same,
    Was,
    argument_term,
    constant_of,
    object_term,
)
from skolem.reasoner.language.expressions import Sentence
from skolem.reasoner.rulebook.book import Rulebook
from skolem.reasoner.rulebook.vocabulary import comparison
from skolem.reasoner.terms import ANY, Compound, Term, compound
from skolem.traces.errors import InternalError

_NOTHING: Final = Compound("", ())


@dataclass(frozen=True, slots=True)
class Leaf:
    """Belief in a relation of variables `var(x)` and anchors."""

    relation: str
    args: tuple[Term, ...]


@dataclass(frozen=True, slots=True)
class Product:
    """Both hold; in the paper a b."""

    left: "Node"
    right: "Node"


@dataclass(frozen=True, slots=True)
class Either:
    """At least one holds; in the paper a + b - a b."""

    left: "Node"
    right: "Node"


@dataclass(frozen=True, slots=True)
class EitherOver:
    """It holds for some object; in the paper 1 - the product over all known objects of 1 - P(it exists) a."""

    variable: Term
    inner: "Node"


@dataclass(frozen=True, slots=True)
class Complement:
    """It does not hold."""

    inner: "Node"


@dataclass(frozen=True, slots=True)
class Identical:
    """Both arguments, variables or anchors, are one object."""

    left: Term
    right: Term


@dataclass(frozen=True, slots=True)
class Counted:
    """It holds for at least `least` and at most `most` objects; None: for any greater number too."""

    variable: Term
    inner: "Node"
    least: int
    most: int | None


@dataclass(frozen=True, slots=True)
class Earlier:
    """It held when the goal was stated."""

    inner: "Node"


@dataclass(frozen=True, slots=True)
class Renamed:
    """It holds if `variable` stands for what `meant` stands for."""

    variable: Term
    meant: Term
    inner: "Node"


Node = Leaf | Product | Either | EitherOver | Complement | Identical | Counted | Earlier | Renamed


@dataclass(frozen=True, slots=True)
class Circuit:
    """A compiled description.

    Attributes:
        variable: The variable that the lambda binds; of a sentence, one that nothing mentions.
        root: The node of the whole description.
        props: Names of the properties of the described object itself, sorted.
        compared: Relation and thousandths of those properties that compare it with a number, by name.
    """

    variable: Term
    root: Node
    props: tuple[str, ...]
    compared: Mapping[str, tuple[str, int]]


def compile_description(description: Lambda, rulebook: Rulebook) -> Circuit:
    """Return the circuit that the denotation axioms give for a description.

    Raises:
        InternalError: If the axioms do not cover it.
    """
    kind: Term = description.kind
    if description.to is not None:
        kind = compound(description.kind, object_term(description.to))
    return _compiled(description.variable, description.body, kind, str(description), rulebook)


def compile_sentence(sentence: Sentence, rulebook: Rulebook) -> Circuit:
    """Return the circuit that the denotation axioms give for a sentence.

    Raises:
        InternalError: If the axioms do not cover it.
    """
    return _compiled(_NOTHING, sentence.body, "lambda", str(sentence), rulebook)


def _compiled(variable: Term, body: Expression, kind: Term, text: str, rulebook: Rulebook) -> Circuit:
    term = expression_term(body)
    facts = [compound("lambda", "e", variable, term), compound("kind", "e", kind)]
    atoms = rulebook.solve(facts, None, ["denote"]).atoms
    if atoms.get("bad"):
        reasons = ", ".join(str(reason) for _, reason in atoms["bad"])
        raise InternalError(f"rules/denote.lp: {text} is not legal: {reasons}")
    if kind == "lambda" and not rulebook.stating(("whole", 2)):
        atoms["whole"] = [("e", term)]  # rules of an older trace: they have no other kind
    if not atoms.get("whole"):
        raise InternalError(f"rules/denote.lp says of no expression that it is the whole of {text}")
    axioms = {expression: node for expression, node in atoms["axiom"]}
    ((_, whole),) = atoms["whole"]
    bound, root = compound("var", variable), _node(whole, axioms)
    props = {str(word) for _, word in atoms.get("props", [])}
    numbers = {found for leaf in leaves(root) if (found := compared_in(leaf, bound))}
    compared = {comparison(*found): found for found in sorted(numbers)}
    return Circuit(bound, root, tuple(sorted({*props, *compared})), compared)


def expression_term(expression: Expression) -> Term:
    """Return the term of an expression that `denote.lp` reads."""
    match expression:
        case And(left, right):
            return compound("and", expression_term(left), expression_term(right))
        case Or(left, right):
            return compound("or", expression_term(left), expression_term(right))
        case Exists(variable, body):
            return compound("exists", variable, expression_term(body))
        case Not(body):
            return compound("no", expression_term(body))
        case Same(left, right):
            return compound("same", argument_term(left), argument_term(right))
        case Count(kind, number, variable, body):
            return compound(kind.replace(" ", "_"), number, variable, expression_term(body))
        case Every(variable, condition, body):
            return compound("every", variable, expression_term(condition), expression_term(body))
        case Was(body):
            return compound("was", expression_term(body))
        case Atom(word, args):
            pairs = reduce(lambda rest, first: compound("", argument_term(first), rest), reversed(args), _NOTHING)
            return compound("r", constant_of(word), pairs)


def _node(expression: Term, axioms: Mapping[Term, Term]) -> Node:
    """Return the node of an expression; an expression that is already a node's form is read as one."""
    axiom = axioms.get(expression, expression)
    match axiom:
        case Compound("belief", (str(relation), args)):
            return Leaf(relation, tuple(_unpaired(args)))
        case Compound("product", (left, right)):
            return Product(_node(left, axioms), _node(right, axioms))
        case Compound("either", (left, right)):
            return Either(_node(left, axioms), _node(right, axioms))
        case Compound("either_over", (variable, inner)):
            return EitherOver(compound("var", variable), _node(inner, axioms))
        case Compound("complement", (inner,)):
            return Complement(_node(inner, axioms))
        case Compound("identical", (left, right)):
            return Identical(left, right)
        case Compound("count", (variable, inner, int(least), most)):
            return Counted(
                compound("var", variable), _node(inner, axioms), least, None if most == ANY else int(str(most))
            )
        case Compound("earlier", (inner,)):
            return Earlier(_node(inner, axioms))
        case Compound("renamed", (variable, meant, inner)):
            return Renamed(compound("var", variable), compound("var", meant), _node(inner, axioms))
    raise InternalError(f"rules/denote.lp gives {axiom} for {expression}; expected a circuit node")


def parts(node: Node) -> tuple[Node, ...]:
    """Return the nodes directly inside a node."""
    match node:
        case Leaf() | Identical():
            return ()
        case Product(left, right) | Either(left, right):
            return (left, right)
        case EitherOver() | Complement() | Counted() | Earlier() | Renamed():
            return (node.inner,)


def leaves(node: Node) -> Iterator[Leaf]:
    """Yield the leaves of a node, from left to right."""
    if isinstance(node, Leaf):
        yield node
    for part in parts(node):
        yield from leaves(part)


def compared_in(leaf: Leaf, variable: Term) -> tuple[str, int] | None:
    """Return relation and thousandths of a leaf that compares the variable with a number; None for other leaves."""
    match leaf.args:
        case (one, Compound("number", (int(thousandths),))) if one == variable:
            return leaf.relation, thousandths
    return None


def _unpaired(pairs: Term) -> Iterable[Term]:
    while isinstance(pairs, Compound) and pairs.args:
        first, pairs = pairs.args
        yield first
