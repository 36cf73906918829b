"""The tutorial: what it quotes is what the files say, and its files do what it promises."""

import re
from pathlib import Path

import pytest
from kit.places import ROOT
from typer.testing import CliRunner

from skolem.sim.scenario.scenario import load_document
from skolem.tools.explain import command as explain
from skolem.tools.loop.session import Outcome, run
from skolem.tools.loop.setup import prepare
from skolem.tools.rules import command as rules
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Action

DOCS = ROOT / "docs"
PAGE = (DOCS / "tutorial.md").read_text(encoding="utf-8")
COLOURS = {3: "0.60, 0.3, 0.9", 4: "0.99, 0.9, 0.8"}  # of `dented`, which is shiny, and `painted`, as they are
RULES, SCENARIO = DOCS / "tutorial" / "full_and_shiny.lp", DOCS / "tutorial" / "full_and_shiny.yaml"


def quoted(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


def ran(folder: Path, *overrides: str, seed: int = 0) -> tuple[Outcome, Trace]:
    outcome, path = Outcome(), folder / "tutorial.mcap"
    run(prepare(SCENARIO, overrides, seed, "symbolic"), path, outcome=outcome)
    return outcome, Trace(path)


def test_the_rules_that_the_tutorial_quotes_are_the_whole_file() -> None:
    assert "".join(quoted("prolog")) == RULES.read_text(encoding="utf-8")


def test_the_parts_of_the_scenario_that_it_quotes_stand_in_the_file() -> None:
    text = SCENARIO.read_text(encoding="utf-8")
    assert len(quoted("yaml")) == 3
    assert all(block in text for block in quoted("yaml"))


def test_every_link_leads_to_a_file() -> None:
    assert all((DOCS / link).is_file() for link in re.findall(r"\]\(([^)]+)\)", PAGE))


def test_its_rules_give_no_reason_to_complain_but_that_shiny_things_have_colours_too() -> None:
    result = CliRunner().invoke(rules.app, ["check", str(RULES)])
    complaints = re.findall(r"warning: (.*)", result.stdout)
    overlapping = [re.fullmatch(r"the colours (\w+ and shiny|shiny and \w+) overlap \[words\]", c) for c in complaints]
    assert complaints
    assert all(overlapping), result.stdout


def test_the_robot_sees_what_is_shiny_feels_what_is_full_and_brings_the_can_that_is_both(tmp_path: Path) -> None:
    outcome, trace = ran(tmp_path)
    expected = load_document(SCENARIO).values["expect"]
    assert outcome.end is not None
    assert outcome.verdict is not None
    assert (outcome.end.status, outcome.end.anchor) == (expected["status"], expected["chosen"])
    assert outcome.verdict.true
    actions = list(trace.of(Action))
    assert {action.command.kind for action in actions} == set(expected["operators"])
    assert "painted" not in {action.args[0] for action in actions if action.command.kind in ("pick", "weigh")}
    pick = next(action for action in actions if action.command.kind == "pick")
    said = CliRunner().invoke(explain.app, [str(trace.path), "--step", str(pick.step)]).stdout
    [line] = [i for i, rule in enumerate(RULES.read_text().splitlines(), 1) if rule.startswith("cost(S, slippery")]
    assert f"goes well with p = 0.800; the risk: slippery  [full_and_shiny.lp:{line}]" in said


@pytest.mark.parametrize("seed", range(4))
def test_of_two_cans_that_suit_as_well_the_one_that_does_not_slip_is_chosen(tmp_path: Path, seed: int) -> None:
    known = [f"belief.objects.{i}.colour={{hsv: [{hue}], sd: [0.01, 0.01, 0.01]}}" for i, hue in COLOURS.items()]
    goal = "goal=exists o. B(Den(lambda x. Soda(x), o), 0.9) & B(In(o, table1), 0.9)"
    outcome, _ = ran(tmp_path, goal, "world.3.on=table3", "expect.chosen=painted", *known, seed=seed)
    assert outcome.end is not None
    assert (outcome.end.status, outcome.end.anchor) == ("goal_achieved", "painted")


@pytest.mark.parametrize("hue", [0.0, 0.35])
def test_a_shiny_thing_may_have_any_hue(tmp_path: Path, hue: float) -> None:
    outcome, _ = ran(tmp_path, f"world.5.hsv=[{hue}, 0.3, 0.9]")
    assert outcome.end is not None
    assert outcome.end.status == "goal_achieved"
