"""The robot's mind on its own: what it needs, and what it can do without."""

from contextlib import closing

from kit.places import ROOT

from skolem.sim import SymbolicGeometry, SymbolicWorld
from skolem.sim.scenario.scenario import believed_noise, prior_of, true_bodies
from skolem.tools.loop import Mind, prepare
from skolem.traces.messages import Message

GREEN = ROOT / "scenarios" / "sim1_green.yaml"


def operators(*extra: object) -> list[str]:
    """Return what a mind does in the world without physics; `extra` follows the geometry."""
    setup = prepare(GREEN, seed=0, world="symbolic")
    scenario, types = setup.scenario, setup.types
    noise, believed = scenario.true_noise.message(), believed_noise(scenario)
    done: list[str] = []
    with closing(
        SymbolicWorld(types, true_bodies(scenario, types), (0.0, 0.0, 0.0), scenario.robot.torso_m, noise, 0, believed)
    ) as world:
        start = prior_of(scenario, types, 0, world.robot_state())
        mind = Mind(setup.goal, setup.rulebook, start, scenario.limits, SymbolicGeometry(types), *extra)  # type: ignore[arg-type]
        while (action := mind.decide(len(done)).action) is not None:
            done.append(action.op)
            mind.update(action, *world.execute(action))
    return done


def test_a_mind_thinks_the_same_whether_or_not_anybody_listens_and_measures() -> None:
    heard: list[str] = []

    def emit(topic: str, message: Message) -> None:
        heard.append(topic)

    alone = operators()
    assert alone[-1].startswith("Place(")
    assert operators(emit) == alone
    assert heard.count("/action") == len(alone)
