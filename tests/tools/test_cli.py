"""The command line: exit statuses, streams, and what is imported when."""

import contextlib
import json
import os
import pty
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from kit.places import GOLDEN, ROOT

from skolem.tools import cli
from skolem.tools.run.running import unused
from skolem.traces.file.reader import Trace
from skolem.traces.file.writer import partial_of
from skolem.traces.messages import RunEnd

GREEN = str(ROOT / "scenarios" / "sim1_green.yaml")
COMMAND = [sys.executable, "-c", "import sys; from skolem.tools.cli import main; sys.exit(main())"]
HEAVY = ("numpy", "scipy", "gtsam", "pybullet", "rerun", "clingo", "mcap", "pydantic", "ompl", "rich", "ruamel", "dask")
JSON_FIELDS = [
    "scenario",
    "seed",
    "world",
    "status",
    "believed",
    "true",
    "own",
    "reason",
    "anchor",
    "witness",
    "displaced",
    "goal_probability",
    "conjuncts",
    "regions",
    "actions",
    "replans",
    "clingo_calls",
    "simulated_s",
    "wall_s",
    "trace",
    "content_hash",
]


def skolem(*args: str, cwd: Path | None = None, **env: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *args], capture_output=True, text=True, cwd=cwd, env=os.environ | env, check=False, timeout=120
    )


def called(monkeypatch: pytest.MonkeyPatch, *args: str) -> int:
    """Run the command in this process and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["skolem", *args])
    return cli.main()


# ---------------------------------------------------------------- start-up


def test_help_imports_nothing_heavy_and_lists_every_verb() -> None:
    code = (
        "import sys; sys.argv = ['skolem', '--help']; from skolem.tools.cli import main; main();"
        f"print('LOADED', [m for m in {HEAVY} if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "LOADED []"
    assert all(f"  {verb} " in out for verb in cli.VERBS)


@pytest.mark.parametrize("verb", list(cli.VERBS))
def test_the_table_says_of_each_verb_what_its_own_help_says(
    verb: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, verb, "--help") == 0
    assert cli.VERBS[verb][1] in " ".join(capsys.readouterr().out.split())


def test_version_is_that_of_the_package(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(monkeypatch, "--version") == 0
    assert capsys.readouterr().out.startswith("skolem 0.")


# ---------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["rum"], "no verb 'rum'; did you mean 'run'?"),
        (["zzz"], f"no verb 'zzz'; there are: {', '.join(cli.VERBS)}"),
        (["run", GREEN, "--sede", "1"], "No such option"),
        (["run", GREEN, "--seed", "-1"], "--seed"),
        (["run", "nowhere.yaml"], "nowhere.yaml: cannot be read: No such file or directory"),
        (["run", GREEN, "--set", "robot.torso_m=2"], "--set robot.torso_m=2: robot.torso_m: expected 0 to 0.31"),
        (["run", GREEN, "--images", "--world", "symbolic"], "--images: the symbolic world has no camera"),
        (["sweep", GREEN, "-o", "x", "--seeds", "9-0"], "--seeds: expected A-B with A <= B"),
        (["sweep", GREEN, "-o", "x", "--seeds", "0-99999999"], "--seeds: 100,000,000 seeds, at most 10,000 are run in"),
        (["run", GREEN, "--seed", str(2**63)], "--seed"),
    ],
)
def test_bad_input_exits_with_2_and_says_what_was_expected(
    args: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, *args) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert said in " ".join(err.split())


def test_bad_input_with_json_is_one_object_with_every_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text(Path(GREEN).read_text().replace("torso_m: 0.20", "torso_m: 2").replace("Green(x)", "Grene(x)"))
    assert called(monkeypatch, "run", str(bad), "--json") == 2
    said = json.loads(capsys.readouterr().out)
    assert (said["status"], [fault["at"] for fault in said["faults"]]) == ("bad_input", ["goal", "robot.torso_m"])


def test_scenario_check_reports_each_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text(Path(GREEN).read_text().replace("torso_m: 0.20", "torso_m: 2"))
    assert called(monkeypatch, "scenario", "check", GREEN) == 0
    assert capsys.readouterr().out == f"{GREEN}: sound\n"
    assert called(monkeypatch, "scenario", "check", GREEN, str(bad), "--json") == 2
    [line] = capsys.readouterr().out.splitlines()
    assert json.loads(line).keys() == {"file", "line", "column", "at", "message"}


def test_scenario_schema_prints_the_schema_that_ships(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, "scenario", "schema") == 0
    assert capsys.readouterr().out == (ROOT / "sim" / "scenario" / "schema.json").read_text()


# ---------------------------------------------------------------- run


def test_run_with_json_prints_one_object_and_nothing_else(tmp_path: Path) -> None:
    done = skolem("run", GREEN, "--world", "symbolic", "--seed", "3", "--json", cwd=tmp_path)
    [line] = done.stdout.splitlines()
    said = json.loads(line)
    assert (done.returncode, list(said)) == (0, JSON_FIELDS)
    assert (said["believed"], said["true"], said["seed"]) == (True, True, 3)
    trace = Trace(tmp_path / said["trace"])
    assert (said["trace"], said["content_hash"]) == ("out/sim1_green-3.mcap", trace.content_hash)
    assert len([line for line in done.stderr.splitlines() if line.startswith("step")]) == said["actions"]


@pytest.mark.physics
def test_run_with_json_in_physics_prints_one_object_and_nothing_else(tmp_path: Path) -> None:
    done = skolem("run", GREEN, "--json", "-q", "--max-steps", "1", cwd=tmp_path)
    said = json.loads(done.stdout)
    assert (done.returncode, said["status"], said["actions"]) == (1, "limit_reached", 1)
    assert done.stderr == ""


def test_run_writes_the_same_trace_whatever_the_hash_seed(tmp_path: Path) -> None:
    hashes = [
        json.loads(skolem("run", GREEN, "--world", "symbolic", "--json", cwd=tmp_path, PYTHONHASHSEED=seed).stdout)
        for seed in ("1", "77")
    ]
    assert hashes[0]["content_hash"] == hashes[1]["content_hash"]
    assert [said["trace"] for said in hashes] == ["out/sim1_green-0.mcap", "out/sim1_green-0.2.mcap"]
    assert (tmp_path / hashes[0]["trace"]).read_bytes() == (tmp_path / hashes[1]["trace"]).read_bytes()


def test_run_without_json_prints_belief_and_truth_apart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trace = tmp_path / "a.mcap"
    assert called(monkeypatch, "run", GREEN, "--world", "symbolic", "-o", str(trace), "-q") == 0
    out, err = capsys.readouterr()
    believed, true, where = out.splitlines()
    assert believed.startswith("goal believed achieved; sodaC, p = 0.")
    assert (true, where.split(" (")[0], err) == ("true in the simulator: yes (sodaC)", f"trace: {trace}", "")


def test_run_that_does_not_get_there_exits_with_1_and_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trace = str(tmp_path / "a.mcap")
    assert called(monkeypatch, "run", GREEN, "--world", "symbolic", "-o", trace, "-q", "--max-steps", "2") == 1
    first, properties, truth, _ = capsys.readouterr().out.splitlines()
    assert first.startswith("goal not achieved: 2 actions were executed (limits.steps); best candidate soda")
    assert re.fullmatch(r"  of soda[EBC] is believed: green 0\.\d{3}", properties)
    assert truth == "true in the simulator: no"


def test_show_prints_the_plans_of_a_run_and_what_was_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trace = str(tmp_path / "a.mcap")
    assert called(monkeypatch, "run", GREEN, "--world", "symbolic", "-o", trace, "-q") == 0
    capsys.readouterr()
    assert called(monkeypatch, "show", trace) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("goal: exists o.")
    assert sum(line.startswith("plan dropped: P(soda") for line in lines) == 2
    assert lines[-2].strip() == "done: place sodaC on table1"


def test_show_of_something_that_is_no_trace_exits_with_3(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "notes.mcap"
    other.write_text("not a trace")
    assert called(monkeypatch, "show", str(other)) == 3
    assert "notes.mcap" in capsys.readouterr().err


@pytest.mark.parametrize("debug", [False, True])
def test_an_internal_error_exits_with_4_names_the_closed_trace_and_shows_where_only_if_asked(
    debug: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SKOLEM_DEBUG", "1" if debug else "0")
    monkeypatch.setattr("skolem.sim.symbolic.world.SymbolicWorld.execute", lambda self, action: 1 / 0)
    trace = tmp_path / "a.mcap"
    assert called(monkeypatch, "run", GREEN, "--world", "symbolic", "-o", str(trace), "--json") == 4
    out, err = capsys.readouterr()
    said = json.loads(out)
    assert (said["status"], said["reason"]) == ("error", "ZeroDivisionError: division by zero")
    assert ("Traceback" in err) == debug
    assert f"to report it, send the version and {trace} (" in err
    assert Trace(trace).content_hash == said["content_hash"]


def test_an_internal_error_of_a_verb_without_a_trace_says_how_to_report_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("skolem.sim.scenario.scenario.schema_text", lambda: 1 / 0)
    assert called(monkeypatch, "scenario", "schema") == 4
    err = capsys.readouterr().err
    assert err.startswith(
        "internal error: ZeroDivisionError: division by zero\nthis is a fault of skolem: to report it"
    )
    assert "Traceback" not in err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_exits_with_130_and_leaves_a_sound_trace(tmp_path: Path, number: signal.Signals) -> None:
    slow = (
        "import sys, time; from skolem.sim.symbolic.world import SymbolicWorld as W; e = W.execute;"
        "W.execute = lambda world, action: (time.sleep(0.5), e(world, action))[1];"
        "from skolem.tools.cli import main; sys.exit(main())"
    )
    args = ["run", GREEN, "--world", "symbolic", "-o", str(tmp_path / "a.mcap"), "--json"]
    pipe = subprocess.PIPE
    command = [sys.executable, "-c", slow, *args]
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, preexec_fn=heed_hang_up) as process:
        assert process.stderr is not None
        process.stderr.readline()  # the first action has been executed
        process.send_signal(number)
        out, _ = process.communicate(timeout=60)
    said = json.loads(out)
    assert (process.returncode, said["status"]) == (130, "interrupted")
    assert said["actions"] < 8
    [end] = Trace(tmp_path / "a.mcap").of(RunEnd)
    assert end.status == "interrupted"


def heed_hang_up() -> None:
    """Undo what `nohup` does, should the tests run under it."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def test_under_nohup_a_closed_terminal_ends_nothing() -> None:
    code = "import signal, sys; from skolem.tools.cli import main; sys.argv[1:] = ['--version']; main();"
    code += "sys.exit(signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN)"
    ignored = partial(signal.signal, signal.SIGHUP, signal.SIG_IGN)
    assert subprocess.run([sys.executable, "-c", code], stdout=subprocess.DEVNULL, preexec_fn=ignored).returncode == 0


def test_a_terminal_that_is_closed_ends_the_run_and_leaves_a_sound_trace(tmp_path: Path) -> None:
    slow = (
        "import sys, time; from skolem.sim.symbolic.world import SymbolicWorld as W; e = W.execute;"
        "W.execute = lambda world, action: (time.sleep(0.2), e(world, action))[1];"
        "from skolem.tools.cli import main; sys.exit(main())"
    )
    out = tmp_path / "a.mcap"
    process, terminal = pty.fork()
    if not process:
        heed_hang_up()
        args = ["run", GREEN, "--world", "symbolic", "-o", str(out)]
        os.execve(sys.executable, [sys.executable, "-c", slow, *args], os.environ | {"TERM": "xterm"})
    drawn = b""
    while b"step 1 of" not in drawn:
        drawn += os.read(terminal, 4096)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == 130
    [end] = Trace(out).of(RunEnd)
    assert end.status == "interrupted"


def test_ctrl_c_while_an_object_is_taken_down_is_not_lost(tmp_path: Path) -> None:
    dropped = (
        "import signal, sys, time; from skolem.sim.symbolic.world import SymbolicWorld as W; e = W.execute\n"
        "class Dropped:\n    def __del__(self): signal.raise_signal(signal.SIGINT)\n"
        "W.execute = lambda world, action: (Dropped() and None, time.sleep(0.1), e(world, action))[2]\n"
        "from skolem.tools.cli import main; sys.exit(main())"
    )
    args = ["run", GREEN, "--world", "symbolic", "-o", str(tmp_path / "a.mcap"), "--json"]
    done = subprocess.run([sys.executable, "-c", dropped, *args], capture_output=True, text=True)
    assert (done.returncode, json.loads(done.stdout)["status"]) == (130, "interrupted")
    assert done.stderr == ""


def test_a_reader_that_stops_reading_ends_the_command_quietly() -> None:
    golden = GOLDEN
    for verb in ("scenario schema", f"show {golden / 'sim1_green.mcap'}", f"check {golden / 'sim1_green.mcap'}"):
        shell = f"{' '.join(map(repr, COMMAND))} {verb} | true; exit ${{PIPESTATUS[0]}}"
        done = subprocess.run(["bash", "-c", shell], capture_output=True, text=True)
        assert (done.stdout, done.stderr, done.returncode) == ("", "", 141)


def test_on_a_terminal_the_run_is_shown_live(tmp_path: Path) -> None:
    reader, terminal = pty.openpty()
    args = ["run", GREEN, "--world", "symbolic", "--max-steps", "1"]
    env = os.environ | {"COLUMNS": "120", "LINES": "40", "TERM": "xterm"}
    with subprocess.Popen([*COMMAND, *args], stdout=subprocess.PIPE, stderr=terminal, cwd=tmp_path, env=env) as process:
        os.close(terminal)
        drawn = b"".join(blocks_of(reader))
        assert process.stdout is not None
        said = process.stdout.read()
    assert process.returncode == 1
    assert said.startswith(b"goal not achieved: ")
    assert b"weight d" in drawn
    assert b"step 1 of at most 1" in drawn


def blocks_of(reader: int) -> Iterator[bytes]:
    """Yield what is written to a pseudo-terminal until its other end is closed, which reading reports as an error."""
    with contextlib.suppress(OSError):
        while block := os.read(reader, 4096):
            yield block
    os.close(reader)


def test_default_names_do_not_replace_earlier_traces_nor_what_is_left_of_killed_runs(tmp_path: Path) -> None:
    path = tmp_path / "sim1-7.mcap"
    for expected in ("sim1-7.mcap", "sim1-7.2.mcap", "sim1-7.3.mcap", "sim1-7.4.mcap"):
        free = unused(path)
        assert free.name == expected
        (free if "2" in expected else partial_of(free)).touch()


@pytest.mark.parametrize(
    "command",
    [
        ["run", GREEN, "--world", "symbolic", "-o", "."],
        ["rules", "doc", "-o", "."],
        ["sweep", GREEN, "--world", "symbolic", "-o", "file"],
        ["sweep", GREEN, "--world", "symbolic", "-o", "out", "--write", "."],
        ["reproduce", "file", "--keep", "file"],
    ],
)
def test_what_cannot_be_written_is_said_before_anything_runs(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("worth something")
    assert called(monkeypatch, *command) == 2
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1)
    assert (tmp_path / "file").read_text() == "worth something"
    assert {path.name for path in tmp_path.iterdir()} <= {"file", "out"}


def test_a_trace_that_cannot_be_searched_is_refused() -> None:
    piped = [*COMMAND, "check", "/dev/stdin"]
    done = subprocess.run(piped, input=b"some bytes that are no trace", capture_output=True)
    assert done.returncode == 3
    assert b"Traceback" not in done.stderr
