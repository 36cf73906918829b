"""C19: the robot's own actions change the state of the objects it senses."""

import pytest
from kit.papers import Handler, at_five_percent, can, plans, rehearsed, seen_as
from kit.searches import thing

HERE, THERE = (1.0, 0.0, 0.7, 0.0), (0.0, 1.6)


def test_a_moved_object_is_believed_where_it_was_put() -> None:
    """ "Actions that modify the state of the objects the robot is sensing." """
    shelf = thing("shelf", "table", (*THERE, 0.0, 0.0), support=None)
    robot = Handler(at_five_percent([shelf, can("o1")], place_sd_m=0.02))
    robot.see(seen_as(HERE))
    before = robot.belief.snapshot(0).objects["o1"]
    assert (robot.belief.prob_on("o1", "table1") > 0.9, robot.belief.prob_on("o1", "shelf")) == (True, 0.0)
    robot.pick("o1")
    assert robot.belief.prob_on("o1", "table1") == 0.0
    robot.place("o1", "shelf", (*THERE, 0.0))
    after = robot.belief.snapshot(0).objects["o1"]
    assert after.world_T_object[:2] == pytest.approx(THERE, abs=0.01)
    assert after.covariance[0] > before.covariance[0]  # moved, and not yet seen again
    assert robot.belief.prob_on("o1", "shelf") > 0.9
    assert (after.type, after.colour, after.log_weight) == (before.type, before.colour, before.log_weight)


def test_within_one_run_the_obstacle_is_moved_and_the_object_behind_it_is_free() -> None:
    """ "It moves the box, _o1_, out of the way so that it can finally move, look at _o2_, and then pick it up." """
    play, operators = rehearsed()
    moved = next(i for i, operator in enumerate(operators) if operator.startswith("Place(o1"))
    assert operators.index("Pick(o1)") < moved < operators.index("Pick(o2)")
    assert play.geometry.in_the_way == {"pick(right, o2)": (), "pick(left, o2)": ()}
    planned = [plan.step for plan in plans(play) if any("RemoveObst" in s.op for layer in plan.layers for s in layer)]
    assert planned[0] <= operators.index("Pick(o1)")
    assert planned[-1] <= operators.index("Pick(o2)")
    assert play.belief.things["o1"].on == operators[moved].partition(", ")[2].rstrip(")")
