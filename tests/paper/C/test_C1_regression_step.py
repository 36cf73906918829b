"""C1: one step backwards through a rule, with discrete and continuous variables."""

from kit.minds import TableBelief
from kit.papers import EXAMPLE_GOAL, NINE, example, green, only, planned, posed, preconditions, rehearsed, steps_of

from skolem.reasoner.terms import Compound, parse_term
from skolem.traces.messages import MoveBase


def known() -> TableBelief:
    """The belief with which the paper's example begins."""
    return example().belief


def test_a_goal_is_regressed_as_by_hand() -> None:
    """ "STRIPS-like rules with preconditions and results in the form of belief fluents." """
    kept = f"b(on(o3,side),{NINE})"
    last = steps_of(planned(posed(EXAMPLE_GOAL, known()), "holding(o2)", kept, level=3))[-1]
    assert str(last.instance.step) == "pick(left,o2)"
    assert set(map(str, last.subgoal)) == {"holding(o2)", kept}
    needed = {fluent for fluent, _ in preconditions(last.instance)}
    entailed = {"bn(pose(o2),any,sd(50,50,any),any,223144)"}  # the tight bound says as much
    assert set(map(str, last.preimage)) == {kept} | needed - entailed
    by_hand = {"krd(o2)", "empty(left)", "clear(pick(left,o2))", "at(pick(left,o2))"}
    assert by_hand | {"bn(pose(o2),any,sd(8,8,any),any,223144)"} | entailed <= needed


def test_a_plan_is_a_chain_of_such_steps_down_to_what_holds() -> None:
    """ "A regression-based (backward) planning algorithm." """
    at = posed(EXAMPLE_GOAL, known())
    steps = steps_of(planned(at, "holding(o2)", level=3))
    assert all(at.situation.holds(f) for f in steps[0].preimage)
    assert [step.subgoal for step in steps[:-1]] == [step.preimage for step in steps[1:]]
    assert not all(at.situation.holds(f) for f in steps[-1].preimage)


def test_continuous_variables_are_bound_to_values_from_which_the_result_follows() -> None:
    """ "With variable values drawn from discrete and continuous domains." """
    instance = only(posed(EXAMPLE_GOAL, known()), f"b(supposed(green,o3),{NINE})")
    (band,) = [f for f, _ in instance.preconditions if isinstance(f, Compound) and f.name == "bn"]
    mu, sd, tolerance = band.args[1:4]
    assert isinstance(mu, Compound)
    assert isinstance(sd, Compound)
    assert isinstance(tolerance, Compound)
    assert len(mu.args) == len(sd.args) == len(tolerance.args) == 3
    hue, reach = mu.args[0], tolerance.args[0]
    assert isinstance(hue, int)
    assert isinstance(reach, int)
    assert any(1e3 * box.hue[0] < hue - reach < hue + reach < 1e3 * box.hue[1] for box in green().boxes)


def test_a_base_pose_is_drawn_by_a_generator_when_the_step_is_taken() -> None:
    """ "Variables in theta": where to stand is left open in the plan and bound for its execution."""
    play, _ = rehearsed()
    drives = [turn.action for turn in play.turns if turn.action is not None and turn.action.op.startswith("Move")]
    assert drives
    assert all(isinstance(drive.command, MoveBase) for drive in drives)
    (move,) = posed(EXAMPLE_GOAL, known()).offers.offers(parse_term("at(look(o2))"))[:1]
    assert str(move.step) == "move(look(o2))"
