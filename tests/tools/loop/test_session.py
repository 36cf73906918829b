"""Whole runs in the symbolic world: what is recorded, in which order, and that the robot gets nothing but its share."""

from pathlib import Path

import pytest
from kit.places import ROOT

from skolem.sim.symbolic.world import SymbolicWorld
from skolem.tools.loop.session import Outcome, run
from skolem.tools.loop.setup import prepare
from skolem.tools.loop.stopwatch import PARTS, Stopwatch
from skolem.tools.run.running import summary
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Geometry, Plan, RunEnd, RunStart, TrueState

GREEN, MOVED = ROOT / "scenarios" / "sim1_green.yaml", ROOT / "scenarios" / "sim1_moved.yaml"


def ran(path: Path, folder: Path, *overrides: str, seed: int = 0, profile: bool = False) -> tuple[Outcome, Trace]:
    outcome, trace = Outcome(), folder / "run.mcap"
    setup = prepare(path, overrides, seed, "symbolic", profile=profile)
    run(setup, trace, outcome=outcome)
    return outcome, Trace(trace)


def test_the_green_can_is_found_third_and_put_on_the_table(tmp_path: Path) -> None:
    outcome, trace = ran(GREEN, tmp_path, seed=1)
    assert (outcome.end.status, outcome.end.anchor) == ("goal_achieved", "sodaC")  # type: ignore[union-attr]
    assert outcome.verdict is not None
    assert (outcome.verdict.true, outcome.verdict.witness) == (True, "sodaC")
    looked = [action.args[0] for action in trace.of(Action) if action.command.kind == "look_at"]
    assert list(dict.fromkeys(looked)) == ["sodaE", "sodaB", "sodaC", "table1"]
    assert outcome.replans == sum(plan.cause in ("preimage_lost", "refused") for plan in trace.of(Plan)) >= 2


def test_an_object_moved_behind_the_robots_back_is_found_again_and_the_run_ends_right(tmp_path: Path) -> None:
    outcome, _ = ran(MOVED, tmp_path)
    assert outcome.end is not None
    assert outcome.verdict is not None
    assert (outcome.end.status, outcome.end.anchor) == ("goal_achieved", "_o1_")
    assert (outcome.verdict.true, outcome.verdict.witness) == (True, "sodaC")


def test_an_object_is_moved_just_before_the_action_whose_number_the_scenario_gives(tmp_path: Path) -> None:
    _, trace = ran(MOVED, tmp_path, "limits.steps=3", "disturbances.0.before_step=2")
    places = [
        next(item.world_T_object[:2] for item in state.objects if item.id == "sodaC") for state in trace.of(TrueState)
    ]
    before, after = places[0], places[-1]
    assert before != after
    assert places == [before, before, before, after]  # after 0, 1, 2 and 3 actions


def test_every_message_stands_in_the_order_in_which_it_came_about(tmp_path: Path) -> None:
    outcome, trace = ran(GREEN, tmp_path)
    topics = [recorded.topic for recorded in trace.messages()]
    assert topics[:4] == ["/run/start", "/prior", "/truth/state", "/belief"]
    assert topics[-3:] == ["/truth/verdict", "/chain", "/run/end"]
    acted = [topic for topic in topics if topic in ("/belief", "/action", "/action/result", "/obs", "/truth/state")]
    turn = ["/belief", "/action", "/action/result", "/obs", "/truth/state"]
    assert acted == ["/truth/state", *turn * outcome.actions, "/belief"]
    assert topics.count("/chain") == outcome.actions + 1
    assert "/perf" not in topics


def test_rules_that_would_stop_a_run_are_refused_before_it(tmp_path: Path) -> None:
    (tmp_path / "own.lp").write_text("step(wipe(O)) :- goal(b(clean(O), _)).\n", encoding="utf-8")
    scenario = tmp_path / "wipe.yaml"
    scenario.write_text(GREEN.read_text(encoding="utf-8") + "\nrules: [own.lp]\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"own.lp:1:1: b\(clean\) is not a fluent"):
        prepare(scenario, world="symbolic")


def test_questions_to_the_geometry_are_recorded_with_their_answers(tmp_path: Path) -> None:
    _, trace = ran(GREEN, tmp_path)
    asked = list(trace.of(Geometry))
    assert {question.query.split("(")[0] for question in asked} >= {"ready look", "ready pick", "approach place"}
    commands = [question.answer for question in asked]
    assert all(action.command in commands for action in trace.of(Action))


def test_the_trace_holds_the_scenario_and_the_rules_it_was_made_from(tmp_path: Path) -> None:
    _, trace = ran(GREEN, tmp_path, "noise.detection.found=1.0")
    [start] = trace.of(RunStart)
    assert "found: 1.0" in trace.attachments["scenario.yaml"].decode()
    assert {f"rules/{name}" for name in start.rules_sha256} == set(trace.attachments) - {"scenario.yaml"}
    assert (start.world, start.seed, start.limits.steps) == ("symbolic", 0, 60)


def test_two_runs_write_the_same_bytes_and_wall_times_only_when_asked_for(tmp_path: Path) -> None:
    first, trace = ran(GREEN, tmp_path)
    data = trace.path.read_bytes()
    second, again = ran(GREEN, tmp_path)
    assert again.path.read_bytes() == data
    assert first.content_hash == second.content_hash == trace.content_hash
    _, profiled = ran(GREEN, tmp_path, profile=True)
    assert "/perf" in [recorded.topic for recorded in profiled.messages()]
    assert profiled.content_hash == first.content_hash


def test_too_few_steps_end_the_run_with_the_limit_as_reason(tmp_path: Path) -> None:
    outcome, trace = ran(GREEN, tmp_path, "limits.steps=2")
    [end] = trace.of(RunEnd)
    assert (end.status, end.steps, outcome.actions) == ("limit_reached", 2, 2)
    assert outcome.verdict is not None
    assert not outcome.verdict.true


@pytest.mark.parametrize(("error", "status"), [(KeyboardInterrupt(), "interrupted"), (ValueError("no"), "error")])
def test_a_run_that_is_cut_short_leaves_a_closed_trace_with_the_reason(
    error: BaseException, status: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    execute = SymbolicWorld.execute

    def fail_at_two(self: SymbolicWorld, action: Action) -> object:
        if action.step == 2:
            raise error
        return execute(self, action)

    monkeypatch.setattr(SymbolicWorld, "execute", fail_at_two)
    outcome, path = Outcome(), tmp_path / "run.mcap"
    setup = prepare(GREEN, (), 0, "symbolic")
    with pytest.raises(type(error)):
        run(setup, path, outcome=outcome)
    [end] = Trace(path).of(RunEnd)
    assert (end.status, end.steps, outcome.actions) == (status, 2, 2)
    assert outcome.content_hash == Trace(path).content_hash
    assert outcome.total_s > 0.0


def test_a_trace_that_cannot_be_written_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        run(prepare(GREEN, (), 0, "symbolic"), tmp_path / "file" / "x.mcap")


def test_the_summary_accounts_for_the_wall_time(tmp_path: Path) -> None:
    setup, outcome, watch = prepare(GREEN, (), 0, "symbolic"), Outcome(), Stopwatch()
    run(setup, tmp_path / "run.mcap", watch=watch, outcome=outcome)
    wall = summary(setup, outcome, "goal_achieved", "", tmp_path)["wall_s"]
    assert isinstance(wall, dict)
    assert set(wall) == {*PARTS, "total"}
    assert sum(wall[part] for part in PARTS) == pytest.approx(wall["total"], rel=0.2, abs=0.05)
