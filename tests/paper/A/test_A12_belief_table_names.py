"""A12: the heading is `anchor`, and colours and weights that the robot was told are printed."""

import math

from kit.papers import Handler, at_five_percent, shipped
from kit.searches import thing

from skolem.tools.words.belief_table import COLUMNS, belief_rows
from skolem.traces.messages import HsvBelief


def test_the_first_column_is_called_anchor() -> None:
    """The paper calls it id in two tables and anchor in two; decided: anchor."""
    assert COLUMNS[0] == "anchor"


def test_what_the_robot_was_told_of_a_colour_and_a_weight_is_printed_and_not_called_prior() -> None:
    """ " 'Prior' means the robot's distribution of the weight is that of an arbitrary object": a told one is not."""
    green = HsvBelief(mean=(0.35, 0.8, 0.8), variance=(1e-4, 1e-3, 1e-3))
    told = {"colour": green, "log_weight": (math.log(0.5), 0.01)}
    robot = Handler(at_five_percent([thing("o", "soda", (1.0, 0.1, 0.7, 0.0)).model_copy(update=told)]))
    row = next(r for r in belief_rows(robot.belief.snapshot(0), shipped().vocabulary.meanings) if r[0] == "o")
    assert row[3:] == ("green, low", "500 g, low")
