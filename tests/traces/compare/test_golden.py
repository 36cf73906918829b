"""Golden traces: kept small and described truly, together they exercise everything, and each is decided as recorded.

They change by `skolem trace bless` alone, never by a test.
"""

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import get_args

import pytest
from kit.places import ROOT

from skolem.reasoner.lint.derivable import shapes_of
from skolem.reasoner.planning.queries import Queries
from skolem.reasoner.rulebook.book import Rulebook
from skolem.tools import cli
from skolem.tools.recorded.rules import rulebook_of
from skolem.tools.words.trace_account import account
from skolem.traces.compare.golden import MANIFEST, MAX_BYTES, Golden, keep_decisions, read_manifest, write_manifest
from skolem.traces.errors import InputError
from skolem.traces.file.check import check
from skolem.traces.file.codec import CONTENT, counter_of
from skolem.traces.file.reader import Trace
from skolem.traces.messages import Decision, Meaning, Memory, PlanCause, RememberedStep, TypeIs

FOLDER = ROOT / "tests" / "golden"
NAMES = sorted(path.stem for path in FOLDER.glob("*.mcap"))
MAX_BYTES_OF_ALL = 4_500_000

OPERATORS = {"LookAt", "LookAtRegion", "Weigh", "Pick", "Place", "Move"}
INFERENCES = {
    "ExamineObj",
    "FindObj",
    "Split",
    "RemoveObst",
    "Infer type",  # Infer by the quantity that the property is of
    "Infer colour",
    "Infer weight",
}
STATUSES = {
    "goal_achieved",
    "goal_unachievable",
    "no_referent",
    "no_unique_referent",
    "limit_reached",
}  # others are the recorder's: a crash, an interrupt


def described() -> dict[str, Golden]:
    return read_manifest(FOLDER)


def bless_command(name: str) -> str:
    return f"if this is meant: skolem trace bless {name} --reason '...'"


# ---------------------------------------------------------------- what is kept


def test_every_trace_is_in_the_manifest_and_every_entry_has_its_trace() -> None:
    assert NAMES == sorted(described())


@pytest.mark.parametrize("name", NAMES)
def test_a_golden_trace_is_sound_and_is_what_the_manifest_says(name: str) -> None:
    path, golden = FOLDER / f"{name}.mcap", described()[name]
    found = check(path)
    assert found.flaw is None, f"{found.flaw}\n{bless_command(name)}"
    figures = account(Trace(path))
    assert figures.start is not None
    assert figures.end is not None
    assert (found.decision_hash, found.steps, figures.end.status) == (golden.decision_hash, golden.steps, golden.status)
    assert (set(figures.planned), set(figures.causes)) == (set(golden.operators), set(golden.causes))
    assert (figures.start.seed, figures.start.world) == (golden.seed, golden.world)
    assert golden.why
    assert golden.reason


@pytest.mark.parametrize("name", NAMES)
def test_a_golden_trace_is_small_and_holds_decisions_alone(name: str) -> None:
    path = FOLDER / f"{name}.mcap"
    assert path.stat().st_size < MAX_BYTES
    assert {counter_of(recorded.topic) for recorded in Trace(path).messages()} == {"decision"}


def test_all_golden_traces_together_are_small() -> None:
    assert sum((FOLDER / f"{name}.mcap").stat().st_size for name in NAMES) < MAX_BYTES_OF_ALL


def test_git_takes_a_golden_trace_for_bytes() -> None:
    assert "*.mcap binary -diff" in (ROOT / ".gitattributes").read_text().splitlines()


# ---------------------------------------------------------------- what they exercise


def test_together_they_run_every_scenario() -> None:
    there = {f"scenarios/{path.name}" for path in (ROOT / "scenarios").glob("*.yaml")}
    run = {golden.scenario for golden in described().values()}
    assert there - run == set(), "add one: skolem trace bless NAME --scenario FILE --why '...' --reason '...'"
    assert run - there == set(), "of a scenario that is no more"


def test_together_they_change_the_plan_stack_for_every_cause() -> None:
    seen = {cause for golden in described().values() for cause in golden.causes}
    assert set(get_args(PlanCause)) == seen


def test_together_they_end_in_every_way_the_robot_ends_a_run() -> None:
    assert {golden.status for golden in described().values()} == STATUSES


def test_together_they_use_every_operator_and_every_inference_rule() -> None:
    seen = {op for name in NAMES for op in used(Trace(FOLDER / f"{name}.mcap"))}
    assert (OPERATORS | INFERENCES) - seen == set()


def used(trace: Trace) -> Iterator[str]:
    """Yield what a run's plans consist of, inferences of a property with the quantity it is of."""
    meanings = words(tuple(sorted(item for item in trace.attachments.items() if item[0].startswith("rules/"))))
    for decision in trace.of(Decision):
        for op in decision.plan:
            name, _, word = op.partition("(")
            if name == "Infer":
                property_, _, rest = word.split(",")[0].removeprefix("not__").partition("__")
                meaning = meanings[property_ if rest in ("", "below", "above") else word]
                yield f"Infer {'type' if isinstance(meaning, TypeIs) else meaning.quantity}"
            else:
                yield name


@cache
def words(attachments: tuple[tuple[str, bytes], ...]) -> Mapping[str, Meaning]:
    """Return the words of a run's rules; runs with the same rules have the same."""
    return rulebook_of(dict(attachments)).vocabulary.meanings


def test_every_kind_of_step_that_the_rules_can_make_was_planned() -> None:
    """Steps by what the rules themselves call them, so that one that somebody adds, named or not, is asked for too."""
    remembered = [step for name in NAMES for layer in stacks(FOLDER / f"{name}.mcap") for step in layer]
    missing = steps_of(Rulebook.load(Queries)) - {functor(step.instance) for step in remembered}
    assert missing == set(), "no golden run plans it; add one: skolem trace bless NAME --scenario FILE --why '...'"


def test_a_step_without_a_name_is_asked_for_too(tmp_path: Path) -> None:
    """Beside one that has a name, and made by way of another predicate."""
    own = tmp_path / "own.lp"
    own.write_text(
        "step(shake(O)) :- goal(holding(O)).\nexecutes(S, weigh(O)) :- step(S), S = shake(O).\n"
        "operation(S, shake_it(O)) :- step(S), S = shake(O).\nresult(S, holding(O)) :- step(S), S = shake(O).\n"
        "nudged(nudge(O), O) :- goal(holding(O)).\nstep(S) :- nudged(S, _).\nresult(S, holding(O)) :- nudged(S, O).\n"
        "executes(S, look(O)) :- nudged(S, O).\n"
    )
    assert steps_of(Rulebook.load(Queries, [own])) - steps_of(Rulebook.load(Queries)) == {"shake", "nudge"}


def steps_of(rulebook: Rulebook) -> set[str]:
    """Return the names of every kind of step that some belief and goal could make the rules derive."""
    return {functor(str(step)) for (step,) in shapes_of(rulebook.sources).of("step", 1)}


def stacks(path: Path) -> Iterator[tuple[RememberedStep, ...]]:
    """Yield every layer of every plan stack that is remembered in a trace."""
    for memory in Trace(path).of(Memory):
        yield from memory.layers


def functor(term: str) -> str:
    """Return the name before the first bracket of a term."""
    return term.partition("(")[0]


# ---------------------------------------------------------------- that they are decided again


@pytest.mark.parametrize("name", NAMES)
def test_replay_is_identical(name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    replayed(name, monkeypatch, capsys)


@pytest.mark.parametrize("name", NAMES)
def test_the_rules_as_they_are_now_decide_the_same(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    attached = {n: data for n, data in Trace(FOLDER / f"{name}.mcap").attachments.items() if n.startswith("rules/")}
    if all((ROOT / file).is_file() and (ROOT / file).read_bytes() == data for file, data in attached.items()):
        return  # the same rules: that is what the replay above has shown
    replayed(name, monkeypatch, capsys, "--rules", str(ROOT / "rules"))


def replayed(name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *options: str) -> None:
    monkeypatch.setattr("sys.argv", ["skolem", "replay", str(FOLDER / f"{name}.mcap"), *options])
    if cli.main() != 0:
        out, err = capsys.readouterr()
        pytest.fail(f"{out}{err}{bless_command(name)}", pytrace=False)


# ---------------------------------------------------------------- how they are made


def test_what_is_kept_of_a_trace_has_the_same_decision_hash(tmp_path: Path, record_run: object) -> None:
    assert callable(record_run)
    record_run(tmp_path / "full.mcap", profile=True)
    keep_decisions(tmp_path / "full.mcap", tmp_path / "lean.mcap")
    full, lean = Trace(tmp_path / "full.mcap"), Trace(tmp_path / "lean.mcap")
    assert lean.content_hash == lean.decision_hash == full.decision_hash != full.content_hash
    kept = full.metadata | {CONTENT: lean.hashes.metadata}  # of the truth nothing is there that could be hashed
    assert (lean.attachments, lean.metadata) == (full.attachments, kept)
    assert (check(lean.path).flaw, check(lean.path).remarks) == (None, ())
    assert [m.topic for m in lean.messages() if counter_of(m.topic) != "decision"] == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["my run", "--scenario", "a.yaml", "--why", "w"],
        ["../out", "--scenario", "a.yaml", "--why", "w"],
        ["sim1_green", "--seed", "5"],
        ["--all", "--scenario", "a.yaml", "--why", "w"],
    ],
)
def test_names_that_a_manifest_cannot_hold_and_flags_without_effect_are_refused(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["skolem", "trace", "bless", *arguments, "--reason", "r", "--folder", str(FOLDER)])
    assert cli.main() == 2
    assert arguments[0] in capsys.readouterr().err or arguments[1] == "--seed"


def test_the_manifest_is_read_as_it_was_written(tmp_path: Path) -> None:
    odd = Golden(scenario="a.yaml", seed=3, world="symbolic", overrides=("a.b='x \"y\"'",), why="ä\n#\x7f\x1b\\")
    write_manifest(tmp_path, {"b": odd, "a": odd})
    assert list(read_manifest(tmp_path)) == ["a", "b"]
    assert read_manifest(tmp_path)["b"] == odd
    assert tomllib.loads((tmp_path / MANIFEST).read_text())["a"]["overrides"] == ["a.b='x \"y\"'"]


def test_a_reason_that_no_manifest_can_hold_is_refused_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["sim1_green", "--reason", "caf\udce9", "--folder", str(FOLDER)]
    monkeypatch.setattr("sys.argv", ["skolem", "trace", "bless", *arguments])
    assert cli.main() == 2
    assert capsys.readouterr().err.startswith("--reason: is not text that a file can hold")


@pytest.mark.parametrize(
    ("text", "said"),
    [("[a", "is not a manifest"), ("[a]\nseed = 'x'\n", "is not a manifest"), (None, "cannot be read")],
)
def test_a_manifest_that_cannot_be_read_is_named(tmp_path: Path, text: str | None, said: str) -> None:
    if text is not None:
        (tmp_path / MANIFEST).write_text(text)
    with pytest.raises(InputError, match=said):
        read_manifest(tmp_path)
