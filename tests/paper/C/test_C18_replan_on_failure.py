"""C18: plans are made anew when an action fails, not only when something new is discovered."""

import pytest
from kit.papers import STANDS, Handler, at_five_percent, can, holds, seen_as
from kit.runs import ran

from skolem.sim.symbolic.world import SymbolicWorld
from skolem.traces.messages import Action, ActionResult, Observation, Pick
from skolem.traces.messages.poses import compose4


def test_an_object_that_slips_is_looked_at_again_and_picked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """ "Replanning occurs when the robot discovers something new, but not on plan failure": of others, not of this."""
    execute, slipped = SymbolicWorld.execute, list[str]()

    def slippery(self: SymbolicWorld, action: Action) -> tuple[ActionResult, Observation]:
        if isinstance(action.command, Pick) and not slipped:
            slipped.append(action.op)
            here = next(thing for thing in self.state(action.step).objects if thing.id == action.args[0])
            self.disturb(here.id, compose4(here.world_T_object, (0.0, 0.05, 0.0, 0.0)))
        return execute(self, action)

    monkeypatch.setattr(SymbolicWorld, "execute", slippery)
    run = ran.__wrapped__("sim1_green")
    failed = next(result.step for result in run.results if result.status == "failed")
    assert run.operators[failed] == slipped[0] == "Pick(sodaC)"
    after = run.operators[failed + 1 :]
    assert after.index("LookAt(sodaC)") < after.index("Pick(sodaC)")
    assert (run.achieved, run.verdict.true, run.end.anchor) == (True, True, "sodaC")


def test_after_a_failed_pick_the_object_is_known_too_poorly_to_pick_it_at_once() -> None:
    """ "A robot cannot attempt to pick up an object unless its belief about the location has low variance." """
    robot = Handler(at_five_percent([can()]))
    robot.see(seen_as(STANDS))
    tight = "bn(pose(can1),any,sd(8,8,any),any,223144)"
    assert holds(tight, robot.belief)
    command = Pick(hand="right", approach=(), reach=(), lift=(), carry=(), tool_T_object=(0.0, 0.0, -0.05, 0.0))
    robot.do(command, ("can1",), base_T_tool=(1.0, 0.0, 0.75, 0.0), gripper_gap_m=0.0, status="failed")
    assert robot.belief.held("right") is None
    assert not holds(tight, robot.belief)
    for _ in range(2):
        robot.see(seen_as((1.03, 0.02, 0.7, 0.0)))
    assert holds(tight, robot.belief)
    assert robot.belief.anchors() == ("table1", "can1")
