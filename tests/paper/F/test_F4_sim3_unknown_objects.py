"""F4: the third simulation: the tables are known, no object is; a green one onto table1.

The figures over 500 seeds and with the physics come from `skolem sweep` (docs/results.md).
"""

import pytest
from kit.papers import rehearsed
from kit.runs import Run, over, with_physics

SEEDS = range(8)
HIDDEN = 0.1  # of the places in a region: where something may still be when it has been searched
REGIONS = ["_reg1_", "_reg2_", "_reg3_"]


def assert_rows(run: Run) -> None:
    """Assert what the paper tells of this execution."""
    assert run.known() == ("table1", "table2", "table3")
    assert list(dict.fromkeys(run.named("LookAtRegion"))) == REGIONS
    assert run.top_plans()[0] == ("FindObj(e1, _reg1_, sk(var(o)))", "Place(sk(var(o)), table1)")
    searched = run.given_up()[:2]
    for popped, region, following in zip(searched, REGIONS, REGIONS[1:], strict=False):
        assert run.actions[popped.step - 1].args == (region,)
        assert run.beliefs[popped.step].regions[region].hidden < HIDDEN
        assert run.top_plans()[popped.step] == (f"FindObj(e1, {following}, sk(var(o)))", "Place(sk(var(o)), table1)")


def assert_bound_and_placed(run: Run) -> None:
    """Assert that the placeholder became the anchor of what was found, which was then handled."""
    bound = [plan for plan in run.plans if plan.cause == "bind_skolem"]
    assert any(step.op == f"Place({run.end.anchor}, table1)" for plan in bound for step in plan.layers[0])
    assert not any("sk(" in row for row in run.operators)
    assert run.end.anchor not in run.known()
    assert run.operators[-1] == f"Place({run.end.anchor}, table1)"


def test_table_by_table_is_searched_until_a_green_object_turns_up() -> None:
    """ "When it has thoroughly examined one region and not found any objects ... it pops the planning stack"."""
    runs = over("sim3_unknown", SEEDS)
    for run in runs:
        assert_rows(run)
    assert sum(run.achieved and run.verdict.true for run in runs) >= 7


def test_the_placeholder_is_bound_to_the_anchor_of_what_was_found() -> None:
    """ "It uses the LookAtRegion operator to search in regions for objects"."""
    for run in over("sim3_unknown", SEEDS):
        if run.achieved:
            assert_bound_and_placed(run)


def test_in_a_world_without_errors_two_looks_are_enough_if_it_stands_on_the_second_table() -> None:
    """ "The structure of the planning and execution ... is almost exactly the same as for the first example"."""
    _, operators = rehearsed("searching")
    assert [row for row in operators if row.startswith("LookAtRegion")] == [
        "LookAtRegion(_reg1_)",
        "LookAtRegion(_reg2_)",
    ]
    assert operators[-1] == "Place(_o2_, table1)"


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "The robot ... believes that objects are likely to be found on top of tables"."""
    run = with_physics("sim3_unknown")
    assert_rows(run)
    assert_bound_and_placed(run)
    assert (run.achieved, run.verdict.true, run.verdict.witness) == (True, True, "sodaC")
