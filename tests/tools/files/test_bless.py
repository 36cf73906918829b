"""`skolem trace bless` makes, compares and describes golden traces; what is decided as before stays as it is."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from kit.places import ROOT
from kit.tampering import each, rewrite
from mcap.records import Schema

from skolem.tools import cli
from skolem.traces.compare.golden import MANIFEST, read_manifest
from skolem.traces.file.check import check


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(ROOT)
    (tmp_path / MANIFEST).touch()
    return tmp_path


@pytest.fixture
def bless(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> object:
    def call(*args: str) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["skolem", "trace", "bless", "--folder", str(folder), *args])
        return cli.main(), *capsys.readouterr()

    return call


def recipe(steps: int) -> list[str]:
    return ["--scenario", "scenarios/sim1_green.yaml", "--world", "symbolic", "--set", f"limits.steps={steps}"]


def test_a_trace_is_added_left_alone_and_changed_with_its_difference(bless: object, folder: Path) -> None:
    assert callable(bless)
    status, out, _ = bless("short", "--reason", "first", *recipe(1), "--why", "a short run")
    assert (status, out.startswith("short: new; limit_reached, 1 steps, ")) == (0, True)
    golden, data = read_manifest(folder)["short"], (folder / "short.mcap").read_bytes()
    assert (golden.why, golden.reason, golden.overrides) == ("a short run", "first", ("limits.steps=1",))
    assert golden.decision_hash == check(folder / "short.mcap").decision_hash

    status, out, _ = bless("--all", "--reason", "again")
    assert (status, out.startswith("short: unchanged; ")) == (0, True)
    assert (read_manifest(folder)["short"], (folder / "short.mcap").read_bytes()) == (golden, data)

    status, out, _ = bless("short", "--reason", "longer", *recipe(2), "--why", "two steps", "--json")
    said = json.loads(out)
    assert (status, said["changed"], said["reason"], said["steps"]) == (0, True, "longer", 2)
    assert any("/run/start" in line for line in said["changes"])
    assert [path.name for path in sorted(folder.iterdir())] == [MANIFEST, "short.mcap"]


def test_a_trace_with_an_old_schema_or_another_purpose_is_written_anew(bless: object, folder: Path) -> None:
    assert callable(bless)
    bless("short", "--reason", "first", *recipe(1), "--why", "a short run")
    path, data = folder / "short.mcap", (folder / "short.mcap").read_bytes()
    rewrite(path, path, each(Schema, lambda schema: replace(schema, data=b"{}")))
    assert "differ" in bless("short", "--reason", "a new field")[1]
    assert (path.read_bytes(), read_manifest(folder)["short"].reason) == (data, "a new field")
    assert "differ" in bless("short", "--reason", "clearer", *recipe(1), "--why", "one step")[1]
    assert read_manifest(folder)["short"].why == "one step"


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["nobody", "--reason", "x"], "nobody: there is no such trace in"),
        (["--reason", "x"], "expected names of golden traces, or --all"),
        (["a", "b", "--reason", "x", "--scenario", "s.yaml", "--why", "y"], "--scenario: expected one name, and --why"),
        (["a", "--reason", "x", "--scenario", "scenarios/sim1_green.yaml"], "--scenario: expected one name, and --why"),
        (["a"], "Missing option '--reason'"),
    ],
)
def test_bad_requests_are_refused_with_what_was_expected(args: list[str], said: str, bless: object) -> None:
    assert callable(bless)
    status, _, err = bless(*args)
    assert status == 2
    assert said in " ".join(err.split())


def test_a_trace_that_would_be_too_large_is_refused(
    bless: object, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert callable(bless)
    monkeypatch.setattr("skolem.tools.files.blessing.MAX_BYTES", 1000)
    status, _, err = bless("short", "--reason", "first", *recipe(1), "--why", "a short run")
    assert (status, "allowed are 1000; choose a shorter run" in err) == (2, True)
    assert [path.name for path in folder.iterdir()] == [MANIFEST]
