"""What `show` and `info` say of a recorded run: every decision with its belief, plans and reasons, and the figures."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from kit.tampering import each, rewrite
from mcap.records import Attachment, Message

from skolem.tools import cli
from skolem.tools.words.belief_table import COLUMNS
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action, Belief, Candidate, Decision, Plan, RunStart

Called = Callable[..., tuple[int, str, str]]
SCREAM = "\x1b]0;pwned\x07\x9b2J\u202e\nyes"


@pytest.fixture
def called(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Called:
    def call(*args: str) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["skolem", *args])
        return cli.main(), *capsys.readouterr()

    return call


# ---------------------------------------------------------------- one decision


def test_a_decision_is_shown_with_table_stack_search_and_outcome(green_trace: Path, called: Called) -> None:
    status, out, _ = called("show", str(green_trace), "--step", "0")
    lines = out.splitlines()
    assert status == 0
    assert lines[0] == "step 0, 0.00 s simulated"
    assert lines[2].split("  ")[0] == "anchor"
    assert [column in lines[2] for column in COLUMNS] == [True] * 5
    sodas = [line for line in lines if line.startswith("soda") and "prior" in line]
    assert len(sodas) == 3
    assert any(line.startswith("P(it is the green thing): ") for line in lines)
    assert any(line.strip().startswith("<find out whether soda") for line in lines)
    assert any(line.startswith("a plan was sought for ") for line in lines)
    assert any(line.strip().endswith("possible") for line in lines)
    assert any(line.startswith("  p = ") and ", optimal: " in line for line in lines)
    assert any(line.startswith("did: look at soda") and line.endswith("-> done") for line in lines)
    assert any(line.startswith("saw: ") for line in lines)


def test_the_table_of_a_decision_has_a_row_per_anchor_in_the_words_of_the_paper(
    green_trace: Path, called: Called
) -> None:
    for belief in Trace(green_trace).of(Belief):
        said = json.loads(called("show", str(green_trace), "--step", str(belief.step), "--json")[1])
        assert [row["anchor"] for row in said["belief"]] == list(belief.anchors)
        for row in said["belief"]:
            held = belief.objects[row["anchor"]].in_hand is not None
            assert (row["pose d"] == "in hand") == held
            assert held or row["pose d"].rsplit(" ", 1)[1] in ("low", "med", "high")
            assert (row["color d"] == "prior") == (not belief.objects[row["anchor"]].colour_seen)


def test_a_dropped_plan_is_shown_with_the_fluents_that_became_false(green_trace: Path, called: Called) -> None:
    lost = next(plan for plan in Trace(green_trace).of(Plan) if plan.cause == "preimage_lost")
    out = called("show", str(green_trace), "--step", str(lost.step))[1]
    assert re.search(r"^plan dropped: P\(soda. is the green thing\) >= \S+ is no longer believed$", out, re.MULTILINE)
    raw = called("show", str(green_trace), "--step", str(lost.step), "--raw")[1]
    assert f"dropped: preimage_lost: {', '.join(lost.false_fluents)}" in raw


def test_the_last_decision_shows_the_end(green_trace: Path, called: Called) -> None:
    last = max(belief.step for belief in Trace(green_trace).of(Belief))
    out = called("show", str(green_trace), "--step", str(last))[1]
    assert out.splitlines()[-1] == "goal believed achieved: every conjunct of the goal is believed"
    assert "did: " not in out


def test_every_candidate_is_in_the_json_with_its_reason(green_trace: Path, called: Called) -> None:
    run = Trace(green_trace)
    rejected = next(d for d in run.of(Decision) if any(c.rejected is not None for c in d.candidates))
    said = json.loads(called("show", str(green_trace), "--step", str(rejected.step), "--json")[1])
    found = [Candidate(**c) for decision in said["decisions"] for c in decision["candidates"]]
    assert set(rejected.candidates) <= set(found)
    text = called("show", str(green_trace), "--step", str(rejected.step))[1]
    assert "not possible: " in text or "more (all with --json)" in text


def test_a_step_that_was_not_taken_is_refused_with_those_that_were(green_trace: Path, called: Called) -> None:
    last = max(belief.step for belief in Trace(green_trace).of(Belief))
    status, _, err = called("show", str(green_trace), "--step", "99")
    assert (status, f"--step: the run has decisions 0 to {last}, got 99" in err) == (2, True)


# ---------------------------------------------------------------- one object


def test_the_history_of_an_object_has_a_row_per_decision(green_trace: Path, called: Called) -> None:
    beliefs, actions = list(Trace(green_trace).of(Belief)), list(Trace(green_trace).of(Action))
    said = json.loads(called("show", str(green_trace), "--object", "sodaC", "--json")[1])
    assert [row["step"] for row in said["history"]] == [str(belief.step) for belief in beliefs]
    assert [row["after"] for row in said["history"]] == ["", *(action.op for action in actions)]
    assert {"in hand"} < {row["pose d"] for row in said["history"]}
    status, out, _ = called("show", str(green_trace), "--object", "sodaC")
    heads = "step exists type d pose d color d weight d after identity"
    assert (status, out.splitlines()[0].split()) == (0, heads.split())
    assert len(out.splitlines()) == len(beliefs) + 1


def test_what_turned_out_about_who_is_who_is_told_where_it_happened(
    tmp_path: Path, green_trace: Path, called: Called
) -> None:
    path = str(rewrite(green_trace, tmp_path / "who.mcap", each(Message, mistaken)))
    assert "identity: sodaB turned out to be sodaC, whose name goes on" in called("show", path, "--step", "2")[1]
    assert "identity: table1 turned out to be two objects" in called("show", path, "--step", "4")[1]
    assert "identity: " not in called("show", path, "--step", "3")[1]
    (change,) = json.loads(called("show", path, "--step", "2", "--json")[1])["identity"]
    assert (change["kind"], change["anchor"], change["other"]) == ("merged", "sodaC", "sodaB")
    for anchor, step in (("sodaC", "2"), ("sodaB", "2"), ("table1", "4")):
        rows = json.loads(called("show", path, "--object", anchor, "--json")[1])["history"]
        assert [row["step"] for row in rows if row["identity"]] == [step]
    assert rows[-1]["pose d"] != ""
    last = called("show", path, "--object", "sodaB")[1].splitlines()[-1]
    assert last.split("  ")[0] == "2"
    assert last.endswith("  sodaB turned out to be sodaC, whose name goes on")


def mistaken(message: Message) -> Message:
    """Return a message as in a run whose sodaB merged into sodaC before decision 2, and whose table1 split before 4."""
    data = json.loads(message.data)
    if "anchors" not in data or data["step"] < 2:
        return message
    data["anchors"].remove("sodaB")
    del data["objects"]["sodaB"]
    found = [{"version": 3, "kind": "merged", "anchor": "sodaC", "other": "sodaB"}]
    split = [{"version": 6, "kind": "split", "anchor": "table1", "other": None}]
    data["identity"] = found if data["step"] < 4 else found + split
    return replace(message, data=json.dumps(data).encode())


def test_an_object_nobody_believed_in_is_refused_with_the_names_there_are(green_trace: Path, called: Called) -> None:
    status, _, err = called("show", str(green_trace), "--object", "sodaX")
    assert (status, "no belief has 'sodaX'; there are: sodaB, sodaC, sodaE, table1" in err) == (2, True)
    status, _, err = called("show", str(green_trace), "--object", "sodaC", "--step", "1")
    assert (status, "cannot be combined with --step" in err) == (2, True)


# ---------------------------------------------------------------- the whole run


def test_without_options_the_tree_of_plans_is_shown(green_trace: Path, called: Called) -> None:
    status, out, _ = called("show", str(green_trace))
    assert (status, out.splitlines()[0]) == (0, f"goal: {next(Trace(green_trace).of(RunStart)).goal}")
    assert out.splitlines()[-1].startswith("goal believed achieved: ")


def test_rules_that_cannot_be_read_leave_colours_in_numbers(tmp_path: Path, green_trace: Path, called: Called) -> None:
    def broken(attachment: Attachment) -> Attachment:
        return replace(attachment, data=b"oops(") if attachment.name == "rules/look.lp" else attachment

    path = rewrite(green_trace, tmp_path / "odd.mcap", each(Attachment, broken))
    status, out, err = called("show", str(path), "--step", "3")
    assert (status, "hsv " in out) == (0, True)
    assert "colours in numbers, as the run's own rules cannot be read: rules/look.lp" in err


def test_info_gives_what_the_run_was_made_of_and_how_it_went(green_trace: Path, called: Called) -> None:
    run = Trace(green_trace)
    status, out, _ = called("info", str(green_trace), "--json")
    said = json.loads(out)
    actions = list(run.of(Action))
    assert (status, said["status"], said["true"], said["steps"]) == (0, "goal_achieved", True, len(actions))
    assert said["run"] == {"scenario": "sim1_green", "schema_version": "1", "seed": "3", "world": "symbolic"}
    assert (said["content_hash"], said["decision_hash"]) == (run.content_hash, run.decision_hash)
    assert sum(said["executed"].values()) == len(actions)
    assert said["replans"] == sum(plan.cause in ("preimage_lost", "refused") for plan in run.of(Plan)) > 0
    found = [decision.within for decision in run.of(Decision) if decision.plan]
    assert (said["plans"]["found"], said["plans"]["optimal"]) == (len(found), found.count(1.0))
    assert said["plans"]["within"] == max(factor for factor in found if factor is not None)
    assert {topic: row["messages"] for topic, row in said["topics"].items()} == counts(run)
    assert said["topics"]["/obs"]["class"] == "INPUT"
    assert {f"rules/{name}" for name in said["rules_sha256"]} | {"scenario.yaml"} == set(said["attachments"])
    assert "python" in said["environment"]


@pytest.mark.parametrize("verb", ["info", "show", "show --step LAST"])
def test_what_a_trace_says_has_no_say_over_the_screen(
    verb: str, tmp_path: Path, green_trace: Path, called: Called
) -> None:
    def screaming(message: Message) -> Message:
        data = json.loads(message.data)
        if data.get("status") != "goal_achieved":
            return message
        return replace(message, data=json.dumps(data | {"reason": SCREAM}).encode())

    path = str(rewrite(green_trace, tmp_path / "loud.mcap", each(Message, screaming)))
    last = str(max(belief.step for belief in Trace(green_trace).of(Belief)))
    arguments = verb.replace("LAST", last).split()
    status, out, _ = called(arguments[0], path, *arguments[1:])
    assert (status, r"goal believed achieved: \x1b]0;pwned\x07\x9b2J\u202e\nyes" in out) == (0, True)
    assert out.replace("\n", "").isprintable()
    said = json.loads(called(arguments[0], path, *arguments[1:], "--json")[1])
    assert SCREAM in (said.get("reason"), (said.get("end") or {}).get("reason"))


def counts(run: Trace) -> dict[str, int]:
    found: dict[str, int] = {}
    for recorded in run.messages():
        found[recorded.topic] = found.get(recorded.topic, 0) + 1
    return found


def test_info_in_words_names_goal_status_operators_and_sizes(green_trace: Path, called: Called) -> None:
    out = called("info", str(green_trace))[1]
    for start in (
        "goal         exists o.",
        "status       goal believed achieved",
        "true         yes (sodaC)",
        "steps  ",
        "plans  ",
        "topic  ",
    ):
        assert any(line.startswith(start) for line in out.splitlines()), start
    assert "LookAt" in next(line for line in out.splitlines() if line.startswith("executed"))


@pytest.mark.parametrize("verb", [["info"], ["show"], ["show", "--step", "0"]])
def test_a_trace_that_cannot_be_read_exits_with_3_and_says_what_to_do(
    verb: list[str], tmp_path: Path, green_trace: Path, called: Called
) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(green_trace.read_bytes()[:50_000])
    status, out, err = called(verb[0], str(cut), *verb[1:])
    assert (status, out, "skolem recover" in err) == (3, "", True)


def test_check_names_the_first_fault_of_each_trace_and_exits_with_3(
    tmp_path: Path, green_trace: Path, called: Called
) -> None:
    status, out, _ = called("check", str(green_trace))
    assert (status, ": sound; " in out) == (0, True)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(green_trace.read_bytes()[:50_000])
    status, out, _ = called("check", str(cut), str(green_trace), "--json")
    first, second = map(json.loads, out.splitlines())
    assert (status, first["sound"], second["sound"], second["fault"]) == (3, False, True, None)
    assert first["fault"].keys() == {"message", "remedy", "byte", "number", "topic", "step"}
    assert first.keys() == {"trace", "sound", "messages", "steps", "content_hash", "decision_hash", "fault", "remarks"}
