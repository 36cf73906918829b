"""Worlds by name: those that ship, those that an installed package brings, and those of a script."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest
from kit.places import ROOT
from pydantic import ValidationError

from skolem.tools import cli
from skolem.tools.loop import WorldKind, prepare, run, worlds
from skolem.traces.compare.golden import Golden
from skolem.traces.errors import InputError
from skolem.traces.file.reader import Trace
from skolem.traces.messages import RunStart

GREEN = ROOT / "scenarios" / "sim1_green.yaml"
SHORT = "limits.steps=3"
MODULE = """
from dataclasses import replace
from skolem.tools.loop import worlds

calm = replace(worlds.named("symbolic"), name="whatever")
odd = "no world at all"
"""


def install(folder: Path, name: str = "mine", value: str = "my_world:calm", package: str = "my_world") -> Path:
    """Lay a package that offers a world into a folder, as an installer would, and return the folder."""
    about = folder / f"{package}-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n", encoding="utf-8")
    (about / "entry_points.txt").write_text(f"[{worlds.GROUP}]\n{name} = {value}\n", encoding="utf-8")
    (folder / f"{package}.py").write_text(MODULE, encoding="utf-8")
    return folder


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = install(tmp_path / "site")
    monkeypatch.syspath_prepend(str(folder))
    return folder


def called(patch: pytest.MonkeyPatch, *args: str, site: Path | None = None) -> int:
    """Run the command in this process, with one more folder of installed packages or none; return its exit status."""
    with patch.context() as change:
        change.setattr(sys, "argv", ["skolem", *args])
        if site is not None:
            change.syspath_prepend(str(site))
        return cli.main()


def test_two_worlds_ship() -> None:
    assert worlds.names() == ["pybullet", "symbolic"]
    assert [(kind.name, kind.camera) for kind in map(worlds.named, worlds.names())] == [
        ("pybullet", True),
        ("symbolic", False),
    ]


def test_an_installed_package_brings_a_world_under_the_name_of_its_entry_point(installed: Path) -> None:
    assert worlds.names() == ["mine", "pybullet", "symbolic"]
    assert worlds.named("mine") == replace(worlds.SYMBOLIC, name="mine")


def test_no_package_replaces_a_world_that_ships(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(install(tmp_path, "symbolic")))
    assert worlds.named("symbolic") is worlds.SYMBOLIC


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("odd", "my_world:odd", r"the world 'odd' \(my_world:odd\) is a str, expected a WorldKind"),
        ("gone", "my_world:gone", r"the world 'gone' \(my_world:gone\) cannot be loaded: AttributeError"),
        ("away", "nowhere:kind", r"the world 'away' \(nowhere:kind\) cannot be loaded: ModuleNotFoundError"),
    ],
)
def test_a_world_that_cannot_be_used_is_refused_with_its_place(
    name: str, value: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(install(tmp_path, name, value)))
    with pytest.raises(InputError, match=said):
        worlds.named(name)


def test_two_packages_with_one_name_are_both_named(
    installed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(install(tmp_path / "other", "mine", "your_world:calm", "your_world")))
    with pytest.raises(InputError, match="two packages offer a world 'mine': my_world:calm and your_world:calm"):
        worlds.named("mine")


def test_a_script_hands_its_own_world_to_a_run_which_the_trace_names(tmp_path: Path) -> None:
    own = replace(worlds.SYMBOLIC, name="my.own-world_2")
    outcome = run(prepare(GREEN, [SHORT], 0, own), tmp_path / "own.mcap")
    assert outcome.actions == 3
    trace = Trace(tmp_path / "own.mcap")
    [start] = trace.of(RunStart)
    assert start.world == trace.metadata["run"]["world"] == "my.own-world_2"


def test_a_world_without_a_camera_records_no_images() -> None:
    with pytest.raises(InputError, match="--images: the symbolic world has no camera; leave out one of the two"):
        prepare(GREEN, world="symbolic", images=True)


@pytest.mark.parametrize("name", ["", "1st", "a b", "../x", "sym/bolic"])
def test_a_name_that_no_world_can_have_is_no_name_in_a_trace_or_a_manifest(name: str) -> None:
    with pytest.raises(ValidationError, match="world"):
        Golden(scenario="a.yaml", seed=0, world=name, overrides=(), why="")


@pytest.mark.parametrize("verb", [("run", "-q"), ("sweep",)])
def test_a_wrong_name_ends_with_status_2_the_nearest_name_and_every_world_there_is(
    verb: tuple[str, ...],
    installed: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "o"
    assert called(monkeypatch, *verb, str(GREEN), "--world", "symbolik", "-o", str(out)) == 2
    said = "--world: no world 'symbolik' is installed; did you mean 'symbolic'? there are: mine, pybullet, symbolic"
    assert capsys.readouterr().err.strip() == said
    assert not out.exists()


def test_a_trace_of_a_world_that_is_not_installed_any_more_is_read_and_thought_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    site, trace = install(tmp_path / "site"), str(tmp_path / "t.mcap")
    assert called(monkeypatch, "run", str(GREEN), "--world", "mine", "-q", "-o", trace, site=site) == 0
    assert called(monkeypatch, "reproduce", trace, "-q", site=site) == 0
    for verb, said in (("replay", "IDENTICAL"), ("explain", "sodaC"), ("show", "sodaC"), ("info", "mine world")):
        capsys.readouterr()
        assert called(monkeypatch, verb, trace) == 0
        assert said in capsys.readouterr().out
    other_goal = ("--set", "goal=B(On(sodaE, table2), 0.9)")
    for arguments in (("reproduce", trace), ("replay", trace, "--plan-motions"), ("replay", trace, *other_goal)):
        assert called(monkeypatch, *arguments) == 2
        err = capsys.readouterr().err
        assert trace in err
        assert "no world 'mine' is installed; there are: pybullet, symbolic" in err


def test_what_a_kind_of_world_needs_is_a_name_a_world_and_a_planner() -> None:
    kind = WorldKind("bare", worlds.SYMBOLIC.build, worlds.SYMBOLIC.planner)
    assert (kind.robot_sha256(), kind.camera) == ("", False)
