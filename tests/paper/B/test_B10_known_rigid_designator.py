"""B10: KRD(A) is true if and only if A is an internal anchor; every operation on an object needs it."""

from pathlib import Path

import pytest
from kit.papers import (
    NINE,
    STANDS,
    Handler,
    at_five_percent,
    can,
    only,
    planned,
    posed,
    preconditions,
    results,
    seen_as,
    shipped,
    with_own_rules,
)

from skolem.reasoner.lint.fluent_kinds import COMMANDS
from skolem.reasoner.lint.linting import findings
from skolem.reasoner.terms import parse_term

GOAL = "exists o. B(Den(lambda x. Soda(x) & Green(x) & Heavy(x), o), 0.9) & B(On(o, table1), 0.9)"
OPERATIONS = {
    "look": "bn(colour({}),any,sd(20,50,50),any,1)",
    "weigh": "bn(weight({}),any,sd(100),any,1)",
    "pick": "holding({})",
    "place": "b(on({},table1),105361)",
}

ON_OBJECTS = sorted(command for command in COMMANDS if "object" in command)


def robot() -> Handler:
    """A robot that was told of one can and has discovered another."""
    made = Handler(at_five_percent([can("given")]))
    there = (1.1, 0.3, 0.7, 0.0)
    for _ in range(2):
        made.see(seen_as(STANDS), seen_as(there))
    assert made.belief.anchors() == ("table1", "given", "_o1_")
    return made


@pytest.mark.parametrize(
    ("designator", "known"),
    [("given", True), ("_o1_", True), ("table1", True), ("_o2_", False), ("e1", False), ("sk(var(o))", False)],
    ids=["a name given in advance", "a discovered anchor", "a table", "no anchor", "lambda", "Skolem constant"],
)
def test_anchors_are_rigid_designators_and_nothing_else_is(designator: str, known: bool) -> None:
    """ "It has value True if and only if A is an internal anchoring constant." """
    assert posed(GOAL, robot().belief).situation.holds(parse_term(f"krd({designator})")) is known


@pytest.mark.parametrize("operator", OPERATIONS)
def test_every_operation_on_an_object_needs_it_before_anything_else(operator: str) -> None:
    """ "A precondition for any operation on an object will be that we know a rigid designator for it." """
    offered = posed(GOAL, robot().belief).offers.offers(parse_term(OPERATIONS[operator].format("given")))
    operations = [i for i in offered if str(i.executes).startswith(operator)]
    assert operations
    assert all(("krd(given)", 0) in preconditions(i) for i in operations)


def test_these_are_all_the_operations_on_objects_there_are() -> None:
    """ "Any operation on an object": whoever adds one adds it here."""
    assert {command.partition("(")[0] for command in ON_OBJECTS} == set(OPERATIONS)


def test_no_shipped_rule_for_an_operation_on_an_object_is_without_it() -> None:
    """ "A precondition for any operation on an object": by reflection over every rule that executes something."""
    assert [finding for finding in findings(shipped()) if finding.code == "without_krd"] == []


@pytest.mark.parametrize("command", ON_OBJECTS)
def test_a_rule_for_any_operation_on_an_object_that_lacks_it_is_found(command: str, tmp_path: Path) -> None:
    """ "We know a rigid designator for it": the reflection sees every command."""
    arguments = {"hand": "right", "object,object": "O, S", "object": "O", "any": "nothing"}
    executed = command
    for sort, written in arguments.items():
        executed = executed.replace(sort, written)
    rule = "step(X), X = shove(O, S)"
    text = (
        "step(shove(O, S)) :- goal(b(on(O, S), _)), @rigid(S) = 1.\n"
        f"result(X, b(on(O, S), P)) :- {rule}, goal(b(on(O, S), P)).\n"
        f"executes(X, {executed}) :- {rule}.\n"
        f"precond(X, loose(O), 0) :- {rule}.\n"
    )
    book = with_own_rules(tmp_path, text)
    found = [f.fault.line for f in findings(book) if f.code == "without_krd"]
    assert found == [3]
    krd = f"precond(X, krd(O), 0) :- {rule}.\n"
    assert [f for f in findings(with_own_rules(tmp_path, text + krd)) if f.code == "without_krd"] == []


def test_no_operation_can_be_carried_out_on_what_is_not_an_anchor() -> None:
    """ "We cannot call it on lambda x. green(x) until we know of a specific object." """
    at = posed(GOAL, robot().belief)
    assert at.offers.offers(parse_term("holding(sk(var(o)))")) == ()
    place = only(at, f"b(on(sk(var(o)),table1),{NINE})")
    assert place.on_placeholder
    assert ("krd(sk(var(o)))", 0) in preconditions(place)
    assert planned(at, f"b(on(sk(var(o)),table1),{NINE})", level=1).steps is None


def test_a_goal_may_ask_for_it_and_examining_and_finding_give_it() -> None:
    """ "result: ... KRD(Obj)." """
    at = posed(f"{GOAL} & KRD(o)", robot().belief)
    assert any(str(f) == "krd(given)" for root in at.instantiations for f in root)
    assert "krd(given)" in results(only(at, f"b(den(e1,given),{NINE})"))
    assert "krd(sk(var(o)))" in results(only(at, f"b(den(e1,sk(var(o))),{NINE})"))
