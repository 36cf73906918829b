"""A recorded run thought again: identical if nothing hidden went in, and the first difference named if it did."""

import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from weakref import WeakKeyDictionary

import pytest
from kit.places import DATA, GOLDEN, SCENARIOS
from kit.recordings import recorded, rewritten, unchanged

from skolem.reasoner.agent import Agent
from skolem.reasoner.planning.instances import Instance
from skolem.reasoner.rulebook.book import rule_files
from skolem.tools import cli
from skolem.tools.loop.mind import Mind
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.tools.recorded.fingerprint import differences
from skolem.tools.recorded.replaying import Options, Replayed, replay
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun
from skolem.traces.compare.diff import Tolerance, tolerance_for
from skolem.traces.errors import Fault, InputError, InternalError, TraceError
from skolem.traces.file.codec import counter_of
from skolem.traces.file.made_of import RULES
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import JSON_TOPICS, ActionResult, Decision, Memory, Message, Observation, Plan

EXACT = Tolerance()
DOES_NOT_COME_AGAIN = "the recorded error (InternalError: boom) does not come again"
OLDER = DATA / "older.mcap"
SYMBOLIC = ("sim1_green", "sim1_moved", "sim3_unknown", "occluded", "impossible", "illustrative", "real1_oil")
COMMAND = "import sys; from skolem.tools.cli import main; sys.exit(main())"
NOT_FOR_A_REPLAY = (  # each takes a while to import
    *("distributed", "foxglove_schemas_protobuf", "mcap_protobuf", "ompl", "pyarrow", "pybullet", "rerun", "rich"),
    *("ruamel", "scipy.ndimage", "scipy.optimize", "scipy.spatial", "scipy.stats"),
    *("skolem.reasoner.lint.linting", "skolem.reasoner.lint.wrong_rules", "skolem.sim", "skolem.tools.loop.session"),
    "skolem.tools.loop.setup",
)
OTHER_MACHINES = (
    {"PYTHONHASHSEED": "7", "OPENBLAS_NUM_THREADS": "2"},
    {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR"},
)


def again(path: Path, options: Options | None = None) -> Replayed:
    return replay(RecordedRun(path), options or Options(EXACT))


def decisions_of(path: Path) -> Counter[str]:
    return Counter(m.topic for m in Trace(path).messages() if counter_of(m.topic) == "decision")


@pytest.mark.parametrize("scenario", SYMBOLIC)
def test_a_run_is_thought_again_to_the_last_byte(scenario: str) -> None:
    path = recorded(scenario)
    replayed = again(path)
    assert replayed.identical
    assert replayed.ended
    assert not replayed.stopped
    assert replayed.comparison.tolerated == 0
    expected = decisions_of(path)
    assert replayed.comparison.compared == expected - Counter({"/run/start": 1, "/prior": 1})


def test_a_trace_of_an_older_version_is_thought_again_with_the_rules_that_it_brings() -> None:
    """Its rules name operations by `called/2`, and it knows neither `limits.same_looks` nor what was in vain.

    The estimator has changed since, and that is the cause of every difference: the robot does the same.
    """
    older = RecordedRun(OLDER)
    assert b"called(S, N)" in older.attachments["rules/regress.lp"]
    other = differences(older.environment)
    options = Options(tolerance_for("other machine" if other else "equal machine"))
    replayed = replay(older, options)
    assert (replayed.believes_otherwise, replayed.ended, replayed.decisions) == (True, True, 8)
    assert not replayed.comparison.differing["/action"]
    assert replayed.comparison.compared["/action"] == 7


def test_the_command_starts_with_no_more_than_thinking_takes() -> None:
    code = (
        f"import sys; sys.argv = ['skolem', 'replay', {str(recorded('sim1_green'))!r}]\n"
        "from skolem.tools.cli import main\nassert main() == 0\n"
        f"print('LOADED', [m for m in {NOT_FOR_A_REPLAY} if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "LOADED []"


@pytest.mark.physics
def test_a_run_with_physics_is_thought_again_without_the_simulator() -> None:
    path = recorded("sim1_green", 0, "pybullet")
    code = (
        "import sys\nfrom pathlib import Path\nfrom skolem.tools.recorded.run import RecordedRun\n"
        "from skolem.tools.recorded.replaying import Options, replay\n"
        "from skolem.tools.loop.stopwatch import Stopwatch\n"
        "from skolem.traces.compare.diff import Tolerance\n"
        f"found = replay(RecordedRun(Path({str(path)!r})), Options(Tolerance()))\n"
        "assert found.identical and found.ended\n"
        "assert not {'pybullet', 'ompl', 'rerun'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    assert again(path, Options(EXACT, plan_motions=True)).identical


@pytest.mark.parametrize("scenario", ["sim1_green", "sim3_unknown"])
def test_geometric_answers_can_be_planned_again(scenario: str) -> None:
    assert again(recorded(scenario), Options(EXACT, plan_motions=True)).identical


def test_a_replay_may_start_at_any_decision() -> None:
    path = recorded("sim1_green")
    steps = len(list(Trace(path).of(Memory)))
    for step in range(steps):
        replayed = again(path, Options(EXACT, from_step=step))
        assert replayed.comparison.divergences == []
        assert replayed.decisions == steps - step


@pytest.mark.parametrize("scenario", ["sim1_green", "occluded"])
def test_every_decision_follows_from_what_is_recorded_before_it(scenario: str) -> None:
    assert again(recorded(scenario), Options(EXACT, re_anchor=True)).identical


def test_there_must_be_a_decision_to_start_at() -> None:
    with pytest.raises(InputError, match="no decision 1000"):
        again(recorded("sim1_green"), Options(EXACT, from_step=1000))


def test_a_trace_without_memory_is_replayed_from_its_start_only(tmp_path: Path) -> None:
    def forget(message: Recorded) -> Iterator[Message]:
        if message.topic != "/memory":
            yield unchanged(message)

    path = rewritten(recorded("sim1_green"), tmp_path / "old.mcap", forget)
    with pytest.raises(InputError, match="without /memory"):
        again(path, Options(EXACT, from_step=2))


# ---------------------------------------------------------------- what does not follow is found


def test_a_hidden_input_of_a_decision_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A reasoner that looks at something beside what it is given, here at how often it was built."""
    path, calls = tmp_path / "run.mcap", [0]
    why_refused = Agent._why_refused

    def moody(self: Agent, instance: Instance, level: int) -> str:
        calls[0] += 1
        return "moody" if calls[0] == 40 else why_refused(self, instance, level)

    monkeypatch.setattr(Agent, "_why_refused", moody)
    run(prepare(SCENARIOS / "sim1_green.yaml", (), 0, "symbolic"), path)
    replayed = again(path)
    assert not replayed.identical
    assert replayed.comparison.divergences[0].topic in ("/decision", "/plan", "/geometry")


def test_a_changed_observation_shows_in_the_belief_after_it(tmp_path: Path) -> None:
    def warmer(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        if isinstance(found, Observation) and found.step == 0:
            seen = found.detections[0].model_copy(update={"rgb": (0.5, 0.5, 0.4)})
            found = found.model_copy(update={"detections": (seen, *found.detections[1:])})
        yield found

    [first] = again(rewritten(recorded("sim1_green"), tmp_path / "t.mcap", warmer)).comparison.divergences
    assert (first.step, first.topic, first.kind) == (0, "/chain", "value")
    by_itself = again(tmp_path / "t.mcap", Options(EXACT, keep_all=True)).comparison
    second = by_itself.divergences[1]
    assert (second.step, second.topic) == (1, "/belief")
    assert any(".colour.mean" in change.path for change in second.changes)
    assert by_itself.fields["/chain.chain"] >= 1


def test_a_changed_decision_is_named_with_its_field(tmp_path: Path) -> None:
    def dearer(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        yield found.model_copy(update={"cost": 7}) if isinstance(found, Decision) and found.step == 2 else found

    first = again(rewritten(recorded("sim1_green"), tmp_path / "t.mcap", dearer)).comparison.divergences[0]
    assert (first.step, first.topic, first.kind) == (2, "/decision", "value")
    assert (first.changes[0].path, first.changes[0].expected) == (".cost", 7)
    assert "DIVERGED at step 2, /decision: value" in first.lines()[0]


@pytest.mark.parametrize("dropped", ["/plan", "/decision", "/chain", "/memory"])
def test_a_dropped_message_is_found(dropped: str, tmp_path: Path) -> None:
    left = [3]

    def drop(message: Recorded) -> Iterator[Message]:
        left[0] -= message.topic == dropped
        if message.topic != dropped or left[0] != 0:
            yield unchanged(message)

    first = again(rewritten(recorded("sim1_green"), tmp_path / "t.mcap", drop)).comparison.divergences[0]
    assert first.kind in ("order", "length")
    assert dropped in (first.changes[0].got, first.topic)


def test_swapped_messages_are_found(tmp_path: Path) -> None:
    held: list[Message] = []

    def swap(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        if isinstance(found, Plan) and found.step == 0 and len(held) < 1:
            held.append(found)
        elif isinstance(found, Plan) and len(held) == 1:
            yield found
            yield held[0]
            held.append(found)
        else:
            yield found

    first = again(rewritten(recorded("sim1_green"), tmp_path / "t.mcap", swap)).comparison.divergences[0]
    assert (first.step, first.topic) == (0, "/plan")


def test_a_replay_stops_where_the_robot_would_do_something_else(tmp_path: Path) -> None:
    def blind(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        yield found.model_copy(update={"detections": ()}) if isinstance(found, Observation) else found

    replayed = again(rewritten(recorded("sim1_green"), tmp_path / "t.mcap", blind))
    assert "what follows in the trace came of LookAt(" in replayed.stopped
    assert replayed.decisions < 11


# ---------------------------------------------------------------- records that end early


def test_a_run_that_failed_is_replayed_up_to_its_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "run.mcap"
    from skolem.sim.symbolic.world import SymbolicWorld

    execute = SymbolicWorld.execute

    def fail_at_two(self: SymbolicWorld, action: object) -> tuple[ActionResult, Observation]:
        if action.step == 2:  # type: ignore[attr-defined]
            raise KeyboardInterrupt
        return execute(self, action)  # type: ignore[arg-type]

    monkeypatch.setattr(SymbolicWorld, "execute", fail_at_two)
    setup = prepare(SCENARIOS / "sim1_green.yaml", (), 0, "symbolic")
    with pytest.raises(KeyboardInterrupt):
        run(setup, path)
    replayed = again(path)
    assert replayed.comparison.divergences == []
    assert replayed.decisions == 3


def failing(patch: pytest.MonkeyPatch, kind: type[object], method: str, error: Exception) -> None:
    """Have a method fail at the fourth call of each run."""
    original, calls = getattr(kind, method), WeakKeyDictionary[object, int]()

    def fails(self: object, *args: object) -> object:
        calls[self] = calls.get(self, 0) + 1
        if calls[self] == 4:
            raise error
        return original(self, *args)

    patch.setattr(kind, method, fails)


def failed(path: Path, patch: pytest.MonkeyPatch, kind: type[object], method: str) -> Path:
    """Return the trace of a run in which a method fails at the fourth call, as it will until the patch is undone."""
    failing(patch, kind, method, InternalError("boom"))
    with pytest.raises(InternalError):
        run(prepare(SCENARIOS / "sim1_green.yaml", (), 0, "symbolic"), path)
    return path


@pytest.mark.parametrize(("part", "method"), [(Agent, "decide"), (Mind, "update")])
def test_an_error_of_the_mind_comes_again_or_is_said_not_to(
    part: type[object], method: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = failed(tmp_path / "run.mcap", monkeypatch, part, method)
    replayed = again(path)
    assert (replayed.identical, replayed.other_end) == (True, "")
    monkeypatch.undo()
    mended = again(path)
    assert (mended.identical, mended.other_end) == (True, DOES_NOT_COME_AGAIN)


def test_an_error_of_the_world_is_said_not_to_come_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from skolem.sim.symbolic.world import SymbolicWorld

    path = failed(tmp_path / "run.mcap", monkeypatch, SymbolicWorld, "execute")
    monkeypatch.setattr(sys, "argv", ["skolem", "replay", str(path)])
    assert cli.main() == 0
    said = capsys.readouterr().out
    assert said.startswith(f"{path}: IDENTICAL: 4 decisions, ")
    assert said.endswith(f"; {DOES_NOT_COME_AGAIN}\n")


def test_another_error_than_the_recorded_one_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = failed(tmp_path / "run.mcap", monkeypatch, Mind, "update")
    monkeypatch.undo()
    failing(monkeypatch, Mind, "update", ValueError("bang"))
    assert again(path).other_end == f"{DOES_NOT_COME_AGAIN}, but another: ValueError: bang"


def test_a_record_may_stop_anywhere(tmp_path: Path) -> None:
    count = len(list(Trace(recorded("sim1_green")).messages(*JSON_TOPICS)))
    for kept in range(8, count, 29):
        left = [kept]

        def first_ones(message: Recorded, left: list[int] = left) -> Iterator[Message]:
            left[0] -= 1
            if left[0] >= 0:
                yield unchanged(message)

        path = rewritten(recorded("sim1_green"), tmp_path / f"{kept}.mcap", first_ones)
        assert again(path).comparison.divergences == []


def test_a_trace_of_nothing_is_not_sound(tmp_path: Path) -> None:
    path = rewritten(recorded("sim1_green"), tmp_path / "t.mcap", lambda _: ())
    with pytest.raises(TraceError, match="nothing to replay"):
        RecordedRun(path)


# ---------------------------------------------------------------- other machines


@pytest.mark.parametrize("machine", OTHER_MACHINES, ids=["threads", "processor"])
def test_decisions_are_the_same_on_another_machine(machine: dict[str, str]) -> None:
    """Fresh runs, and those that are kept: of some of them a last digit decides what the smoother linearises anew."""
    paths = [str(recorded(name)) for name in ("sim1_green", "sim3_unknown", "occluded", "illustrative")]
    paths += map(str, sorted(GOLDEN.glob("*.mcap")))
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, "replay", "--json", "--workers", "1", *paths],
        env=os.environ | machine,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count('"status": "identical"') == len(paths)


@pytest.mark.parametrize(
    "text", ['"\n#include "/etc/passwd".\n"', '%* %* *% *%#include "/etc/passwd".', "#script (lua)\n#end."]
)
def test_rules_in_a_trace_open_no_file_of_the_machine(text: str) -> None:
    shipped = {f"{RULES}{file.name}.lp": file.content for file in rule_files()[0]}
    with pytest.raises(InputError) as caught:
        Rulebooks().of(shipped | {f"{RULES}own.lp": text.encode()})
    assert {fault.file for fault in caught.value.faults} == {f"{RULES}own.lp"}
    assert "is not allowed" in str(caught.value)
    assert "root:" not in str(caught.value)


def test_a_limit_of_the_rules_ends_a_replay_and_is_no_divergence(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_much(_: Agent, step: int) -> None:
        raise InputError([Fault("own.lp", 0, 0, f"this file takes more than 5 s of computing (step {step})")])

    run = RecordedRun(recorded("sim1_green"))
    monkeypatch.setattr(Agent, "decide", too_much)
    with pytest.raises(InputError, match="this file takes more than"):
        replay(run, Options(tolerance_for("equal machine")))
