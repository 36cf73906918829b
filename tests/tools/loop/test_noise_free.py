"""Runs without noise: nothing errs, so nothing that is believed is wrong, and no seed matters."""

import math

import pytest
from kit.places import SCENARIOS
from kit.runs import Run, ran

from skolem.sim.scenario.scenario import prior_of
from skolem.tools.loop.setup import prepare
from skolem.traces.messages import RobotState
from skolem.traces.messages.arm import CARRY

EXACT = ("noise=none",)
SEEDS = range(3)
PLACED_M = 0.002  # by the joints, which follow their commands to less than that
NAMES = sorted(path.stem for path in SCENARIOS.glob("*.yaml"))


def assert_ends_as_it_should(name: str, run: Run) -> None:
    """Assert that a run ends as its scenario file says, and that what it believes of its goal is true."""
    scenario = prepare(SCENARIOS / f"{name}.yaml", EXACT, 0, "symbolic").scenario
    assert scenario.expect is not None
    assert run.end.status == scenario.expect.status
    assert run.verdict.true == run.achieved


@pytest.mark.parametrize("name", NAMES)
def test_every_scenario_ends_as_it_should_and_all_that_is_believed_is_true(name: str) -> None:
    for seed in SEEDS:
        assert_ends_as_it_should(name, ran(name, seed, "symbolic", EXACT))


@pytest.mark.parametrize("name", NAMES)
def test_no_seed_matters(name: str) -> None:
    assert len({tuple(ran(name, seed, "symbolic", EXACT).operators) for seed in SEEDS}) == 1


@pytest.mark.physics
def test_with_the_physics_it_ends_so_too_and_things_are_where_they_are_believed_to_be() -> None:
    run = ran("sim1_green", 0, "pybullet", EXACT)
    assert_ends_as_it_should("sim1_green", run)
    assert run.achieved
    looks = [observation for observation in run.observations if observation.kind == "look"]
    assert {len(look.detections) for look in looks} == {2}  # a table and the soda on it: nothing missed or made up
    for thing in run.truths[-1].objects:
        believed = run.beliefs[-1].objects[thing.id]
        assert math.dist(believed.world_T_object[:3], thing.world_T_object[:3]) < PLACED_M


def test_the_robot_is_told_exactly_where_things_are() -> None:
    setup = prepare(SCENARIOS / "sim1_green.yaml", EXACT, 3, "symbolic")
    prior = prior_of(setup.scenario, setup.types, 3, RobotState(right_arm=CARRY["right"], left_arm=CARRY["left"]))
    assert (prior.base_sd_xy_m, prior.base_sd_theta_rad) == (0.0, 0.0)
    assert {(item.sd_xy_m, item.sd_theta_rad) for item in prior.objects} == {(0.0, 0.0)}
    true = {item.id: item for item in setup.scenario.world}
    tables = [item for item in prior.objects if true[item.anchor].on is None]
    assert [(*item.world_T_object[:2], item.world_T_object[3]) for item in tables] == [
        pytest.approx(true[item.anchor].at) for item in tables
    ]
