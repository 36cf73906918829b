"""Instances as the rules' atoms give them: parts, levels, names."""

import pytest

from skolem.reasoner.planning.instances import Instance, read_instances, title
from skolem.reasoner.terms import Term, parse_term
from skolem.traces.errors import InternalError


def atoms(*texts: str) -> dict[str, list[tuple[Term, ...]]]:
    """Return ground atoms by predicate, as an answer of the rules has them."""
    found: dict[str, list[tuple[Term, ...]]] = {}
    for text in texts:
        term = parse_term(text)
        found.setdefault(term.name, []).append(term.args)  # type: ignore[union-attr]
    return found


def read(*texts: str) -> tuple[Instance, ...]:
    return read_instances(atoms(*texts))


def test_preconditions_are_demanded_up_to_a_level_and_postponed_above_it() -> None:
    [step] = read("candidate(s)", "precond(s,c,1)", "precond(s,a,0)", "precond(s,b,2)")
    texts = [([str(f) for f in step.demanded(level)], [str(f) for f in step.postponed(level)]) for level in (0, 1, 2)]
    assert texts == [(["a"], ["b", "c"]), (["a", "c"], ["b"]), (["a", "b", "c"], [])]
    assert step.concrete == 2


def test_instances_come_in_the_order_of_their_text_with_what_is_said_of_each() -> None:
    found = read(
        "candidate(pick(b))",
        "candidate(look(c))",
        "candidate(look(a))",
        "executes(look(a),look(a))",
        "cost(look(a),seen,7)",
        "cost(look(a),there,5)",
        "operation(look(a),look_at(a))",
        "immediate(look(c))",
        "rejected(pick(b),far)",
        "rejected(pick(b),blocked)",
    )
    assert [str(instance.step) for instance in found] == ["look(a)", "look(c)", "pick(b)"]
    assert [instance.price for instance in found] == [12, 0, 0]
    assert [str(instance.operation) for instance in found] == ["look_at(a)", "look(c)", "pick(b)"]
    assert [instance.immediate for instance in found] == [False, True, False]
    assert [instance.rejected for instance in found] == [(), (), ("blocked", "far")]
    assert [instance.executes for instance in found] == [parse_term("look(a)"), None, None]


@pytest.mark.parametrize("wrong", ["precond(s,a,-1)", "cost(s,a,-1)", "cost(s,a,b)"])
def test_a_level_or_cost_that_is_no_number_from_0_is_told(wrong: str) -> None:
    with pytest.raises(InternalError, match=r"where a whole number from 0 was expected"):
        read("candidate(s)", wrong)


def test_an_operation_is_titled_for_people() -> None:
    assert title(parse_term("look_at(o2,table1)")) == "LookAt(o2, table1)"
    assert title(parse_term("wait")) == "wait"
