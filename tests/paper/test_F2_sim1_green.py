"""F2: the first simulation: three sodas on three tables, existence known, colours not; a green one onto table1.

The figures over 500 seeds and with the physics come from `skolem sweep` (docs/results.md).
"""

import pytest
from runs import Run, over, with_physics

SEEDS = range(6)


def assert_rows(run: Run) -> None:
    """Assert what the paper tells of this execution."""
    looked = [name for name in run.named("LookAt") if name.startswith("soda")]
    assert list(dict.fromkeys(looked)) == ["sodaE", "sodaB", "sodaC"]
    for name, popped, after in zip(("sodaE", "sodaB"), run.given_up(), ("sodaB", "sodaC"), strict=False):
        assert run.actions[popped.step - 1].args == (name,)
        assert any(fluent.startswith(f"b(den(e1,{name}),") for fluent in popped.false_fluents)
        assert run.top_plans()[popped.step] == (f"ExamineObj(e1, {after})", f"Place({after}, table1)")
    assert len(run.given_up()) >= 2
    assert run.named("Pick") == ["sodaC"]
    pick, place = run.where("Pick(sodaC)"), run.where("Place(sodaC, table1)")
    assert any(row.startswith("Move(place(sodaC,table1") for row in run.operators[pick:place])
    assert (run.achieved, run.verdict.true, run.verdict.witness) == (True, True, "sodaC")


def test_the_sodas_are_looked_at_in_order_and_the_stack_is_popped_after_each_disappointment() -> None:
    """ "Discovers that sodaB is blue, and pops the plan stack once more"."""
    for run in over("sim1_green", SEEDS):
        assert_rows(run)


def test_the_first_plan_is_to_find_out_whether_the_soda_that_stands_there_already_is_green() -> None:
    """ "The robot plans to determine that the object sodaE satisfies the denoting expression"."""
    for run in over("sim1_green", SEEDS):
        assert run.decisions[0].plan[0] == "ExamineObj(e1, sodaE)"
        assert run.known()[-3:] == ("sodaE", "sodaB", "sodaC")
        assert not any(run.beliefs[0].objects[name].colour_seen for name in run.known())


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "Formulates and executes plans for picking up the object, moving, and placing it in the target region"."""
    assert_rows(with_physics("sim1_green"))
