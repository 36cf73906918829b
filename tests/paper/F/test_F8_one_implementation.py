"""F8: one implementation runs in every world; noise and world are configuration."""

import ast
from pathlib import Path

import pytest
from kit.places import SCENARIOS
from kit.runs import ran, with_physics

import skolem.estimation.belief
import skolem.reasoner.agent
from skolem.sim.physics.pybullet import PyBulletWorld
from skolem.sim.symbolic.world import SymbolicWorld
from skolem.tools.loop.setup import prepare

BACK_END = ("tick", "robot_state", "state", "disturb", "execute", "close")
REAL = ("real1_oil", "real1_oil_switched", "real2_green")


@pytest.mark.parametrize("world", [PyBulletWorld, SymbolicWorld])
def test_every_world_answers_the_same_few_calls(world: type) -> None:
    """ "The same implementation runs on the physical robot": behind one interface."""
    assert all(hasattr(world, name) for name in BACK_END)


@pytest.mark.parametrize("module", [skolem.estimation.belief, skolem.reasoner.agent])
def test_neither_belief_nor_reasoner_knows_in_which_world_it_is(module: object) -> None:
    """ "The same implementation"."""
    path = Path(getattr(module, "__file__", ""))
    names = {
        name
        for other in path.parent.glob("*.py")
        for node in ast.walk(ast.parse(other.read_text(encoding="utf-8")))
        for name in ([node.module or ""] if isinstance(node, ast.ImportFrom) else [])
    }
    assert not any(name.startswith("skolem.sim") for name in names)


def test_the_real_robots_scenarios_differ_from_simulated_ones_in_configuration_alone() -> None:
    """ "The same implementation runs on the physical robot": a profile of worse noise, the same rules."""
    simulated, rules = prepare(SCENARIOS / "sim1_green.yaml", world="symbolic"), []
    for name in REAL:
        real = prepare(SCENARIOS / f"{name}.yaml", world="symbolic")
        worse, better = real.scenario.true_noise, simulated.scenario.true_noise
        assert worse.wrist.sd_newton > better.wrist.sd_newton
        assert worse.detection.type_right < better.detection.type_right
        assert worse.odometry.sd_per_m > better.odometry.sd_per_m
        rules.append(real.rulebook.sha256)
    assert all(used == simulated.rulebook.sha256 for used in rules)


@pytest.mark.physics
@pytest.mark.parametrize("name", ["real1_oil", "real2_green"])
def test_both_worlds_run_the_noisy_profile_with_the_same_operators(name: str) -> None:
    """ "The same implementation runs on the physical robot."; over seeds: docs/results.md."""
    kinds = [{act.command.kind for act in run.actions} for run in (ran(name), with_physics(name))]
    assert kinds[0] == kinds[1]
