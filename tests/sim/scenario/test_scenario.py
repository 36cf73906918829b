"""Scenario files: what is refused, with which words and where; what the world and the robot get out of a sound one."""

import math
from pathlib import Path

import numpy as np
import pytest
from kit.places import ROOT

from skolem.reasoner.language.parser import read_goal
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.sim.scenario.document import MAX_BYTES
from skolem.sim.scenario.scenario import (
    Scenario,
    load_document,
    load_scenario,
    moves_before,
    prior_of,
    schema_text,
    true_bodies,
)
from skolem.traces.errors import InputError
from skolem.traces.messages import RobotState
from skolem.traces.messages.arm import CARRY

BAD = ROOT / "tests" / "data" / "bad_scenarios"
GREEN = ROOT / "scenarios" / "sim1_green.yaml"
AT_START = RobotState(torso=0.2, right_arm=CARRY["right"], left_arm=CARRY["left"])


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return Rulebook.load(Queries)


def read(rulebook: Rulebook, path: Path, *overrides: str) -> Scenario:
    words = rulebook.vocabulary.words()
    types = rulebook.vocabulary.types
    return load_scenario(path, types, overrides, lambda goal, names: read_goal(goal, words, names)[1])


def written(folder: Path, text: str) -> Path:
    path = folder / "x.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load_document(path)
    return str(caught.value)


# ---------------------------------------------------------------- what is refused


@pytest.mark.parametrize("name", sorted(path.stem for path in BAD.glob("*.yaml")))
def test_every_mistake_of_a_file_is_reported_at_once_with_its_place(name, rulebook, golden, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.chdir(BAD)
    with pytest.raises(InputError) as caught:
        read(rulebook, Path(f"{name}.yaml"))
    golden(f"bad_scenarios/{name}.txt", f"{caught.value}\n")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", ":1:1: expected a mapping"),
        ("- 1", ":1:1: expected a mapping"),
        ("a: [1", ":1:6: not YAML: expected ',' or ']'"),
        ("a: 1\na: 2", ":2:1: not YAML: found duplicate key"),
        ("a: 1\n---\nb: 2", ":2:1: not YAML: but found another document"),
        ("a: \x00", "not YAML: unacceptable character"),
        ("a: 2001-99-99", "not YAML: month must be in 1..12"),
        ("a: !!python/object/apply:os.system [ls]", ":1:4: tags such as"),
        (f"a: {'9' * 5000}", ":1:4: a value of more than 3500 characters"),
        ("a: " + "[" * 40 + "]" * 40, "nested deeper than 32"),
        ("a: [" + "1," * 20_001 + "]", "more than 20000 values"),
        ("a: &a [*a]", ":1:8: no finished value is anchored as '&a'"),
    ],
)
def test_text_that_is_no_harmless_mapping_is_refused(text: str, said: str, tmp_path: Path) -> None:
    assert said in refusal(written(tmp_path, text))


def test_aliases_that_unfold_into_millions_are_refused_before_they_unfold(tmp_path: Path) -> None:
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 9)]
    assert "more than 20000 values" in refusal(written(tmp_path, "\n".join(lines)))


def test_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    assert "nowhere.yaml: cannot be read: No such file" in refusal(tmp_path / "nowhere.yaml")
    assert "cannot be read: Is a directory" in refusal(tmp_path)
    (tmp_path / "x.yaml").write_bytes(b"a: \xff")
    assert "not UTF-8: byte 3 is 0xff" in refusal(tmp_path / "x.yaml")
    assert "larger than" in refusal(written(tmp_path, "#" * (MAX_BYTES + 1)))


@pytest.mark.parametrize(
    ("goal", "place"),
    [
        ("goal: exists o. B(Grene(o), 0.9)", (1, 19)),
        ('goal: "exists o. B(Grene(o), 0.9)"', (1, 20)),
        ("goal: >\n  exists o.\n\n  B(Grene(o), 0.9)", (4, 5)),
        ("goal: |\n  exists o.\n    B(Grene(o), 0.9)", (3, 7)),
        ("goal: exists o.\n  B(Grene(o), 0.9)", (2, 5)),
    ],
)
def test_faults_inside_a_goal_point_at_the_word_in_every_style_of_yaml(
    goal: str, place: tuple[int, int], tmp_path: Path
) -> None:
    document = load_document(written(tmp_path, goal))
    fault = document.fault(("goal",), "no such word", document.values["goal"].index("Grene"))
    assert (fault.line, fault.column) == place


# ---------------------------------------------------------------- overrides


def test_an_override_replaces_a_value_and_is_part_of_the_text_that_is_recorded(
    rulebook: Rulebook, tmp_path: Path
) -> None:
    flags = ("noise.detection.found=1.0", "world.3.at=[-0.2, 0, 0]", "limits.steps=5")
    document = load_document(GREEN, flags)
    scenario = read(rulebook, GREEN, *flags)
    assert (scenario.true_noise.detection.found, scenario.world[3].at, scenario.limits.steps) == (
        1.0,
        (-0.2, 0.0, 0.0),
        5,
    )
    assert read(rulebook, written(tmp_path, document.effective_text())) == scenario
    assert load_document(GREEN).effective_text() == GREEN.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("flag", "said"),
    [
        ("robot.torso_m=0.45", "--set robot.torso_m=0.45: robot.torso_m: expected 0 to 0.31: metres"),
        ("noise.detection.fuond=1", "noise.detection.fuond: no such key; did you mean 'found'?"),
        ("nois.x=1", "--set nois.x=1: nothing to set at 'nois'; did you mean 'noise'?"),
        ("world.9.id=x", "nothing to set at '9'; there are: 0, 1, 2, 3, 4, 5"),
        ("seed", "--set seed: expected a.b=value"),
        (
            "model.x=1",
            "'model' is \"same\" and has no parts to set; if it may be a mapping, make it one first: --set 'mod",
        ),
        ("seed=[1", "not YAML"),
    ],
)
def test_a_wrong_override_is_reported_as_the_flag_it_came_from(flag: str, said: str, rulebook: Rulebook) -> None:
    with pytest.raises(InputError) as caught:
        read(rulebook, GREEN, flag)
    assert said in str(caught.value)


# ---------------------------------------------------------------- what a sound file says


@pytest.mark.parametrize("path", sorted((ROOT / "scenarios").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_scenario_that_ships_is_sound_and_named_like_its_file(path: Path, rulebook: Rulebook) -> None:
    assert read(rulebook, path).name == path.stem


def test_the_committed_schema_is_the_one_the_models_generate() -> None:
    assert (ROOT / "sim" / "scenario" / "schema.json").read_text(encoding="utf-8") == schema_text()


def test_cans_stand_on_the_side_of_their_tables_that_faces_the_robot(rulebook: Rulebook) -> None:
    bodies = {body.id: body for body in true_bodies(read(rulebook, GREEN), rulebook.vocabulary.types)}
    for can, table in (("sodaE", "table1"), ("sodaB", "table2"), ("sodaC", "table3")):
        x, y, z, _ = bodies[can].world_T_object
        assert math.hypot(x, y) < math.hypot(*bodies[table].world_T_object[:2]) - 0.2
        assert z == 0.68
    assert bodies["sodaC"].world_T_object[:2] == pytest.approx((0.10, 1.35))


def test_what_is_put_on_a_turned_table_turns_with_it(rulebook: Rulebook) -> None:
    bodies = {body.id: body for body in true_bodies(read(rulebook, GREEN), rulebook.vocabulary.types)}
    assert bodies["sodaB"].world_T_object[3] == pytest.approx(0.4 - math.pi / 2)


def test_the_prior_is_drawn_around_the_truth_with_the_stated_deviations(rulebook: Rulebook) -> None:
    scenario, types = read(rulebook, GREEN), rulebook.vocabulary.types
    truth = {body.id: body.world_T_object for body in true_bodies(scenario, types)}
    scores = []
    for seed in range(200):
        prior = prior_of(scenario, types, seed, AT_START)
        for item in prior.objects:
            x, y, z, theta = np.subtract(item.world_T_object, truth[item.anchor])
            scores += [x / item.sd_xy_m, y / item.sd_xy_m, math.remainder(theta, math.tau) / item.sd_theta_rad]
            assert z == 0.0
        scores += [prior.world_T_base[0] / prior.base_sd_xy_m, prior.world_T_base[2] / prior.base_sd_theta_rad]
    assert np.mean(scores) == pytest.approx(0.0, abs=4 / math.sqrt(len(scores)))
    assert np.std(scores) == pytest.approx(1.0, abs=4 / math.sqrt(2 * len(scores)))


def test_the_prior_is_a_function_of_the_seed(rulebook: Rulebook) -> None:
    scenario, types = read(rulebook, GREEN), rulebook.vocabulary.types
    assert prior_of(scenario, types, 3, AT_START) == prior_of(scenario, types, 3, AT_START)
    assert prior_of(scenario, types, 3, AT_START) != prior_of(scenario, types, 4, AT_START)


def test_the_prior_lists_what_the_robot_is_told_in_that_order_and_no_colours(rulebook: Rulebook) -> None:
    prior = prior_of(read(rulebook, GREEN), rulebook.vocabulary.types, 0, AT_START)
    assert [item.anchor for item in prior.objects] == ["table1", "table2", "table3", "sodaE", "sodaB", "sodaC"]
    assert [item.support for item in prior.objects] == [None, None, None, "table1", "table2", "table3"]
    assert all(item.colour is None and item.log_weight is None for item in prior.objects)


def test_objects_told_at_a_place_stand_on_the_table_as_it_is_believed(rulebook: Rulebook, tmp_path: Path) -> None:
    text = GREEN.read_text(encoding="utf-8").replace(
        "{id: sodaC, type: {soda: 1.0}, like: world}", "{id: rumour, type: {soda: 1.0}, on: table3, at: [-0.2, 0, 0]}"
    )
    objects = {
        item.anchor: item
        for item in prior_of(read(rulebook, written(tmp_path, text)), rulebook.vocabulary.types, 0, AT_START).objects
    }
    x, y, _, theta = objects["table3"].world_T_object
    there = (x - 0.2 * math.cos(theta), y - 0.2 * math.sin(theta), 0.68, theta)
    assert objects["rumour"].world_T_object == pytest.approx(there)


REGIONS = """  regions:
    - {id: _reg1_, on: table1, height_m: 0.3, objects: 0.25}
    - {id: _reg2_, on: table2, height_m: 0.25}
"""


def with_regions(folder: Path, regions: str = REGIONS, priors: str = "") -> Path:
    text = GREEN.read_text(encoding="utf-8").replace("priors:", f"priors:\n{priors}#", 1)
    return written(folder, text.replace("\nexpect:", f"{regions}\nexpect:"))


def test_regions_and_types_of_strangers_reach_the_prior(rulebook: Rulebook, tmp_path: Path) -> None:
    path = with_regions(tmp_path, priors="  type: {soda: 0.6, bottle: 0.4}\n  objects_per_region: 0.7\n")
    prior = prior_of(read(rulebook, path), rulebook.vocabulary.types, 0, AT_START)
    assert [(r.anchor, r.support, r.height_m, r.expected_objects) for r in prior.regions] == [
        ("_reg1_", "table1", 0.3, 0.25),
        ("_reg2_", "table2", 0.25, 0.7),
    ]
    assert prior.type == {"soda": 0.6, "bottle": 0.4}
    plain = prior_of(read(rulebook, GREEN), rulebook.vocabulary.types, 0, AT_START)
    assert (plain.regions, plain.type) == ((), {})


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("{id: _reg1_, on: table1, height_m: 1}", "belief.regions.1.id: '_reg1_' is already the name of belief.regi"),
        (
            "{id: _o1_, on: table1, height_m: 1}",
            "regions.1.id: '_o1_' is not the name of a region; those have the form",
        ),
        (
            "{id: shelf, on: table1, height_m: 1}",
            "regions.1.id: String should match pattern '^_reg\\d+_$' (got 'shelf')",
        ),
        ("{id: _reg2_, on: tabel1, height_m: 1}", "regions.1.on: no object 'tabel1'; did you mean 'table1'?"),
        (
            "{id: _reg2_, on: sodaE, height_m: 1}",
            "regions.1.on: 'sodaE' is a soda, which has no top to stand on; there",
        ),
        ("{id: _reg2_, on: table1, height_m: 0}", "regions.1.height_m: expected 0.01 to 2: metres"),
        ("{id: _reg2_, on: table1, height_m: 1, objects: -1}", "objects: expected 0 to 100: a number of objects"),
    ],
)
def test_a_wrong_region_is_refused(wrong: str, said: str, rulebook: Rulebook, tmp_path: Path) -> None:
    regions = f"  regions:\n    - {{id: _reg1_, on: table1, height_m: 0.3}}\n    - {wrong}\n"
    with pytest.raises(InputError) as caught:
        read(rulebook, with_regions(tmp_path, regions))
    assert said in str(caught.value)
    assert len(caught.value.faults) == 1


@pytest.mark.parametrize(
    ("shares", "said"),
    [
        ("{soda: 0.6}", "priors.type: probabilities sum to 0.6, expected 1"),
        ("{sodda: 1.0}", "priors.type.sodda: no type 'sodda'; did you mean 'soda'?"),
        ("{table: 1.0}", "priors.type.table: a table cannot be grasped"),
    ],
)
def test_wrong_types_of_strangers_are_refused(shares: str, said: str, rulebook: Rulebook, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read(rulebook, with_regions(tmp_path, priors=f"  type: {shares}\n"))
    assert said in str(caught.value)


def test_the_model_of_the_noise_may_differ_from_the_noise(rulebook: Rulebook, tmp_path: Path) -> None:
    lines = GREEN.read_text(encoding="utf-8").splitlines(keepends=True)
    start, end = lines.index(next(x for x in lines if x.startswith("noise:"))), 0
    end = lines.index(next(x for x in lines if x.startswith("model:")))
    lines[end : end + 1] = ["model:\n", *lines[start + 1 : end]]
    text = "".join(lines[: end + 1]) + "".join(lines[end + 1 :]).replace("found: 0.90", "found: 0.50")
    scenario = read(rulebook, written(tmp_path, text))
    prior = prior_of(scenario, rulebook.vocabulary.types, 0, AT_START)
    assert (scenario.true_noise.message().found, prior.noise.found) == (0.9, 0.5)


def test_what_stands_on_a_table_that_the_robot_is_not_told_of_has_no_support_in_the_prior(
    rulebook: Rulebook, tmp_path: Path
) -> None:
    lines = GREEN.read_text(encoding="utf-8").splitlines(keepends=True)
    untold = [line for line in lines if "{id: table2, type: {table: 1.0}, like: world" not in line]
    assert len(untold) == len(lines) - 1
    scenario = read(rulebook, written(tmp_path, "".join(untold)))
    prior = prior_of(scenario, rulebook.vocabulary.types, 0, AT_START)
    assert {item.anchor: item.support for item in prior.objects if item.anchor.startswith("soda")} == {
        "sodaE": "table1",
        "sodaB": None,
        "sodaC": "table3",
    }


def test_disturbances_move_things_before_their_step_alone(rulebook: Rulebook) -> None:
    scenario, types = read(rulebook, ROOT / "scenarios" / "sim1_moved.yaml"), rulebook.vocabulary.types
    step = scenario.disturbances[0].before_step
    [(name, world_T_object)] = moves_before(scenario, types, step)
    before = next(body for body in true_bodies(scenario, types) if body.id == name).world_T_object
    assert math.dist(world_T_object[:2], before[:2]) > 0.2
    assert world_T_object[2] == 0.68
    assert moves_before(scenario, types, step + 1) == ()
    assert moves_before(scenario, types, step - 1) == ()
