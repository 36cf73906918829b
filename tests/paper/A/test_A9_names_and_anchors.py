"""A9: objects have no names but those given in advance and the anchors of the robot."""

import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, posed
from kit.searches import FRONT, Searcher

from skolem.traces.errors import InputError


def goal(anchor: str) -> str:
    """A goal about one object by its name."""
    return f"B(Den(lambda x. Soda(x), {anchor}), 0.9) & B(On({anchor}, table1), 0.9)"


def test_given_names_and_found_anchors_both_stand_in_goals() -> None:
    """ "Any objects that the robot discovers are added to the belief state with internal indices." """
    robot = Searcher(at_five_percent([can("_o33_", soda=0.5)]), [("soda", STANDS), ("soda", (1.1, 0.3, 0.7, 0.0))])
    for _ in range(3):
        robot.look(FRONT)
    assert robot.belief.anchors() == ("table1", "_o33_", "_o34_")
    assert posed(goal("_o33_"), robot.belief).achieved() is not None
    assert posed(goal("_o34_"), robot.belief).achieved() is not None
    root = posed("exists o. B(Den(lambda x. Soda(x), o), 0.9) & B(On(o, table1), 0.9)", robot.belief)
    assert {"_o33_", "_o34_"} <= {
        str(f).split(",")[1].rstrip(")") for r in root.instantiations for f in r if "den" in str(f)
    }


def test_a_name_that_nobody_gave_is_refused() -> None:
    """ "Objects have no given names, unless they were specified for the robot in advance." """
    with pytest.raises(InputError, match="'_o7_' is neither a bound variable nor a known object"):
        posed(goal("_o7_"), Handler(at_five_percent([can()])).belief)


def test_an_index_is_never_used_again_even_after_its_object_was_dropped() -> None:
    """ "Internal indices that have no external meaning, but that can be used as anchors." """
    robot = Searcher(at_five_percent(), [("soda", STANDS)])
    robot.look(FRONT)
    robot.look(FRONT)
    assert robot.belief.anchors() == ("table1", "_o1_")
    robot.solids.pop()
    for _ in range(8):
        robot.look(FRONT)
    assert robot.belief.anchors() == ("table1",)
    assert robot.belief.prob_exists("_o1_") < 1e-3
    robot.solids.append(Searcher(at_five_percent(), [("soda", STANDS)]).solids[-1])
    robot.look(FRONT)
    robot.look(FRONT)
    assert robot.belief.anchors() == ("table1", "_o2_")
