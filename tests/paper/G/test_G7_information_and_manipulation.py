"""G7: the robot plans to gather information and to manipulate, for one goal and in one plan."""

import pytest
from kit.papers import plans, rehearsed
from kit.runs import Run, with_physics

GATHERING, MANIPULATION = {"LookAt", "LookAtRegion", "Weigh"}, {"Pick", "Place"}


def test_the_example_has_looks_weighings_picks_and_places() -> None:
    """ "It can use all of its physical abilities in service of gathering information"."""
    kinds = {row.partition("(")[0] for row in rehearsed()[1]}
    assert kinds == {"Move", *GATHERING, *MANIPULATION}


def test_one_plan_picks_an_object_in_order_to_weigh_it() -> None:
    """ "Interacting with physical objects and searching the space around it": manipulation serves information."""
    layers = [[step.op.partition("(")[0] for step in layer] for plan in plans(rehearsed()[0]) for layer in plan.layers]
    assert any(layer[-1] == "Weigh" and "Pick" in layer for layer in layers)


def test_one_plan_looks_at_an_object_in_order_to_pick_it() -> None:
    """ "Look at _o2_ to localize its pose, and then pick it up": information serves manipulation."""
    layers = [[step.op.partition("(")[0] for step in layer] for plan in plans(rehearsed()[0]) for layer in plan.layers]
    assert any("LookAt" in layer and "Pick" in layer[layer.index("LookAt") :] for layer in layers)


def kinds_done(run: Run) -> set[str]:
    """Return the operators that were carried out."""
    return {row.partition("(")[0] for row in run.operators}


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "Allowing the robot to use all of its mobile manipulation capabilities"."""
    assert kinds_done(with_physics("illustrative")) == {"Move", *GATHERING, *MANIPULATION}
