"""B8: atoms are relations of numeric constants and anchors."""

import pytest
from kit.papers import Handler, at_five_percent, can, denotes, posed, shipped

from skolem.estimation.events import Looked, Missed
from skolem.reasoner.language.descriptions import Atom, Name, Number, Variable
from skolem.reasoner.language.parser import parse_goal, parse_lambda
from skolem.reasoner.planning.goals import achieved_by
from skolem.traces.errors import InputError

WORDS = shipped().vocabulary.words() | {"Near": 2, "HeavierThan": 2, "Between": 3}


@pytest.mark.parametrize(
    ("text", "atom"),
    [
        ("Green(x)", Atom("Green", (Variable("x"),))),
        ("Near(x, desk)", Atom("Near", (Variable("x"), Name("desk")))),
        ("HeavierThan(x, 400)", Atom("HeavierThan", (Variable("x"), Number(400.0)))),
        ("Between(x, _o34_, desk)", Atom("Between", (Variable("x"), Name("_o34_"), Name("desk")))),
    ],
)
def test_a_relation_takes_variables_anchors_and_numbers_in_any_number(text: str, atom: Atom) -> None:
    """ "R(c1, .., cn) where c1, .., cn are numeric constants or anchors to objects." """
    assert parse_lambda(f"lambda x. {text}", WORDS, ["desk", "_o34_"]).body == atom


def test_a_relation_of_a_variable_and_an_anchor_is_evaluated() -> None:
    """ "We assume the ability to find the probability of a ground relational expression." """
    belief = Handler(at_five_percent([can("can1", 1.0)])).belief
    values = denotes("lambda x. On(x, table1)", belief)
    assert values["can1"] == pytest.approx(belief.prob_exists("can1") * belief.prob_on("can1", "table1"))
    assert values["table1"] == 0.0


@pytest.mark.parametrize(
    ("line", "column", "message"),
    [
        ("Green(z)", 7, "'z' is neither a bound variable nor a known object"),
        ("On(x, table9)", 7, "'table9' is neither a bound variable nor a known object; did you mean 'table1'?"),
        ("Green(x, table1)", 1, "Green takes 1 argument, not 2"),
        ("Green(400)", 7, "expected an object, found the number 400"),
    ],
)
def test_what_is_not_ground_in_the_end_is_an_error_in_its_place(line: str, column: int, message: str) -> None:
    """ "Numeric constants or anchors": anything else is refused, with line and column."""
    text = f"exists o. B(Den(lambda x.\n{line}, o), 0.9)"
    with pytest.raises(InputError) as caught:
        parse_goal(text, shipped().vocabulary.words(), ["table1"])
    (fault,) = caught.value.faults
    assert (fault.line, fault.column) == (2, column)
    assert message in fault.message


def test_a_goal_may_name_anchors_inside_a_description() -> None:
    """ "Anchors to objects." """
    belief = Handler(at_five_percent([can("can1", 1.0), can("can2", 1.0, (1.1, 0.3, 0.7, 0.0))])).belief
    goal = "exists o. B(Den(lambda x. Soda(x) & On(x, table1) & Soda(can2), o), 0.9)"
    assert posed(goal, belief).achieved() is not None


def test_of_what_is_refuted_no_property_is_believed() -> None:
    """A thing that looks in vain have shown not to be there is neither green nor a soda, whatever it was told to be."""
    belief = Handler(at_five_percent([can("can1", 1.0)])).belief
    goals = ("B(Soda(can1), 0.9)", "B(Holds((Soda,), can1), 0.9)", "B(On(can1, table1), 0.9)")
    asked = [parse_goal(goal, WORDS, None) for goal in goals]
    assert all(achieved_by(goal, shipped(), belief) is not None for goal in asked)
    while "can1" in belief.anchors():
        in_vain = Missed(anchor="can1", p_reported=0.9, solid=0.0)
        belief.apply(Looked(camera_covariance=(1e-9, 0, 0, 1e-9, 0, 1e-9), sightings=(), missed=(in_vain,)))
    assert all(achieved_by(goal, shipped(), belief) is None for goal in asked)


def test_where_a_thing_stands_counts_its_existence_once() -> None:
    belief = Handler(at_five_percent([can("can1", 1.0)])).belief
    on = denotes("lambda x. On(x, table1)", belief)["can1"]
    assert on == pytest.approx(belief.prob_exists("can1"), abs=0.005)
