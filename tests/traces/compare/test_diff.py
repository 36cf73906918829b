"""Where two traces part: nothing is overlooked, and what may differ is data."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from kit.recordings import recorded, rewritten, unchanged

from skolem.tools import cli
from skolem.traces.compare.decided import parting
from skolem.traces.compare.diff import Change, Comparison, Tolerance, by_step, compare_steps, tolerance_for
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import CLASS_OF, Action, Belief, Message, RunEnd

EXACT = Tolerance()
COMMAND = "import sys; from skolem.tools.cli import main; sys.exit(main())"


def said(topic: str, tick: int = 0, **fields: object) -> Recorded:
    return Recorded(topic, tick, 0, json.dumps(fields).encode())


def compared(expected: list[Recorded], got: list[Recorded], tolerance: Tolerance = EXACT) -> Comparison:
    return compare_steps([expected], [got], tolerance, keep_all=True)


def test_equal_runs_have_no_difference() -> None:
    messages = [said("/plan", step=0), said("/action", step=0)]
    found = compared(messages, list(messages))
    assert found.identical
    assert found.compared == {"/plan": 1, "/action": 1}


def test_a_value_is_named_with_its_path_and_distance() -> None:
    [first] = compared([said("/obs", a=[{"x": 1.0}])], [said("/obs", a=[{"x": 1.5}])]).divergences
    assert first.kind == "value"
    assert first.changes == (Change(".a[0].x", 1.0, 1.5),)
    assert first.changes[0].difference == 0.5
    assert str(first.changes[0]) == ".a[0].x: expected 1.0, got 1.5  |d| = 0.5"


def test_another_order_is_named() -> None:
    [first] = compared([said("/plan"), said("/action")], [said("/action"), said("/plan")]).divergences
    assert (first.kind, first.topic) == ("order", "/plan")


def test_another_length_is_named() -> None:
    for expected, got in (([said("/plan")], []), ([], [said("/plan")])):
        [first] = compared(expected, got).divergences
        assert (first.kind, first.topic) == ("length", "/plan")


def counts(expected: list[Recorded], got: list[Recorded]) -> str:
    return compared(expected, got).in_words()


def test_missing_and_moved_messages_are_counted_as_what_they_are() -> None:
    a, b, c = said("/plan"), said("/action"), said("/obs")
    assert counts([a, b, c], [a, b, c]) == "3 messages: IDENTICAL"
    assert counts([a, b, c], [b, a, c]) == "3 messages: 1 in another order"
    assert counts([a, b, c], [c, a, b]) == "3 messages: 1 in another order"
    assert counts([a, b, c], [a, c]) == "3 messages: 1 missing"
    assert counts([a], [a, *[b] * 5]) == "6 messages: 5 too many"
    assert counts([a, b], [c, said("/plan", x=1)]) == "3 messages: 1 differ, 1 missing, 1 too many"


def test_never_more_messages_differ_than_are_compared() -> None:
    one = [said("/obs", x=1.0), said("/plan")]
    other = [said("/obs", x=2.0), *[said("/geometry")] * 9]
    found = compared(one, other)
    assert (found.compared.total(), found.differing.total()) == (11, 11)
    assert found.missing == {"/plan": 1}
    assert found.surplus == {"/geometry": 9}


def test_another_time_is_a_difference() -> None:
    [first] = compared([said("/plan", tick=3)], [said("/plan", tick=4)]).divergences
    assert first.changes == (Change(".tick", 3, 4),)


@pytest.mark.parametrize(
    ("a", "b", "equal"), [(1, 2, False), (1.0, 1.0 + 1e-12, True), (1.0, 1.1, False), (1, 1.0, True), (True, 1, False)]
)
def test_floats_alone_may_differ_a_little(a: object, b: object, equal: bool) -> None:
    found = compared([said("/obs", x=a)], [said("/obs", x=b)], Tolerance(atol=1e-9))
    assert found.identical == equal
    assert found.tolerated == (1 if (equal and a != b) or (type(a) is not type(b) and equal) else 0)


def test_tolerance_is_by_field_and_hashes_of_floats_are_ignored() -> None:
    other = tolerance_for("other machine")
    assert "/chain.chain" in other.ignored
    assert not tolerance_for("equal machine").ignored
    assert compared([said("/chain", chain="a")], [said("/chain", chain="b")], other).identical
    loose = Tolerance(fields=(("/obs*pose*", 1.0, 0.0),))
    assert loose.allows("/obs.a.pose[0]", 1.0, 1.9)
    assert not loose.allows("/obs.a.point[0]", 1.0, 1.9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_relative_tolerance_is_a_share_of_the_larger_float_whichever_comes_first(sign: float) -> None:
    half = Tolerance(rtol=0.5)
    small, large, larger = sign * 1.0, sign * 2.0, sign * 2.1
    assert half.allows("/obs.x", small, large)
    assert half.allows("/obs.x", large, small)
    assert not half.allows("/obs.x", small, larger)
    assert not half.allows("/obs.x", larger, small)


@pytest.mark.parametrize("tolerance", [tolerance_for("other machine"), EXACT.with_floats(1e-6, None)])
def test_a_true_state_whose_floats_are_tolerated_agrees_whatever_their_hash(tolerance: Tolerance) -> None:
    a, b = (said("/truth/state", x=x, sha256=str(x)) for x in (1.0, 1.0 + 2e-16))
    assert compared([a], [b], tolerance).identical
    assert not compared([a], [b]).identical


def test_without_a_tolerance_zero_is_not_minus_zero() -> None:
    a, b = [said("/obs", x=0.0)], [said("/obs", x=-0.0)]
    [first] = compared(a, b).divergences
    assert first.changes == (Change(".x", 0.0, -0.0),)
    assert compared(a, b, Tolerance(atol=1e-9)).identical


def test_without_a_tolerance_the_same_values_in_other_bytes_are_a_difference() -> None:
    a, b = Recorded("/obs", 0, 0, b'{"x":1}'), Recorded("/obs", 0, 0, b'{"x": 1}')
    [first] = compared([a], [b]).divergences
    assert first.changes == (Change(".bytes", "1}", " 1}"),)
    assert compared([a], [b], Tolerance(atol=1e-9)).identical


def test_every_topic_of_the_tolerance_table_exists() -> None:
    for machine in ("equal machine", "other machine"):
        tolerance = tolerance_for(machine)
        assert {pattern.partition("*")[0].partition(".")[0] for pattern, *_ in tolerance.fields} <= CLASS_OF.keys()
        assert {name.partition(".")[0] for name in tolerance.ignored} <= CLASS_OF.keys()


def test_fields_are_counted_over_all_messages() -> None:
    a = [said("/obs", x=[1.0, 2.0]), said("/obs", x=[1.0])]
    b = [said("/obs", x=[1.5, 2.5]), said("/obs", x=[3.0])]
    assert compared(a, b).fields == {"/obs.x[]": 2}


def test_fields_that_differ_as_often_are_listed_by_name() -> None:
    names = ["seen", "anchors", "keys", "x", "base", "exists"]
    one, other = (Recorded("/belief", 0, 0, json.dumps(dict.fromkeys(names, x)).encode()) for x in (1.0, 2.0))
    found = compared([one, said("/belief", x=1.0)], [other, said("/belief", x=2.0)])
    assert found.by_frequency() == [("/belief.x", 2), *((f"/belief.{name}", 1) for name in sorted({*names} - {"x"}))]


def test_a_step_begins_with_a_belief() -> None:
    topics = ["/run/start", "/prior", "/belief", "/action", "/belief", "/run/end"]
    groups = [[m.topic for m in group] for group in by_step(said(topic) for topic in topics)]
    assert groups == [["/run/start", "/prior"], ["/belief", "/action"], ["/belief", "/run/end"]]


# ---------------------------------------------------------------- the verb


def test_the_verb_finds_the_first_difference_and_loads_nothing_heavy(tmp_path: Path) -> None:
    def moved(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        if isinstance(found, Belief) and found.step == 4:
            found = found.model_copy(update={"version": 99})
        yield found

    a = rewritten(recorded("sim1_green"), tmp_path / "a.mcap", lambda m: [unchanged(m)])
    b = rewritten(recorded("sim1_green"), tmp_path / "b.mcap", moved)
    code = f"{COMMAND[: -len('sys.exit(main())')]}status = main(); heavy = {{'gtsam', 'pybullet', 'rerun', 'clingo'}}\n"
    code += "assert not heavy & set(sys.modules), heavy & set(sys.modules)\nsys.exit(status)"
    done = subprocess.run([sys.executable, "-c", code, "diff", a, b], capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    assert "DIVERGED at step 4, /belief: value" in done.stdout
    assert ".version: expected 10, got 99  |d| = 89" in done.stdout or ".version: expected" in done.stdout
    same = subprocess.run([sys.executable, "-c", code, "diff", a, a], capture_output=True, text=True, check=False)
    assert (same.returncode, "IDENTICAL" in same.stdout) == (0, True)


def test_the_verb_compares_the_topics_it_is_told(tmp_path: Path) -> None:
    trace = str(recorded("sim1_green"))
    arguments = [sys.executable, "-c", COMMAND, "diff", trace, str(recorded("occluded"))]
    done = subprocess.run([*arguments, "--topic", "/chain", "--json"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert set(json.loads(done.stdout)["compared"]) == {"/chain"}
    assert json.loads(done.stdout)["identical"] is False
    done = subprocess.run([*arguments, "--topic", "/nonsense"], capture_output=True, text=True, check=False)
    assert done.returncode == 2


def test_a_topic_that_neither_trace_has_is_refused_with_those_there_are(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trace = str(recorded("sim1_green"))
    monkeypatch.setattr(sys, "argv", ["skolem", "diff", trace, trace, "--topic", "/belief", "--topic", "/tf"])
    assert cli.main() == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("--topic: neither trace has messages of /tf; there are: /action, /action/result, /belief, ")


def test_of_two_seeds_the_verb_tells_where_the_robot_does_something_else(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    traces = [str(recorded("sim1_green", seed)) for seed in (0, 1)]
    monkeypatch.setattr(sys, "argv", ["skolem", "diff", *traces])
    assert cli.main() == 1
    out = capsys.readouterr().out
    assert "DIVERGED before the first decision, /run/start: value\n  .seed: expected 0, got 1" in out
    [line] = re.findall(r"^the decisions part at step (\d+), /action.op: expected .*, got .*$", out, re.MULTILINE)
    first, second = ([action.op for action in Trace(Path(trace)).of(Action)] for trace in traces)
    step = int(line)
    assert first[:step] == second[:step]
    assert first[step] != second[step]
    monkeypatch.setattr(sys, "argv", ["skolem", "diff", *traces, "--json"])
    assert cli.main() == 1
    part = json.loads(capsys.readouterr().out)["decisions_part"]
    assert (part["step"], part["topic"], part["changes"][0]["path"]) == (step, "/action", ".op")


def decided(op: str, pan: float, plan: list[str], cost: int) -> list[Recorded]:
    return [said("/decision", plan=plan, cost=cost), said("/action", tick=cost, op=op, args=[], command={"pan": pan})]


def test_decisions_part_in_what_is_done_not_in_numbers() -> None:
    one = decided("LookAt(a)", 0.1, ["LookAt(a)", "Pick(a)"], 5)
    assert parting([one], [decided("LookAt(a)", 0.2, ["LookAt(a)", "Pick(a)"], 6)]) is None
    other_plan = parting([[], one], [[], decided("LookAt(a)", 0.1, ["LookAt(a)", "Pick(b)"], 5)])
    assert other_plan is not None
    assert (other_plan.step, other_plan.topic, other_plan.changes[0].path) == (0, "/decision", ".plan[1]")
    other_act = parting([one], [decided("Pick(a)", 0.1, ["Pick(a)"], 5)])
    assert other_act is not None
    assert (other_act.topic, other_act.changes) == ("/action", (Change(".op", "LookAt(a)", "Pick(a)"),))


def test_what_a_trace_says_has_no_say_over_the_screen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def screaming(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        yield found.model_copy(update={"reason": "\x1b[2J\x9b2J\x7f"}) if isinstance(found, RunEnd) else found

    b = rewritten(recorded("sim1_green"), tmp_path / "b.mcap", screaming)
    monkeypatch.setattr(sys, "argv", ["skolem", "diff", str(recorded("sim1_green")), str(b), "--topic", "/run/end"])
    assert cli.main() == 1
    said = capsys.readouterr().out
    assert r'got "\u001b[2J\x9b2J\x7f"' in said
    assert said.replace("\n", "").isprintable()


def test_protobuf_topics_are_compared_by_field(record_run: object, tmp_path: Path) -> None:
    assert callable(record_run)
    record_run(tmp_path / "a.mcap")
    [tf] = list(Trace(tmp_path / "a.mcap").messages("/tf"))[:1]
    other = list(Trace(tmp_path / "a.mcap").messages("/tf"))[1]
    [first] = compared([tf], [Recorded("/tf", tf.tick, 0, other.data)]).divergences
    assert first.changes[0].path == ".transforms[0].translation.x"
