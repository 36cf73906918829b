"""Many questions in one call, over a slice of the rules, against each question alone over all of them."""

from collections.abc import Callable, Iterable, Sequence

import clingo
import pytest
from clingo import ast
from kit.papers import EXAMPLE_GOAL, example, posed, shipped

from skolem.reasoner.planning.goals import PosedGoal
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.asking import Asked
from skolem.reasoner.terms import Compound, Term, compound, from_symbol, parse_term, to_symbol

FILES = [name.removesuffix(".lp") for name in shipped().files if name not in ("denote.lp", "mutex.lp")]
Atoms = dict[str, list[tuple[Term, ...]]]


class Context:
    """Passes @functions on as clingo calls them."""

    def __init__(self, queries: Queries) -> None:
        self._queries = queries

    def __getattr__(self, name: str) -> Callable[..., list[clingo.Symbol]]:
        def call(*symbols: clingo.Symbol) -> list[clingo.Symbol]:
            found: Term | list[Term] = getattr(self._queries, name)(*map(from_symbol, symbols))
            return [to_symbol(term) for term in (found if isinstance(found, list) else [found])]

        return call


def alone(facts: Iterable[Term], queries: Queries) -> Atoms:
    """Return what all rules together give for facts, without numbers or slices."""
    control = clingo.Control(["--warn=none"])
    with ast.ProgramBuilder(control) as builder:
        for file, statements in shipped().sources:
            for statement in statements if file.name in FILES else ():
                builder.add(statement)
        ast.parse_string(" ".join(f"{fact}." for fact in facts), builder.add)
    control.ground([("base", [])], context=Context(queries))
    symbols: list[clingo.Symbol] = []
    control.solve(on_model=lambda model: symbols.extend(model.symbols(shown=True)))
    found: Atoms = {}
    for term in sorted(map(from_symbol, symbols), key=str):
        assert isinstance(term, Compound)
        found.setdefault(term.name, []).append(term.args)
    return found


def closure(at: PosedGoal) -> list[Term]:
    """Return every fluent that regression from the goal could ever ask about, sorted."""
    found: dict[Term, None] = {}
    waiting = [fluent for root in at.instantiations for fluent in root]
    while waiting:
        fluent = waiting.pop()
        if fluent not in found:
            found[fluent] = None
            waiting += [need for instance in at.offers.offers(fluent) for need, _ in instance.preconditions]
    return sorted(found, key=str)


@pytest.fixture(scope="module")
def at() -> PosedGoal:
    play = example()
    play.belief.things["o3"].hand = "left"
    return posed(EXAMPLE_GOAL, play.belief, geometry=play.geometry)


@pytest.fixture(scope="module")
def queries(at: PosedGoal) -> Queries:
    return Queries(at.situation, {"e1": (("green", "heavy", "soda"),)})


def test_every_fluent_of_the_example_gets_the_same_answer_alone_in_a_slice_and_among_all(
    at: PosedGoal, queries: Queries
) -> None:
    fluents = closure(at)
    assert len(fluents) > 100
    questions = [(compound("goal", fluent),) for fluent in fluents]
    together = shipped().solve_each(questions, Asked(queries), FILES)
    for facts, atoms in zip(questions, together.atoms, strict=True):
        expected = alone(facts, queries)
        assert atoms == expected, facts
        assert shipped().solve(facts, queries, FILES).atoms == expected


def test_one_question_with_several_facts_is_answered_as_by_all_rules(at: PosedGoal, queries: Queries) -> None:
    texts = ("posed(b(den(e1,var(o)),105361))", "posed(b(on(var(o),desk),105361))", "open(var(o))", "goal(holding(o1))")
    facts = [parse_term(text) for text in texts]
    assert shipped().solve(facts, queries, FILES).atoms == alone(facts, queries)


def test_a_question_sees_nothing_of_another_one(queries: Queries) -> None:
    """A step offered for two fluents of one subgoal gives both; asked apart it gives one each time."""
    colour, kind = parse_term("bn(colour(o1),v(350,800,800),sd(99,99,99),tol(90,90,90),693147)"), "b(type(o1,soda),9)"
    fluents: Sequence[Term] = [colour, parse_term(kind)]
    answers = shipped().solve_each([(compound("goal", f),) for f in fluents], Asked(queries), FILES)
    for fluent, atoms in zip(fluents, answers.atoms, strict=True):
        assert atoms["result"] == [(parse_term("look(o1)"), fluent)]
    both = shipped().solve([compound("goal", f) for f in fluents], queries, FILES)
    assert len(both.atoms["result"]) == 2


def test_what_no_rule_achieves_needs_no_call() -> None:
    answers = shipped().solve_each([(parse_term("goal(at(nowhere,ever))"),)], Asked(None), FILES)
    assert not answers.asked
    assert answers.atoms == [{}]
