"""C13: PropsFor names the properties that it would be useful to know."""

import pytest
from kit.papers import EXAMPLE_GOAL, NINE, example, first_decision, only, planned, posed, steps_of

from skolem.reasoner.terms import Compound

SHARE = 0.9 ** (1.0 / 3.0)  # .9655: what each of three properties must be believed with


def props(soda: float, green_sd: float = 0.0388) -> str:
    """Return PropsFor of o2 of the example, when it is a can with probability `soda`."""
    belief = example().belief
    belief.things["o2"].types = {"soda": soda, "bottle": 1.0 - soda}
    belief.things["o2"].hsv_sd = green_sd
    step = only(posed(EXAMPLE_GOAL, belief), f"b(den(e1,o2),{NINE})").step
    assert isinstance(step, Compound)
    return str(step.args[1])


@pytest.mark.parametrize(
    ("soda", "asked"),
    [
        (0.99, "(heavy,)"),
        (SHARE + 1e-4, "(heavy,)"),
        (SHARE - 1e-4, "(heavy,soda)"),
        (0.80, "(heavy,soda)"),
    ],
)
def test_a_property_is_asked_for_if_it_is_believed_less_than_its_share(soda: float, asked: str) -> None:
    """ "It already believes that it is green and a can, and so the weight is the crucial property to observe." """
    assert props(soda) == asked


def test_a_colour_that_is_not_sure_is_asked_for_too() -> None:
    """ "Which object properties would be useful to know in order to determine the denotation of the expression." """
    assert props(0.99, green_sd=0.2) == "(green,heavy)"


def test_the_plan_observes_just_those() -> None:
    """ "The crucial property to observe." """
    for soda, looks in ((0.99, 0), (0.80, 1)):
        belief = example().belief
        belief.things["o2"].types = {"soda": soda, "bottle": 1.0 - soda}
        steps = steps_of(planned(posed(EXAMPLE_GOAL, belief), f"b(den(e1,o2),{NINE})", level=1))
        names = [str(step.instance.step).partition("(")[0] for step in steps]
        assert names.count("look") == looks
        assert names.count("weigh") == 1


def test_the_example_of_the_paper_examines_o2() -> None:
    """ "The highest-level plan has two abstract steps." """
    assert first_decision(example()) == ("ExamineObj(e1, o2)", "Place(o2, desk)")
