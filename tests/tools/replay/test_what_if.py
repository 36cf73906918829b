"""Recorded runs under other rules, goals or thresholds: which decisions change, and where the record ends."""

import json
import math
import re
import tempfile
from pathlib import Path

import pytest
from kit.places import RULES
from kit.recordings import recorded, rewritten, unchanged

from skolem.tools.cli import main
from skolem.tools.recorded.rules import Rulebooks
from skolem.tools.recorded.run import RecordedRun
from skolem.tools.replay.other_minds import Changes, changes_of, given_with
from skolem.tools.replay.what_if import Foreseen, ends_alike, foresee
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Recorded
from skolem.traces.messages import Action, Command, Hand, Joints7, Message, MoveBase, Place, Weigh


def what_if(scenario: str, *flags: str, rules: dict[str, bytes] | None = None) -> Foreseen:
    run = RecordedRun(recorded(scenario))
    return foresee(run, given_with(run, changes_of(rules or {}, flags), Rulebooks()))


def placing(hand: Hand, joints: Joints7) -> Place:
    return Place(hand=hand, approach=(joints,), lower=(joints,), retreat=(joints,), carry=(joints,))


OTHER = {"green": "blue", "blue": "green"}


def edited() -> dict[str, bytes]:
    """Return a vocabulary that calls blue green, and green blue."""
    text = (RULES / "vocabulary.lp").read_text(encoding="utf-8")
    swapped = re.sub(r"colour\((green|blue),", lambda found: f"colour({OTHER[found[1]]},", text)
    assert swapped != text
    return {"vocabulary.lp": swapped.encode()}


def written(folder: Path, rules: dict[str, bytes]) -> str:
    """Write rule files and return their folder as the command line has it."""
    folder.mkdir()
    for name, content in rules.items():
        (folder / name).write_bytes(content)
    return str(folder)


def test_nothing_changes_for_the_same_rules() -> None:
    same = {path.name: path.read_bytes() for path in RULES.glob("*.lp")}
    found = what_if("sim1_green", rules=same)
    assert found == Foreseen(altered=[], decisions=11, recorded=11)


def test_a_comment_changes_nothing() -> None:
    assert not what_if("sim1_green", rules={"look.lp": (RULES / "look.lp").read_bytes() + b"% a remark\n"}).altered


def test_rules_that_would_stop_a_run_are_refused_in_every_trace() -> None:
    run, rulebooks = RecordedRun(recorded("sim1_green")), Rulebooks()
    changes = changes_of({"own.lp": b"step(wipe(O)) :- goal(b(clean(O), _)).\n"}, [])
    for _ in range(2):
        with pytest.raises(InputError, match=r"own.lp:1:1: b\(clean\) is not a fluent"):
            given_with(run, changes, rulebooks)


def test_an_edited_rule_changes_what_is_done_and_ends_the_record_there() -> None:
    """Were blue called green, the blue can, seen before the green one is looked at, would be picked up."""
    found = what_if("sim1_green", rules=edited())
    assert {change.kind for change in found.altered[:-1]} <= {"plan", "search"}
    last = found.altered[-1]
    assert (last.kind, last.was) == ("act", "LookAt(sodaC)")
    assert last.now == "Move(pick(left,sodaB))"
    assert found.stopped == f"step {last.step}: what follows in the trace came of LookAt(sodaC)"
    assert found.decisions == last.step + 1 < found.recorded


def test_an_edited_rule_shows_over_a_folder_of_traces(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The second run's goal is about oil, whatever its colour."""
    traces = [str(recorded(name)) for name in ("sim1_green", "real1_oil")]
    assert command("replay", *traces, "--rules", written(tmp_path / "edited", edited())) == 1
    out = capsys.readouterr().out
    assert f"{traces[0]}: CHANGED: " in out
    assert f"{traces[1]}: same: " in out
    assert "2 traces: 1 changed, 1 same" in out


def test_the_report_says_which_rules_are_whose(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Files lie over those of the trace by name: one that is deleted comes back from there."""
    rules = {path.name: path.read_bytes() for path in RULES.glob("*.lp")}
    del rules["weigh.lp"]
    rules |= {"look.lp": rules["look.lp"] + b"% a remark\n", "own.lp": b"% nothing\n"}
    folder = written(tmp_path / "edited", rules)
    assert command("replay", str(recorded("sim1_green")), "--rules", folder) == 0
    said = "rules changed: look.lp; added: own.lp; not in DIR, taken from the trace: weigh.lp"
    assert capsys.readouterr().out.splitlines()[1] == f"  {said}"
    assert command("replay", str(recorded("sim1_green")), "--rules", folder, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["rules"] == {"changed": ["look.lp"], "added": ["own.lp"], "kept": ["weigh.lp"]}
    assert command("replay", str(recorded("sim1_green")), "--rules", str(RULES)) == 0
    assert capsys.readouterr().out.splitlines()[1] == "  rules as in the trace"
    assert command("replay", str(recorded("sim1_green")), "--set", "threshold=0.9", "--json") == 0
    assert json.loads(capsys.readouterr().out)["rules"] is None


def test_a_renamed_file_is_named_as_it_is_called_and_so_is_the_one_of_the_trace(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = written(tmp_path / "edited", {"deduce.lp": (RULES / "infer.lp").read_bytes()})
    assert command("replay", str(recorded("sim1_green")), "--rules", folder) == 2
    said = capsys.readouterr().err
    assert re.search(rf"{folder}/deduce.lp:\d+:1: redefinition of constant.* rules/infer.lp:\d+:1", said)
    assert f"{folder}/infer.lp: is not there, so it is taken from the trace as rules/infer.lp; an empty file" in said
    assert tempfile.gettempdir() not in said.replace(str(tmp_path), "")
    (tmp_path / "edited" / "infer.lp").touch()
    assert command("replay", str(recorded("sim1_green")), "--rules", folder) == 0


def test_another_word_changes_whom_the_robot_takes_to_be_meant() -> None:
    """The first object believed green is looked at first; were red called green, another would be."""
    found = what_if("sim1_green", "goal=exists o. B(Den(lambda x. Red(x), o), 0.9) & B(In(o, table1), 0.9)")
    [last] = [change for change in found.altered if change.kind in ("act", "end")]
    assert last is found.altered[-1]
    assert found.decisions == last.step + 1 < found.recorded
    assert f"step {last.step}" in found.stopped


def test_a_lower_threshold_ends_the_run_earlier_or_as_before() -> None:
    low = what_if("sim1_green", "threshold=0.05")
    assert low.altered[-1].kind == "act"
    assert "goal_achieved" in low.altered[-1].now
    assert low.decisions < low.recorded


def test_a_limit_is_a_change_of_the_end() -> None:
    found = what_if("sim1_green", "limits.steps=3")
    [change] = found.altered
    assert (change.step, change.kind) == (3, "act")
    assert "limit_reached" in change.now
    assert found.stopped


@pytest.mark.parametrize("flags", [(), ("limits.steps=80",)])
def test_other_sizes_of_things_are_what_the_robot_is_told_whatever_else_changes(flags: tuple[str, ...]) -> None:
    old, new, text = "cylinder(soda, 66, 66, 115)", "cylinder(soda, 90, 90, 180)", (RULES / "vocabulary.lp").read_text()
    assert old in text
    assert what_if("sim1_green", *flags, rules={"vocabulary.lp": text.replace(old, new).encode()}).altered


def test_a_run_that_was_interrupted_while_it_thought_changes_nothing_there(tmp_path: Path) -> None:
    going = [True]

    def up_to_an_act(message: Recorded) -> list[Message]:
        found = unchanged(message)
        going[0] = going[0] and not (isinstance(found, Action) and found.step == 3)
        return [found] if going[0] else []

    run = RecordedRun(rewritten(recorded("sim1_green"), tmp_path / "t.mcap", up_to_an_act))
    found = foresee(run, given_with(run, changes_of({}, ["limits.steps=80"]), Rulebooks()))
    assert (found.altered, found.decisions) == ([], 3)
    assert found.stopped == "step 3: the record ends before the decision"


def test_what_the_robot_is_told_can_be_changed() -> None:
    """Told of worse sensors, it believes something else: no recorded geometric answer is about that belief."""
    assert what_if("sim1_green", "noise.detection.found=0.7").planned > 0


def test_the_same_done_elsewhere_ends_the_record() -> None:
    """Told that a thing stands at the other end of the table, the robot looks there, and the record shows this end."""
    told = "{id: sodaE, type: {soda: 0.95, bottle: 0.05}, on: table1, at: [-0.2, 0.3, 0.0]}"
    found = what_if("sim1_green", f"belief.objects.3={told}")
    last = found.altered[-1]
    assert (last.step, last.kind, found.decisions) == (0, "act", 1)
    assert re.fullmatch(r"LookAt\(sodaE\) at \(.*\) rad, elsewhere", last.now)
    assert found.stopped.startswith("step 0: what follows in the trace came of LookAt(sodaE) at (")


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        (MoveBase(start_T_waypoint=((1.0, 0.0, 3.13),)), MoveBase(start_T_waypoint=((1.04, 0.0, -3.13),)), True),
        (MoveBase(start_T_waypoint=((1.0, 0.0, 0.0),)), MoveBase(start_T_waypoint=((1.06, 0.0, 0.0),)), False),
        (MoveBase(start_T_waypoint=((6.3, 0.0, 0.0),)), MoveBase(start_T_waypoint=()), False),
        (Weigh(hand="left"), Weigh(hand="right"), False),
        (Weigh(hand="left"), Weigh(hand="left"), True),
        (placing("left", (0.1,) * 7), placing("left", (0.1 + 2.0 * math.pi,) * 7), True),
        (placing("left", (0.1,) * 7), placing("right", (0.1,) * 7), False),
        (placing("left", (0.1,) * 7), Place(hand="left", approach=(), lower=(), retreat=(), carry=()), False),
    ],
)
def test_motions_end_alike_if_the_same_hand_or_base_ends_nearly_there(
    one: Command, other: Command, alike: bool
) -> None:
    """Angles that differ by a turn are the same; a motion without an end is like none with one."""
    assert ends_alike(one, other) is alike


def test_nearly_the_same_place_goes_on_and_is_reported() -> None:
    found = what_if("sim1_green", "belief.objects.3.sd_xy_m=0.05")
    assert "motion" in {each.kind for each in found.altered}
    assert found.decisions > 1


@pytest.mark.parametrize("flag", ["world.0.type=bottle", "robot.base.x=1.0", "seed=3", "disturbances=[]", "nonsense=1"])
def test_what_was_recorded_cannot_be_set(flag: str) -> None:
    with pytest.raises(InputError, match="what was recorded cannot change"):
        changes_of({}, [flag])


@pytest.mark.parametrize("value", ["0", "1", "1.5", "high", ""])
def test_a_threshold_is_a_probability(value: str) -> None:
    with pytest.raises(InputError, match="between 0 and 1"):
        changes_of({}, [f"threshold={value}"])


def test_no_flag_is_no_change() -> None:
    assert not changes_of({}, [])
    assert Changes(threshold=0.5)


def test_a_folder_of_traces_is_a_regression_test(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules = tmp_path / "rules"
    rules.mkdir()
    (rules / "look.lp").write_bytes((RULES / "look.lp").read_bytes())
    traces = [str(recorded(name)) for name in ("sim1_green", "occluded")]
    assert command("replay", *traces, "--rules", str(rules)) == 0
    assert "2 traces: 2 same" in capsys.readouterr().out
    assert command("replay", *traces, "--set", "limits.steps=2") == 1
    out = capsys.readouterr().out
    assert "2 traces: 2 changed" in out
    assert "step 2, act: was LookAt(sodaB), would be the end, limit_reached" in out


def test_a_folder_without_rules_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command("replay", str(recorded("sim1_green")), "--rules", str(tmp_path)) == 2
    assert "no rule files" in capsys.readouterr().err


def test_what_if_does_not_go_with_a_comparison(capsys: pytest.CaptureFixture[str]) -> None:
    assert command("replay", str(recorded("sim1_green")), "--set", "threshold=0.5", "--re-anchor") == 2
    assert "--re-anchor" in capsys.readouterr().err


def command(*arguments: str) -> int:
    """Run `skolem` in this process and return its exit status."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["skolem", *arguments])
        return main()


def test_what_the_kept_evaluation_has_no_value_for_is_refused() -> None:
    """A trace that names no evaluation is of `independent`; what-if keeps it, unless it is set anew."""
    run = RecordedRun(recorded("sim1_green"))
    run.start = run.start.model_copy(update={"evaluation": None})
    the = "goal=exists o. B(Den(the x. Green(x), o), 0.9)"
    with pytest.raises(InputError, match="independent has no value for it"):
        given_with(run, changes_of({}, [the]), Rulebooks())
    assert given_with(run, changes_of({}, ["limits.steps=9"]), Rulebooks()).goal.evaluation == "independent"
    anew = changes_of({}, [the, "belief.evaluation=worlds"])
    assert given_with(run, anew, Rulebooks()).goal.evaluation == "worlds"
