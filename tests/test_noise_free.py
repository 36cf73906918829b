"""Runs without noise: nothing errs, so nothing that is believed is wrong, and no seed matters."""

import pytest
from runs import SCENARIOS, ran

from skolem.sim.scenario import prior
from skolem.sim.symbolic_arm import CARRY
from skolem.tools.session import prepare
from skolem.traces.messages import RobotState

EXACT = ("noise=none",)
NAMES = sorted(path.stem for path in SCENARIOS.glob("*.yaml"))


@pytest.mark.parametrize("name", NAMES)
def test_every_scenario_ends_as_it_should_and_all_that_is_believed_is_true(name: str) -> None:
    scenario = prepare(SCENARIOS / f"{name}.yaml", EXACT, 0, "symbolic").scenario
    assert scenario.expect is not None
    run = ran(name, 0, "symbolic", EXACT)
    assert run.end.status == scenario.expect.status
    assert run.verdict.true == run.achieved


def test_no_seed_matters() -> None:
    assert ran("illustrative", 0, "symbolic", EXACT).operators == ran("illustrative", 7, "symbolic", EXACT).operators


def test_the_robot_is_told_exactly_where_things_are() -> None:
    setup = prepare(SCENARIOS / "sim1_green.yaml", EXACT, 3, "symbolic")
    told = prior(setup.scenario, setup.types, 3, RobotState(right_arm=CARRY["right"], left_arm=CARRY["left"]))
    assert (told.base_sd_xy_m, told.base_sd_theta_rad) == (0.0, 0.0)
    assert {(item.sd_xy_m, item.sd_theta_rad) for item in told.objects} == {(0.0, 0.0)}
    true = {item.id: item for item in setup.scenario.world}
    tables = [item for item in told.objects if true[item.anchor].on is None]
    assert [(*item.world_T_object[:2], item.world_T_object[3]) for item in tables] == [
        pytest.approx(true[item.anchor].at) for item in tables
    ]
