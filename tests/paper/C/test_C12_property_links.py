"""C12: symbolic properties are linked to the quantities below them."""

import pytest
from kit.papers import EXAMPLE_GOAL, NINE, example, only, planned, posed, preconditions, steps_of


def executed(fluent: str, level: int) -> list[str]:
    """Return the primitives of the plan for a fluent."""
    steps = steps_of(planned(posed(EXAMPLE_GOAL, example().belief), fluent, level=level))
    return [str(step.instance.executes) for step in steps if step.instance.executes is not None]


def test_from_green_the_chain_ends_in_looking() -> None:
    """ "To gather information about the color of an object, it is necessary to look at it." """
    assert executed(f"b(supposed(green,o3),{NINE})", 0) == ["look(o3)"]


def test_from_heavy_the_chain_ends_in_weighing_what_was_picked() -> None:
    """ "The weight is the crucial property to observe; when it picks up the object, it will observe that." """
    assert executed(f"b(supposed(heavy,o3),{NINE})", 0) == ["weigh(o3)"]
    assert [e.partition("(")[0] for e in executed(f"b(supposed(heavy,o3),{NINE})", 1)] == ["pick", "weigh"]


@pytest.mark.parametrize(
    ("word", "quantity"), [("green", "bn(colour(o3)"), ("heavy", "bn(weight(o3)"), ("soda", "b(type(o3,soda)")]
)
def test_each_property_has_its_quantity(word: str, quantity: str) -> None:
    """ "Inference rules that connect symbolic properties, such as Green, with underlying object properties." """
    rule = only(posed(EXAMPLE_GOAL, example().belief), f"b(supposed({word},o3),35120)")
    assert sum(fluent.startswith(quantity) for fluent, _ in preconditions(rule)) == 1
    assert rule.executes is None
