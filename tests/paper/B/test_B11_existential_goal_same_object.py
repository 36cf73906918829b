"""B11: one and the same object must be denoted and be in place."""

import pytest
from kit.papers import GREEN_TO_TABLE1, NINE, Handler, at_five_percent, posed, seen_as
from kit.searches import thing

from skolem.reasoner.terms import parse_term

RED_RGB = (0.64, 0.08, 0.08)
ON_TARGET, ELSEWHERE = (1.0, 0.0, 0.7, 0.0), (0.0, 1.6, 0.7, 0.0)


@pytest.mark.parametrize(("there", "achieved"), [(RED_RGB, False), ((0.08, 0.64, 0.08), True)], ids=["trap", "met"])
def test_a_green_object_elsewhere_and_a_red_one_in_place_do_not_make_it_true(
    there: tuple[float, float, float], achieved: bool
) -> None:
    """ "exists o. B(Den(expr, o), .9) and B(On(o, desk), .9)." """
    objects = [
        thing("table2", "table", (0.0, 1.6, 0.0, 0.0), support=None),
        thing("a", "soda", ON_TARGET, sd_m=0.02),
        thing("b", "soda", ELSEWHERE, sd_m=0.02, support="table2"),
    ]
    robot = Handler(at_five_percent(objects))
    robot.see(seen_as(ON_TARGET, rgb=there), seen_as(ELSEWHERE))
    at = posed(GREEN_TO_TABLE1, robot.belief)
    assert at.situation.holds(parse_term(f"b(den(e1,b),{NINE})"))
    assert at.situation.holds(parse_term(f"b(on(a,table1),{NINE})"))
    assert (at.achieved() is not None) is achieved
