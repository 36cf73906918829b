"""B10: a goal may state a quantity of an object that has not been met yet."""

import pytest
from kit.minds import Region
from kit.papers import shipped, three_sodas
from kit.plays import Play


@pytest.mark.parametrize(
    "quantity", ["B(Weight(o), any, 0.2, 0.5, 0.9)", "B(Pose(o), any, (0.01, 0.01, 3), (1, 1, 4), 0.9)"]
)
def test_a_quantity_of_an_object_that_nobody_has_met_is_planned_for(quantity: str) -> None:
    """ "A Skolem (placeholder) constant" in `bn(weight(sk(o)), ..)`."""
    things = {name: thing for name, thing in three_sodas().items() if name.startswith("table")}
    goal = f"exists o. B(Den(lambda x. Green(x), o), 0.9) & {quantity}"
    play = Play(shipped(), goal, things, regions={"_reg1_": Region("table1", objects=3.0)})
    assert play.agent.decide(0).decisions
