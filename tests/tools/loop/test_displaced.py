"""What the robot displaced without intent: found in true states, recorded at its action, told with the verdict."""

from pathlib import Path
from typing import Any

import pytest
from kit.places import SCENARIOS

from skolem.sim.symbolic.world import SymbolicWorld
from skolem.tools.loop import worlds
from skolem.tools.loop.displaced import LEAST_M, displaced, in_all
from skolem.tools.loop.session import Outcome, run
from skolem.tools.loop.setup import prepare
from skolem.tools.loop.worlds import WorldKind, WorldStart
from skolem.tools.run.running import summary, verdict_lines
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, ActionResult, Displaced, Hand, Observation, TrueObject, TrueState
from skolem.traces.wording.wording import AS_RECORDED

WAY_M = 0.12


def state(x: float, z: float = 0.68, in_hand: Hand | None = None) -> TrueState:
    can = TrueObject(
        id="soda1", type="soda", world_T_object=(x, 0.2, z, 0.0), hsv=(0.3, 0.9, 0.8), kg=0.35, in_hand=in_hand
    )
    return TrueState(step=1, world_T_base=(0.0, 0.0, 0.0), objects=(can,), sha256="")


@pytest.mark.parametrize(
    ("before", "after", "way"),
    [
        (state(1.0), state(1.0 + WAY_M), WAY_M),
        (state(1.0), state(1.0, z=0.0), 0.68),
        (state(1.0), state(1.0 + LEAST_M / 2.0), None),
        (state(1.0), state(1.5, in_hand="left"), None),
        (state(1.0, in_hand="left"), state(1.5, in_hand="left"), None),
        (state(1.0, in_hand="left"), state(1.5), None),
    ],
    ids=["pushed", "fell", "settled", "picked", "carried", "placed"],
)
def test_only_what_no_hand_held_before_or_after_an_action_is_displaced_without_intent(
    before: TrueState, after: TrueState, way: float | None
) -> None:
    assert [item.distance_m for item in displaced(before, after)] == ([] if way is None else [pytest.approx(way)])


def test_the_ways_of_an_object_are_added_up_over_the_run() -> None:
    each = [Displaced(id="b", distance_m=0.1), Displaced(id="a", distance_m=0.2), Displaced(id="b", distance_m=0.3)]
    assert [(item.id, item.distance_m) for item in in_all(each)] == [("a", 0.2), ("b", pytest.approx(0.4))]


class Clumsy(SymbolicWorld):
    """A world in which every second look pushes the red can."""

    def execute(self, action: Action) -> tuple[ActionResult, Observation]:
        """Carry out an action, and push the can."""
        answer = super().execute(action)
        if action.step % 2 == 1 and action.command.kind == "look_at":
            item = next(item for item in self.state(0).objects if item.id == "sodaE")
            x, y, z, theta = item.world_T_object
            self.disturb("sodaE", (x, y + WAY_M, z, theta))
        return answer


def clumsy(start: WorldStart) -> Clumsy:
    return Clumsy(start.types, start.bodies, start.world_T_base, start.torso_m, start.noise, start.seed)


def test_a_push_stands_in_the_state_after_its_action_in_the_verdict_and_in_what_is_printed(tmp_path: Path) -> None:
    kind = WorldKind("clumsy", clumsy, worlds.SYMBOLIC.planner)
    setup = prepare(SCENARIOS / "sim1_green.yaml", ["limits.steps=4"], 0, kind)
    outcome, path = Outcome(), tmp_path / "run.mcap"
    run(setup, path, outcome=outcome)
    actions, (start, *states) = list(Trace(path).of(Action)), Trace(path).of(TrueState)
    pushing = [action.step % 2 == 1 and action.command.kind == "look_at" for action in actions]
    told = [[(item.id, round(item.distance_m, 3)) for item in state.displaced] for state in states]
    assert start.displaced == ()
    assert sum(pushing) > 1
    assert told == [[("sodaE", WAY_M)] if pushed else [] for pushed in pushing]
    way = sum(pushing) * WAY_M
    assert outcome.verdict is not None
    assert {item.id: item.distance_m for item in outcome.verdict.displaced} == {"sodaE": pytest.approx(way)}
    said: Any = summary(setup, outcome, "limit_reached", "", path)["displaced"]
    assert said == {"sodaE": pytest.approx(way)}
    lines = verdict_lines(outcome, "limit_reached", "", path, AS_RECORDED)
    assert f"displaced without intent: sodaE by {way:.2f} m" in lines


def test_what_others_moved_is_not_told_as_displaced_by_the_robot(tmp_path: Path) -> None:
    outcome, path = Outcome(), tmp_path / "run.mcap"
    run(prepare(SCENARIOS / "sim1_moved.yaml", [], 0, "symbolic"), path, outcome=outcome)
    places = {state.objects for state in Trace(path).of(TrueState)}
    assert len(places) > 1
    assert outcome.verdict is not None
    assert outcome.verdict.displaced == ()
    assert not any("displaced" in line for line in verdict_lines(outcome, "goal_achieved", "", path, AS_RECORDED))


def test_a_state_of_an_older_trace_displaced_nothing() -> None:
    older = state(1.0).model_dump(exclude={"displaced"})
    assert TrueState.model_validate(older).displaced == ()
