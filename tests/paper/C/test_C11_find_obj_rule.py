"""C11: FindObj(expr, Region, Obj, P_r) as printed."""

import math

import pytest
from kit.minds import Region, TableBelief
from kit.papers import (
    EXAMPLE_GOAL,
    GREEN_TO_TABLE1,
    NINE,
    example,
    only,
    posed,
    preconditions,
    results,
    shipped,
    three_sodas,
)
from kit.plays import Play

from skolem.reasoner.terms import nll, parse_term

SKOLEM = "sk(var(o))"


def test_its_preconditions_are_the_contents_of_the_region_and_existence_at_the_prior() -> None:
    """ "precond: BContents(Region, P_r), B(ExistsInRegion(expr, Region), P_p)." """
    rule = only(posed(EXAMPLE_GOAL, example().belief), f"b(den(e1,{SKOLEM}),{NINE})")
    assert str(rule.step) == f"find(e1,_reg2_,{SKOLEM},{NINE})"
    ((contents, level), (exists, at_once)) = sorted(preconditions(rule))
    assert (contents, level) == (f"b(contents(_reg2_),{NINE})", 1)
    assert (exists, at_once) == (f"b(exists_in(e1,_reg2_),{nll(0.1)})", 0)


def test_its_results_are_den_at_p_r_and_a_rigid_designator_and_its_cost_that_of_existence() -> None:
    """ "The cost of the inference step is related to the log probability that there is such an object." """
    rule = only(posed(EXAMPLE_GOAL, example().belief), f"b(den(e1,{SKOLEM}),{NINE})")
    assert results(rule) == {f"b(den(e1,{SKOLEM}),{NINE})", f"krd({SKOLEM})"}
    assert rule.price == nll(0.1)
    assert rule.executes is None


def searching(chances: dict[str, float]) -> Play:
    """Return a play with empty tables, in whose regions something green is with these probabilities."""
    things = {name: thing for name, thing in three_sodas().items() if name.startswith("table")}
    match = TableBelief({}).prob_property_of_new(shipped().vocabulary.meanings["green"])
    regions = {
        name: Region(f"table{k}", objects=-math.log(1.0 - p) / match) for k, (name, p) in enumerate(chances.items(), 1)
    }
    return Play(shipped(), GREEN_TO_TABLE1, things, regions=regions)


@pytest.mark.parametrize(("first", "second"), [(0.1, 0.3), (0.3, 0.1)])
def test_the_likelier_region_is_searched_first(first: float, second: float) -> None:
    """ "Select regions for search in which an appropriate object is most likely to occur." """
    play = searching({"_reg1_": first, "_reg2_": second})
    looks = [op for op in play.run() if op.startswith("LookAtRegion")]
    expected = ["LookAtRegion(_reg1_)", "LookAtRegion(_reg2_)"]
    assert looks == (expected if first > second else expected[::-1])


def test_a_region_whose_contents_are_known_is_not_searched_again() -> None:
    """ "Regions of space that have not previously been explored." """
    belief = example().belief
    belief.spaces["_reg2_"].seen = 0.95
    assert posed(EXAMPLE_GOAL, belief).offers.offers(parse_term(f"b(den(e1,{SKOLEM}),{NINE})")) == ()
