"""F3: the second simulation: the same start, a heavy soda onto table1.

The figures over 500 seeds and with the physics come from `skolem sweep` (docs/results.md).
"""

import pytest
from kit.runs import Run, over, thing_in, with_physics

SEEDS = range(6)


def assert_rows(run: Run) -> None:
    """Assert what the paper tells of this execution."""
    assert list(dict.fromkeys(run.named("Weigh"))) == ["sodaE", "sodaB", "sodaC"]
    before = 0
    for name in ("sodaE", "sodaB", "sodaC"):
        pick = run.where(f"Pick({name})")
        assert any(row.startswith("Move(") for row in run.operators[before:pick])
        assert pick < run.where(f"Weigh({name})")
        before = pick + 1
    for name, popped in zip(("sodaE", "sodaB"), run.given_up(), strict=False):
        assert run.operators[popped.step - 1] == f"Weigh({name})"
    assert len(run.given_up()) >= 2
    assert run.named("Pick").count("sodaC") == 1
    assert run.operators[-1] == "Place(sodaC, table1)"
    assert (run.achieved, run.verdict.true, run.verdict.witness) == (True, True, "sodaC")


def test_each_soda_is_picked_up_and_weighed_until_one_is_heavy() -> None:
    """ "The robot must move over to each object in turn, and pick it up to weigh it"."""
    for run in over("sim2_heavy_soda", SEEDS):
        assert_rows(run)


def test_the_heavy_one_is_in_the_hand_already_and_not_picked_again() -> None:
    """ "The robot finds that it is already holding the object it needs to place"."""
    for run in over("sim2_heavy_soda", SEEDS):
        weighed = max(i for i, row in enumerate(run.operators) if row == "Weigh(sodaC)")
        assert not any(row.startswith("Pick") for row in run.operators[weighed:])
        assert thing_in(run.truths[weighed + 1], "sodaC").in_hand == "right"


@pytest.mark.physics
def test_with_the_physics() -> None:
    """ "This execution has a similar structure, in which the robot examines two objects before finding a third"."""
    assert_rows(with_physics("sim2_heavy_soda"))
