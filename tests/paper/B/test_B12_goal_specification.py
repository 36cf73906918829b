"""B12: a goal is a formal specification."""

import pytest
from hypothesis import given
from kit.descriptions import OBJECTS, RELATIONS, goals
from kit.draws import examples
from kit.papers import EXAMPLE_GOAL, GREEN_TO_TABLE1, shipped

from skolem.reasoner.language.expressions import Goal
from skolem.reasoner.language.parser import parse_goal
from skolem.traces.errors import InputError

PAPERS = {
    "example": EXAMPLE_GOAL,
    "sim 1": GREEN_TO_TABLE1,
    "sim 2": "exists o. B(Den(lambda x. And(Heavy(x), Soda(x)), o), 0.9) & B(In(o, table1), 0.9)",
    "real 1": "exists o. B(Den(lambda x. Heavy(x), o), 0.9) & B(In(o, table1), 0.9)",
}


@pytest.mark.parametrize("text", PAPERS.values(), ids=PAPERS)
def test_every_goal_of_the_paper_is_read_and_prints_as_text_that_reads_back_equal(text: str) -> None:
    """ "Given a formal specification of a desired situation." """
    words = shipped().vocabulary.words()
    goal = parse_goal(text, words)
    assert parse_goal(str(goal), words) == goal
    assert goal.variables == ("o",)
    assert len(goal.fluents) == 2


@given(goals())
@examples(40)
def test_so_does_any_goal(goal: Goal) -> None:
    """ "A formal specification": text and meaning are one to one."""
    assert parse_goal(str(goal), RELATIONS, OBJECTS) == goal


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("put the green can on the desk", 1, 1, "expected B(phi, p)"),
        (
            "exists o.\n  B(On(the x. Green(x), desk), 0.9)",
            2,
            8,
            "a description cannot stand in the place of an object",
        ),
        ("exists o.\n  B(Den(lambda x. Green(x), o), 1.9)", 2, 33, "expected a probability between 0 and 1"),
        ("exists o.\n  B(Den(lambda x. Shiny(x), o), 0.9)", 2, 19, "no relation 'Shiny'"),
    ],
)
def test_what_is_no_specification_is_refused_with_line_and_column(
    text: str, line: int, column: int, message: str
) -> None:
    """ "There is no uncertainty about the specification": natural language is not read."""
    with pytest.raises(InputError) as caught:
        parse_goal(text, shipped().vocabulary.words())
    fault = caught.value.faults[-1]
    assert (fault.line, fault.column) == (line, column)
    assert message in fault.message
