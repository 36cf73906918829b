"""Why a run went as it did, from its trace alone: objects, actions, drops, ends; compared with what is recorded."""

import json
import math
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from kit.places import GOLDEN, ROOT
from kit.recordings import recorded, rewritten, unchanged
from typer.testing import CliRunner

from skolem.tools.explain import command as explain
from skolem.tools.explain.explaining import Explanation, explained
from skolem.tools.explain.text import action_tree, choice_tree, drop_tree, end_tree, lines
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.tools.recorded.rules import rulebook_of
from skolem.tools.show import command as show
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Recorded, Trace
from skolem.traces.messages import Belief, Decision, Denotation, Message, Plan
from skolem.traces.wording.of_run import wording_of
from skolem.traces.wording.wording import AS_RECORDED


def traced(name: str, *overrides: str) -> Path:
    return recorded(name, 1, "symbolic", overrides)


def lost_at(path: Path) -> list[int]:
    return sorted({plan.step for plan in Trace(path).of(Plan) if plan.cause == "preimage_lost"})


@cache
def green(step: int) -> Explanation:
    return explained(traced("sim1_green"), step)


def test_the_chosen_object_stands_first_with_the_cost_that_the_search_recorded() -> None:
    start = green(0)
    assert start.choice is not None
    chosen, *others = start.choice.options
    assert chosen.chosen
    assert not any(other.chosen for other in others)
    decision = next(Trace(traced("sim1_green")).of(Decision))
    assert chosen.probability == pytest.approx(math.exp(-decision.cost / 1e6))
    assert chosen.plan == decision.plan


def test_every_known_object_is_named_with_its_properties_and_what_speaks_against_it() -> None:
    choice = green(lost_at(traced("sim1_green"))[0]).choice
    assert choice is not None
    options = {option.object: option for option in choice.options}
    assert {"sodaE", "sodaB", "sodaC", "table1"} <= set(options)
    assert "implausible" in options["sodaE"].rejected
    assert options["sodaE"].conjuncts["green"] < 0.001
    assert options["sodaB"].chosen != bool(options["sodaB"].rejected)
    assert "not_graspable" in " ".join(options["table2"].refused)
    seen = options["sodaB"]
    assert seen.exists is not None
    assert seen.denotes["e1"] == pytest.approx(seen.conjuncts["green"] * seen.exists)


def test_the_chain_of_rules_goes_from_the_goal_to_the_action_by_lines_that_say_so() -> None:
    for step in (0, 5):
        found = green(step)
        assert found.layers[-1].steps[found.layers[-1].chosen] == found.action
        for layer in found.layers:
            assert layer.chain[-1].needed_by == ""
            assert layer.chain[-1].achieves in layer.goal
            for link in layer.chain:
                assert rule(link.rule).startswith("result(")
                assert all(rule(place).startswith("cost(") for _, _, place in link.costs)
                assert not link.needed_by or rule(link.need_rule).startswith("precond(")


def rule(place: str) -> str:
    name, _, line = place.partition(":")
    return (ROOT / "rules" / name).read_text(encoding="utf-8").splitlines()[int(line) - 1]


def test_a_drop_names_the_false_fluents_and_the_look_that_made_them_so() -> None:
    step = lost_at(traced("sim1_green"))[0]
    drop = next(drop for drop in green(step).drops if drop.cause == "preimage_lost")
    plan = next(plan for plan in Trace(traced("sim1_green")).of(Plan) if plan.cause == "preimage_lost")
    assert {found.fluent for lost in drop.lost for found in lost.fluents} == set(plan.false_fluents)
    assert drop.after == "LookAt(sodaE)"
    assert "a look with" in drop.sensed
    assert any(change.startswith("sodaE: colour") for change in drop.changed)
    for lost in drop.lost:
        for found, before in zip(lost.fluents, lost.before, strict=True):
            if found.fluent.startswith("b(den"):
                assert before is not None
                assert found.probability is not None
                assert found.probability < 0.01 < before


def test_pops_of_the_illustrative_run_are_all_explained() -> None:
    path = traced("illustrative")
    for step in lost_at(path):
        found = explained(path, step)
        recorded = [p for p in Trace(path).of(Plan) if p.step == step and p.cause == "preimage_lost"]
        told = [{f.fluent for lost in drop.lost for f in lost.fluents} for drop in found.drops if drop.lost]
        assert told == [set(plan.false_fluents) for plan in recorded]
        assert found.layers


def test_a_placeholder_is_an_object_like_others_to_choose() -> None:
    choice = explained(traced("impossible"), 0).choice
    assert choice is not None
    assert choice.options[0].object == "sk(var(o))"
    assert "FindObj" in choice.options[0].plan[0]


def test_what_a_placeholder_turned_out_to_be_is_told() -> None:
    path = traced("sim3_unknown")
    bound = [plan for plan in Trace(path).of(Plan) if plan.cause == "bind_skolem" and plan.layers]
    found = explained(path, bound[-1].step)
    assert found.choice is not None
    assert found.choice.options[0].object == "sk(var(o))"
    (note,) = found.notes
    assert note.endswith(f"at step {bound[-1].step}")
    assert found.action.split("(")[0] in ("Move", "Pick", "LookAt")


def test_an_impossible_goal_is_explained_by_properties_and_regions() -> None:
    found = explained(traced("impossible"), None)
    assert found.ending is not None
    assert found.ending.status == "goal_unachievable"
    kinds = {remedy.kind for remedy in found.ending.remedies}
    assert {"property", "region"} <= kinds
    assert any("purple" in remedy.finding for remedy in found.ending.remedies)


def test_every_region_where_a_thing_not_met_yet_may_be_is_told_with_its_cost_and_what_rejected_it() -> None:
    start, later = (explained(traced("impossible"), step).choice for step in (0, 1))
    assert start is not None
    assert later is not None
    regions = start.options[0].regions
    assert sorted(option.region for option in regions) == ["_reg1_", "_reg2_", "_reg3_"]
    first, *others = regions
    assert [option.chosen for option in regions] == [True, False, False]
    assert (first.plan, first.probability) == (start.options[0].plan, start.options[0].probability)
    for option in regions:
        assert math.exp(-option.cost / 1e6) == pytest.approx(option.exists_in["e1"], rel=1e-5)
        assert option.region in option.plan[0]
    assert all("its plan is as good" in option.rejected for option in others)
    searched = next(option for option in later.options[0].regions if option.region == first.region)
    assert searched.rejected.startswith("implausible: p = ")
    assert searched.contents > 0.9
    text = "\n".join(lines(choice_tree(start, AS_RECORDED)))
    assert f"in {others[0].region}: its plan is as good" in text
    assert f"p = {first.exists_in['e1']:.3g} that e1 is hidden in it (cost {first.cost / 1e6:.2f} nats)" in text


def test_a_region_that_known_objects_outdo_says_by_how_much() -> None:
    choice = explained(traced("illustrative"), 0).choice
    assert choice is not None
    unmet = next(option for option in choice.options if option.object == "sk(var(o))")
    (region,) = unmet.regions
    assert region.probability == unmet.probability
    assert region.rejected == unmet.rejected != ""
    assert all(option.regions == () for option in choice.options if option is not unmet)


def test_every_plan_of_the_stack_says_how_near_it_is_to_the_best() -> None:
    found = green(0)
    made = [decision.within for decision in Trace(traced("sim1_green")).of(Decision) if decision.step == 0]
    assert [layer.within for layer in found.layers] == made
    text = "\n".join(lines(action_tree(found.action, found.layers, AS_RECORDED)))
    assert "(optimal)" in text
    unknown = replace(found.layers[0], within=None)
    assert "(no bound is known)" in "\n".join(lines(action_tree(found.action, [unknown], AS_RECORDED)))


OUT_OF_REACH = """
world:
  - {id: table1, type: table, at: [1.30, 0.00, 0.0]}
  - {id: wide, type: slab, at: [0.00, 2.60, 1.5707963]}
  - {id: sodaC, type: soda, on: wide, at: [0.0, 0.0, 0.0], hsv: [0.33, 0.9, 0.8], kg: 0.350}
belief:
  defaults: {sd_xy_m: 0.005, sd_theta_rad: 0.01}
  objects:
    - {id: table1, type: {table: 1.0}, like: world}
    - {id: wide, type: {slab: 1.0}, like: world}
    - {id: sodaC, type: {soda: 1.0}, like: world}
rules: [slab.lp]
"""
SLAB = "type(slab). table(slab, 3000, 3000, 680).\n"
BECKON = """step(beckon(O, T, P))       :- goal(b(on(O, T), P)), @rigid(O) = 1.
operation(S, beckon(O, T))  :- step(S), S = beckon(O, T, _).
executes(S, look(T))        :- step(S), S = beckon(_, T, _).
result(S, b(on(O, T), P))   :- step(S), S = beckon(O, T, P).
precond(S, krd(O), 0)       :- step(S), S = beckon(O, _, _).
"""


def out_of_reach(folder: Path, rules: str) -> Explanation:
    """Explain the end of a run about a can in the middle of a table of nine square metres."""
    shipped = (ROOT / "scenarios" / "sim1_green.yaml").read_text(encoding="utf-8")
    head = re.sub("(?m)^goal: .*", "goal: B(In(sodaC, table1), 0.9)", shipped[: shipped.index("world:")])
    (folder / "slab.lp").write_text(rules, encoding="utf-8")
    (folder / "far.yaml").write_text(head + OUT_OF_REACH, encoding="utf-8")
    setup = prepare(folder / "far.yaml", ["limits.repeats=3"], 1, "symbolic")
    run(setup, folder / "far.mcap")
    return explained(folder / "far.mcap", None)


def test_an_object_that_no_hand_reaches_is_named_as_what_stood_in_the_way(tmp_path: Path) -> None:
    ending = out_of_reach(tmp_path, SLAB).ending
    assert ending is not None
    findings = [remedy.finding for remedy in ending.remedies if remedy.kind == "geometry"]
    assert {"no way to pick(left, sodaC)", "no way to pick(right, sodaC)"} <= set(findings)
    assert "Pick(sodaC) was found impossible in the believed world" in findings
    changes = {remedy.change for remedy in ending.remedies if remedy.kind == "geometry"}
    assert "a free place within reach for it" in changes
    assert {remedy.kind for remedy in ending.remedies} == {"goal", "geometry"}


def test_what_was_too_unlikely_is_not_called_impossible() -> None:
    goal = "goal=exists o. B(Den(lambda x. Green(x), o), 0.9)"
    ending = explained(recorded("sim1_green", 0, "symbolic", (goal, "limits.min_plan_probability=0.12")), None).ending
    assert ending is not None
    (remedy,) = (remedy for remedy in ending.remedies if remedy.finding.startswith("ExamineObj(e1, sodaE)"))
    assert remedy.finding == "ExamineObj(e1, sodaE) has no way to be done that is likely enough"
    assert (remedy.kind, remedy.change) == ("threshold", "limits.min_plan_probability below 0.12")
    assert not any(remedy.kind == "geometry" for remedy in ending.remedies)


def test_an_action_that_never_does_what_it_should_is_named_with_how_often_it_was_tried(tmp_path: Path) -> None:
    ending = out_of_reach(tmp_path, SLAB + BECKON).ending
    assert ending is not None
    (remedy,) = (remedy for remedy in ending.remedies if remedy.kind == "repeats")
    assert remedy.finding == "Look(table1) was done 3 times without doing what it should"  # a beckoning executes it
    assert remedy.change.startswith("limits.repeats above 3")
    assert not any("Beckon" in other.finding for other in ending.remedies if other is not remedy)


HEAVY_SODA = "goal=exists o. B(Den(lambda x. Soda(x) & Heavy(x), o), 0.9)"
NOT_SODA_E = "rejected(S, not_that_one) :- step(S), S = pick(_, sodaE)."


def ruled(folder: Path, rule: str, *overrides: str) -> Path:
    """Return the trace of a run with a rule of its own, whatever became of it."""
    (folder / "own.lp").write_text(f"%# Own.\n%\n%  Input: goal/1\n\n{rule}\n", encoding="utf-8")
    shipped = (ROOT / "scenarios" / "sim1_green.yaml").read_text(encoding="utf-8")
    (folder / "own.yaml").write_text(f"{shipped}\nrules: [own.lp]\n", encoding="utf-8")
    with suppress(InputError):
        run(prepare(folder / "own.yaml", overrides, 0, "symbolic"), folder / "own.mcap")
    return folder / "own.mcap"


@pytest.fixture(scope="module")
def refusing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the trace of a robot that has to weigh sodas and must not pick one of them."""
    return ruled(tmp_path_factory.mktemp("refusing"), NOT_SODA_E, HEAVY_SODA, "limits.steps=20")


def test_an_object_whose_step_was_refused_is_told_with_the_step_and_the_rule_and_never_called_as_good(
    refusing: Path,
) -> None:
    found = explained(refusing, 0).choice
    assert found is not None
    options = {option.object: option for option in found.options}
    refused = options["sodaE"]
    assert refused.rejected.startswith("ExamineObj(e1, sodaE) was refused at step 0: Weigh(sodaE), which it takes")
    assert "rules refuse Pick(right, sodaE): not_that_one [own.lp:5]" in refused.rejected
    assert refused.rejected.endswith(f"else its plan would have p = {refused.probability:.3g}")
    equal = [option for option in found.options if "as good" in option.rejected]
    assert equal
    assert all(option.probability == found.options[0].probability for option in equal)


def test_what_is_refused_at_several_steps_says_since_when(refusing: Path) -> None:
    refused = {each.step for each in Trace(refusing).of(Plan) if "examine_obj(e1,sodaE)" in each.false_fluents}
    found = explained(refusing, max(refused)).choice
    assert found is not None
    (soda,) = (option for option in found.options if option.object == "sodaE")
    assert f"was refused at step {max(refused)}, and first at step {min(refused)}: " in soda.rejected


def test_where_nothing_was_chosen_no_plan_is_said_to_be_as_good_as_the_chosen_one(refusing: Path) -> None:
    found = explained(refusing, None).choice
    assert found is not None
    told = [option.rejected for option in found.options if option.plan]
    assert told
    assert all(each.endswith("but no plan was sought any more") for each in told)


def test_a_rule_of_the_user_that_refuses_every_way_is_named_with_its_line_and_not_taken_for_geometry(
    tmp_path: Path,
) -> None:
    found = explained(ruled(tmp_path, "rejected(S, not_that_one) :- step(S), S = pick(_, sodaC)."), None)
    assert found.ending is not None
    (remedy,) = (remedy for remedy in found.ending.remedies if remedy.kind in ("rule", "geometry"))
    reasons = "Pick(left, sodaC): not_that_one [own.lp:5]; Pick(right, sodaC): not_that_one [own.lp:5]"
    assert remedy.finding == f"Place(sodaC, table1) has no way to be done that the rules do not refuse: {reasons}"
    assert found.choice is not None
    assert f"was refused at step {found.step}: rules refuse {reasons}" in found.choice.options[0].rejected


def test_the_object_that_comes_nearest_is_the_nearest_of_all_and_that_for_a_hand_is_told_apart() -> None:
    goal = "goal=exists o. B(Den(lambda x. HeavierThan(x, 40000), o), 0.9)"  # 40 kg
    found = explained(traced("sim1_green", goal), None)
    assert found.choice is not None
    assert found.ending is not None
    heavy = {o.object: o.conjuncts["heavier_than_40000"] for o in found.choice.options if o.conjuncts}
    (finding,) = (remedy.finding for remedy in found.ending.remedies if remedy.kind == "property")
    nearest = finding.removeprefix("of all known objects ").split()[0]
    assert heavy[nearest] == max(heavy.values())
    assert nearest.startswith("table")
    assert "; of those that a hand can hold soda" in finding


def test_each_of_several_descriptions_has_an_object_that_comes_nearest_to_it() -> None:
    table = "B(Den(lambda x. Table(x) & White(x), t), 0.9)"
    goal = f"goal=exists o. exists t. B(Den(lambda x. Green(x), o), 0.9) & {table} & B(On(o, t), 0.9)"
    ending = explained(traced("sim1_green", goal), None).ending
    assert ending is not None
    findings = [remedy.finding for remedy in ending.remedies if remedy.kind == "property"]
    assert len(findings) == 1
    assert findings[0].startswith("of all known objects table")
    assert findings[0].endswith("(meant by lambda x. Table(x) & White(x))")
    assert "green" not in findings[0]


def test_a_run_that_failed_is_explained_by_what_failed_even_if_it_fails_again(tmp_path: Path) -> None:
    path = ruled(tmp_path, "cost(S, odd, 1000/G) :- step(S), S = look(O), G = @graspable(O).")
    result = CliRunner().invoke(explain.app, [str(path)])
    assert result.exit_code == 0, result.exception
    assert re.search(r"why the run ended: .*own.lp:5:14: operation undefined", result.stdout)
    assert "the next action could not be decided" in result.stdout
    assert "note: thought again, it fails" in result.stdout


def test_what_this_version_thinks_otherwise_than_the_robot_did_is_said_first(tmp_path: Path) -> None:
    def surer(message: Recorded) -> Iterator[Message]:
        found = unchanged(message)
        other = {"probability": {"e1": {"sodaE": 0.9}}}
        yield found.model_copy(update=other) if isinstance(found, Denotation) and found.step == 2 else found

    path = rewritten(traced("sim1_green"), tmp_path / "other.mcap", surer)
    before, after = (CliRunner().invoke(explain.app, [str(path), "--step", step]).stdout for step in ("1", "3"))
    assert before.startswith("goal: ")
    assert after.startswith("this version thinks otherwise from step 2 on: ")
    assert "`skolem replay` shows where\n\ngoal: " in after
    told = [CliRunner().invoke(explain.app, [str(path), "--step", step, "--json"]).stdout for step in ("1", "3")]
    assert [json.loads(each)["parts"] for each in told] == [None, 2]


def test_a_threshold_that_stood_in_the_way_is_named_with_the_value_that_would_not() -> None:
    bound = "limits.min_plan_probability"
    found = explained(traced("sim1_green", f"{bound}=0.5"), None)
    assert found.ending is not None
    (remedy,) = (r for r in found.ending.remedies if r.kind == "threshold")
    value = float(remedy.change.rpartition(" ")[2])
    assert 0.001 < value < 0.5
    assert explained(traced("sim1_green", f"{bound}={value}"), 0).action


@pytest.mark.parametrize("override", ["limits.steps=2", "limits.expansions=1", "limits.plan_changes=1"])
def test_a_limit_that_ended_the_run_is_named(override: str) -> None:
    limit = override.partition("=")[0]
    found = explained(traced("sim1_green", override), None)
    assert found.ending is not None
    remedy = next(r for r in found.ending.remedies if f"limits.{r.kind}" == limit)
    assert remedy.change.startswith(limit)


def test_the_last_decision_of_a_run_that_went_well_names_the_object_that_is_meant() -> None:
    found = explained(traced("sim1_green"), None)
    assert found.ending is None
    assert found.choice is not None
    assert found.choice.options[0].object == "sodaC"
    assert all(fluent.holds for fluent in found.choice.options[0].fluents)


def test_text_is_a_tree_and_machines_get_the_same_as_data() -> None:
    path, step = traced("sim1_green"), lost_at(traced("sim1_green"))[0]
    text = CliRunner().invoke(explain.app, [str(path), "--step", str(step)]).stdout
    for heading in ("why this object", "why look at", "why plans were dropped"):
        assert f"\n{heading}" in text
    data = json.loads(CliRunner().invoke(explain.app, [str(path), "--step", str(step), "--json"]).stdout)
    assert (data["step"], data["action"]) == (step, green(step).action)
    assert data["drops"][0]["lost"]
    found = green(step)
    assert found.choice is not None
    words = wording_of(Trace(path), rulebook_of(Trace(path).attachments).vocabulary.meanings)
    trees = choice_tree(found.choice, words), drop_tree(found.drops, words)
    assert all(line in text for tree in trees for line in lines(tree))
    end = explained(traced("impossible"), None).ending
    assert end is not None
    assert "what would help" in "\n".join(lines(end_tree(end, words)))


# a term, a Skolem term, micro-nats, a query
TERM = re.compile(
    r"(?<!\w)(?!P\()[A-Za-z_]\w*\(|\bsk\b|(?<![.\d])\d{5,}(?! bytes| points)|@\w+\("
)  # and micro-nats, queries


@pytest.mark.parametrize("name", ["sim1_green", "impossible", "out_of_reach", "occluded"])
def test_no_text_has_internal_terms_unless_they_are_asked_for(name: str) -> None:
    path = GOLDEN / f"{name}.mcap"
    last = max(belief.step for belief in Trace(path).of(Belief))
    for step, app in ((0, explain.app), (0, show.app), (last, explain.app), (last, show.app)):
        said = CliRunner().invoke(app, [str(path), "--step", str(step)]).stdout.splitlines()
        texts = [line.split("  [")[0] for line in said if not line.startswith("goal: ") and "lambda x." not in line]
        assert texts
        assert not [line for line in texts if TERM.search(line)]
    raw = CliRunner().invoke(explain.app, [str(path), "--step", "0", "--raw"]).stdout
    assert TERM.search(raw.partition("\n")[2])


def test_one_object_can_be_asked_about() -> None:
    path = traced("sim1_green")
    text = CliRunner().invoke(explain.app, [str(path), "--step", "2", "--why-not", "sodaE"]).stdout
    assert "sodaE" in text
    assert "sodaB" not in text
    data = json.loads(
        CliRunner().invoke(explain.app, [str(path), "--step", "2", "--why-not", "sodaE", "--json"]).stdout
    )
    assert data["object"] == "sodaE"
    assert not data["chosen"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--step", "99"], "the run has decisions 0 to"),
        (["--why-not", "sodaX"], "no object sodaX to choose; there are:"),
    ],
)
def test_what_the_run_does_not_have_is_a_fault(arguments: list[str], message: str) -> None:
    result = CliRunner().invoke(explain.app, [str(traced("sim1_green")), *arguments])
    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)
