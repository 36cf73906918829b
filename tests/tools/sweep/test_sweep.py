"""Many runs at a time: the same tables whatever the number of workers, nothing done twice, nothing lost."""

import csv
import gc
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from distributed import Client
from kit.places import ROOT
from kit.tampering import each, rewrite
from mcap.records import Metadata

from skolem.tools import cli
from skolem.tools.loop.setup import Setup, prepare
from skolem.tools.loop.stopwatch import PARTS
from skolem.tools.sweep import pool
from skolem.tools.sweep.earlier import Earlier, earlier
from skolem.tools.sweep.rows import Row, results_csv, times_csv
from skolem.tools.sweep.sweeping import LOCK, seed_range
from skolem.tools.sweep.task import Task, WorkerRefusedError, perform, run_on_worker, tasks_of
from skolem.traces.errors import InputError
from skolem.traces.file.codec import CONTENT
from skolem.traces.file.reader import Trace
from skolem.traces.messages import RunEnd
from skolem.traces.written import locked

GREEN = ROOT / "scenarios" / "sim1_green.yaml"
COMMAND = [sys.executable, "-c", "import sys; from skolem.tools.cli import main; sys.exit(main())"]
SHORT = "limits.steps=1"  # the promises here are not about long runs
HOST = "127.0.0.1"
BOUND_S = 60  # nothing here waits for longer


def sweep(out: Path, *args: str) -> list[str]:
    return [*COMMAND, "sweep", str(GREEN), "--world", "symbolic", "--set", SHORT, "-o", str(out), *args]


@contextmanager
def started(command: list[str], quiet: bool = False) -> Iterator[subprocess.Popen[str]]:
    """Start a process in a group of its own; it ends with the block, and after `BOUND_S` in any case."""
    output = subprocess.DEVNULL if quiet else subprocess.PIPE
    with subprocess.Popen(command, stdout=output, stderr=output, text=True, start_new_session=True) as process:
        limit = threading.Timer(BOUND_S, process.kill)
        limit.start()
        try:
            yield process
        finally:
            limit.cancel()
            process.kill()


def heard_by(process: psutil.Process) -> list[str]:
    """Return the hosts at which a process listens."""
    return [found.laddr.ip for found in process.net_connections() if found.status == psutil.CONN_LISTEN]


def called(monkeypatch: pytest.MonkeyPatch, *args: str) -> int:
    """Run the command in this process and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["skolem", *args])
    return cli.main()


def table(out: Path) -> list[dict[str, str]]:
    with (out / "results.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def setup() -> Setup:
    return prepare(GREEN, [SHORT], world="symbolic")


def task(seed: int = 0) -> Task:
    return tasks_of(setup(), [SHORT], range(seed, seed + 1))[0]


# ---------------------------------------------------------------- one run


@pytest.mark.parametrize(("text", "seeds"), [("0-2", [0, 1, 2]), ("7", [7]), ("3-3", [3])])
def test_seeds_are_a_range_with_both_ends(text: str, seeds: list[int]) -> None:
    assert list(seed_range(text)) == seeds


def test_a_task_needs_no_file_of_the_one_who_asks(tmp_path: Path) -> None:
    """The scenario's own word is defined beside it here, and nowhere there."""
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    (tmp_path / "mossy.lp").write_text("% a word\ncolour(mossy, 90, 150, 40, 100, 20, 100).\n")
    scenario = here / "own.yaml"
    scenario.write_text(GREEN.read_text().replace("Green(x)", "Mossy(x)") + "rules: [../mossy.lp]\n")
    [made] = tasks_of(prepare(scenario, [SHORT], world="symbolic"), [SHORT], range(1))
    scenario.unlink()
    (tmp_path / "mossy.lp").unlink()
    row = perform(made, there).row
    assert (row.status, row.actions) == ("limit_reached", 1)


def test_a_run_that_raises_is_a_row_with_its_trace(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("skolem.sim.symbolic.world.SymbolicWorld.execute", lambda self, action: 1 / 0)
    run = perform(task(), tmp_path)
    assert (run.row.status, run.row.believed, run.row.true) == ("error", False, None)
    assert run.row.reason == "ZeroDivisionError: division by zero"
    kept = tmp_path / "kept.mcap"
    kept.write_bytes(run.trace)
    assert [end.status for end in Trace(kept).of(RunEnd)] == ["error"]


def test_another_program_refuses_to_do_the_run(tmp_path: Path) -> None:
    made = task()
    older = replace(made, source="of last week")
    with pytest.raises(WorkerRefusedError, match="another version of skolem"):
        perform(older, tmp_path)


def test_a_worker_keeps_no_garbage_of_a_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    class Worker:
        state = SimpleNamespace(nthreads=1)
        local_directory = str(tmp_path)

    class Circle:
        def __init__(self) -> None:
            self.itself = self

    left: list[weakref.ref[Circle]] = []
    monkeypatch.setattr("distributed.get_worker", Worker)
    monkeypatch.setattr("skolem.tools.sweep.task.perform", lambda task, folder: left.append(weakref.ref(Circle())))
    gc.disable()
    try:
        run_on_worker(task())
    finally:
        gc.enable()
    assert [found() for found in left] == [None]


def test_only_a_whole_trace_of_the_same_run_counts_as_done(tmp_path: Path) -> None:
    made = task()
    path = tmp_path / made.name
    assert earlier(made, setup(), tmp_path) == Earlier()
    run = perform(made, tmp_path)
    path.write_bytes(run.trace)
    assert earlier(made, setup(), tmp_path) == Earlier(run.row)
    others = {
        "seed": 5,
        "goal": "another",
        "world": "pybullet",
        "limits": made.start.limits.model_copy(update={"steps": 2}),
        "rules_sha256": {},
        "robot_sha256": "another",
        "scenario_sha256": "",
    }
    for name, value in others.items():
        asked = replace(made, start=made.start.model_copy(update={name: value}))
        found = earlier(asked, setup(), tmp_path)
        assert (name, found.row, found.why.startswith("of ")) == (name, None, True)
    assert earlier(replace(made, source="of last week"), setup(), tmp_path).why == "of another version of the program"
    path.write_bytes(run.trace[:-100])
    assert earlier(made, setup(), tmp_path).why.startswith("truncated")


def test_a_trace_whose_hash_does_not_fit_does_not_count(tmp_path: Path) -> None:
    made = task()
    path = tmp_path / made.name
    path.write_bytes(perform(made, tmp_path).trace)
    forged = dict.fromkeys(Trace(path).metadata[CONTENT], "forged")
    other = each(Metadata, lambda record: Metadata(CONTENT, forged) if record.name == CONTENT else record)
    rewrite(path, tmp_path / "forged", other).replace(path)
    assert earlier(made, setup(), tmp_path).why == "not as the hash of its content says"


def test_a_run_that_raised_is_tried_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    made = task()
    monkeypatch.setattr("skolem.sim.symbolic.world.SymbolicWorld.execute", lambda self, action: 1 / 0)
    (tmp_path / made.name).write_bytes(perform(made, tmp_path).trace)
    assert earlier(made, setup(), tmp_path) == Earlier(why="of a run that was cut short (error)")


def test_wall_times_stay_out_of_the_table_of_results(tmp_path: Path) -> None:
    row = perform(task(), tmp_path).row
    slower = Row(**row.facts() | {"size_bytes": 1, "seconds": dict.fromkeys(row.seconds, 99.0)})  # type: ignore[arg-type]
    assert results_csv([row]) == results_csv([slower])
    assert times_csv([row]) != times_csv([slower])
    assert row.seconds["total"] >= sum(row.seconds[part] for part in PARTS) * 0.99


# ---------------------------------------------------------------- the command


@pytest.fixture(scope="module")
def by_two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep of four runs on two workers."""
    out = tmp_path_factory.mktemp("two")
    done = subprocess.run(sweep(out, "--seeds", "0-3", "--json"), capture_output=True, text=True, timeout=BOUND_S)
    assert done.returncode == 1, done.stderr
    assert [json.loads(line)["seed"] for line in done.stdout.splitlines()] == [0, 1, 2, 3]
    assert sum("seed" in line for line in done.stderr.splitlines()) == 4
    return out


def test_one_worker_and_two_workers_give_equal_results(by_two: Path, tmp_path: Path) -> None:
    subprocess.run(sweep(tmp_path, "--seeds", "0-3", "--workers", "1", "-q"), capture_output=True, timeout=BOUND_S)
    assert (tmp_path / "results.csv").read_bytes() == (by_two / "results.csv").read_bytes()
    assert [(row["scenario"], row["seed"]) for row in table(tmp_path)] == [("sim1_green", str(i)) for i in range(4)]
    assert all((tmp_path / row["trace"]).exists() for row in table(tmp_path))


def test_resuming_does_nothing_anew(
    by_two: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in by_two.glob("*.mcap")}
    results = (by_two / "results.csv").read_bytes()
    monkeypatch.setattr("skolem.tools.sweep.task.perform", None)
    args = [str(GREEN), "--world", "symbolic", "--set", SHORT, "--seeds", "0-3", "-o", str(by_two)]
    assert called(monkeypatch, "sweep", *args) == 1
    assert {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in by_two.glob("*.mcap")} == before
    assert (by_two / "results.csv").read_bytes() == results
    assert "4 of 4 runs" in capsys.readouterr().out


def test_an_account_is_put_into_a_file_that_has_others(by_two: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    results = by_two / "written.md"
    results.write_text("# Results\n\nIntro.\n")
    args = [str(GREEN), "--world", "symbolic", "--set", SHORT, "--seeds", "0-3", "-o", str(by_two)]
    assert called(monkeypatch, "sweep", *args, "--write", str(results), "-q") == 1
    text = results.read_text()
    assert text.startswith("# Results\n\nIntro.\n\n<!-- results sim1_green symbolic limits.steps=1 -->")
    assert "| goal believed achieved | 0 of 4 | 0.0% |" in text
    assert called(monkeypatch, "sweep", *args, "--write", str(results), "-q") == 1
    assert results.read_text() == text


def test_a_trace_that_does_not_count_is_named_and_kept(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(GREEN.read_text().replace("Green(x)", "Red(x)"))
    args = ["--world", "symbolic", "--set", SHORT, "--seeds", "0", "--workers", "1", "-q", "-o", str(tmp_path / "out")]
    out, contents = tmp_path / "out", []
    for scenario, kept in ((GREEN, ""), (other, ".old"), (GREEN, ".old.2")):
        called(monkeypatch, "sweep", str(scenario), *args)
        name = table(out)[0]["trace"]
        contents.append((out / name).read_bytes())
        said = capsys.readouterr().err
        if kept:
            known = Path(name)
            assert (out / f"{known.stem}{kept}{known.suffix}").read_bytes() == contents[-2]
            assert said.startswith(f"{out / name}: of another goal: the run is done anew, and this kept as ")
    assert len(list(out.glob("*.mcap"))) == 3
    assert len(set(contents)) == 3 or contents[0] == contents[2] != contents[1]


def test_a_folder_serves_one_sweep_at_a_time(
    by_two: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    args = ["sweep", str(GREEN), "--world", "symbolic", "--set", SHORT, "--seeds", "0-3", "-o", str(by_two)]
    with locked(by_two, LOCK):
        assert called(monkeypatch, *args) == 2
    said = f"{by_two}: is in use by process {os.getpid()}; wait for it, or give another folder\n"
    assert capsys.readouterr().err == said
    assert called(monkeypatch, *args) == 1


class Reluctant:
    """A cluster that does not start, or does not end."""

    def __init__(self, starts: bool) -> None:
        self._starts = starts

    def __call__(self, **_: object) -> "Reluctant":
        if not self._starts:
            raise RuntimeError("Nanny failed to start.")
        return self

    def close(self) -> None:
        raise TimeoutError


def test_workers_that_do_not_start_are_one_line_and_2(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(pool, "LocalCluster", Reluctant(starts=False))
    with pytest.raises(InputError, match=r"^--workers: the processes could not be started: Nanny failed to start\.$"):
        with pool.local_workers(1):
            pytest.fail("there are workers")


def test_workers_that_do_not_end_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "LocalCluster", Reluctant(starts=True))
    monkeypatch.setattr(pool, "Client", lambda cluster: cluster)
    with pool.local_workers(1):
        pass
    with pytest.raises(OSError, match="of the block"), pool.local_workers(1):
        raise OSError("of the block")


@pytest.mark.parametrize(
    ("args", "said"),
    [
        ([str(GREEN), "nowhere.yaml"], "nowhere.yaml: cannot be read"),
        ([str(GREEN), str(GREEN)], "the scenario 'sim1_green' was given already"),
        (
            [str(GREEN), "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"],
            "--scheduler: give --workers or --scheduler",
        ),
        ([str(GREEN), "--set", "limits.steps=-1"], "--set limits.steps=-1: limits.steps"),
    ],
)
def test_bad_input_exits_with_2_before_anything_starts(
    args: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr("skolem.tools.sweep.sweeping.execute", None)
    assert called(monkeypatch, "sweep", *args, "--world", "symbolic", "-o", str(tmp_path / "out")) == 2
    assert said in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out").exists()


def test_bad_input_with_json_is_one_object(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert called(monkeypatch, "sweep", "nowhere.yaml", "-o", str(tmp_path), "--json") == 2
    said = json.loads(capsys.readouterr().out)
    assert (said["status"], [fault["file"] for fault in said["faults"]]) == ("bad_input", ["nowhere.yaml"])


def test_ctrl_c_keeps_what_is_finished_and_leaves_no_process(tmp_path: Path) -> None:
    with started(sweep(tmp_path, "--seeds", "0-19")) as process:
        first = process.stderr.readline()  # type: ignore[union-attr]
        family = psutil.Process(process.pid).children(recursive=True)
        assert {host for member in [psutil.Process(process.pid), *family] for host in heard_by(member)} == {HOST}
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
        _, err = process.communicate()
    assert (process.returncode, "Traceback" in err) == (130, False), err
    rows = table(tmp_path)
    told = {first.rstrip(), *err.splitlines()}  # a line that is interrupted while it is written may come again
    assert 1 <= len(told) == len(rows) < 20
    assert all((tmp_path / row["trace"]).exists() for row in rows)
    assert psutil.wait_procs(family, timeout=BOUND_S)[1] == []


# ---------------------------------------------------------------- a scheduler and workers elsewhere


def dask(*args: str) -> list[str]:
    return [sys.executable, "-m", "dask", *args, "--host", HOST, "--no-dashboard"]


Transitions = list[tuple[str, str, str]]  # run, state before, state after


def transitions_of(client: Client) -> Transitions:
    """Return what became of each run, as the scheduler recorded it."""
    recorded = client.run_on_scheduler(lambda dask_scheduler: [entry[:3] for entry in dask_scheduler.transition_log])
    return [(str(run), before, after) for run, before, after in recorded]


def stopped_at_work(client: Client, workers: dict[str, subprocess.Popen[str]]) -> tuple[str, str]:
    """Stop a worker in the middle of a run, with no result left to fetch from it; return its name and the run.

    What a worker said before it was stopped is given time to arrive: if it was of the end of the run, the worker goes
    on and another moment is waited for.
    """
    for attempt in range(1000):
        name = sorted(workers)[attempt % len(workers)]
        workers[name].send_signal(signal.SIGSTOP)
        time.sleep(0.2)
        at_work = {info["name"]: address for address, info in client.scheduler_info(n_workers=-1)["workers"].items()}
        runs, results = client.processing()[at_work[name]], client.has_what()[at_work[name]]
        if runs and not results:
            return name, str(runs[0])
        workers[name].send_signal(signal.SIGCONT)
        time.sleep(0.05)
    raise AssertionError("no worker was ever at work")


def test_a_worker_that_is_killed_takes_no_run_along(by_two: Path, tmp_path: Path) -> None:
    """Two workers have joined; the one that dies is at work, half-way through the sweep; the other does its run."""
    out = tmp_path / "out"
    with socket.socket() as free:
        free.bind((HOST, 0))
        port = free.getsockname()[1]
    address = f"tcp://{HOST}:{port}"
    worker = dask("worker", address, "--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path))
    with (
        started(dask("scheduler", "--port", str(port)), quiet=True),
        started([*worker, "--name", "a"], quiet=True) as a,
        started([*worker, "--name", "b"], quiet=True) as b,
        Client(address, timeout=BOUND_S, set_as_default=False) as client,
    ):
        client.wait_for_workers(2, timeout=BOUND_S)
        with started(sweep(out, "--seeds", "0-5", "--scheduler", address)) as process:
            lines = [process.stderr.readline() for _ in range(2)]  # type: ignore[union-attr]
            name, run = stopped_at_work(client, {"a": a, "b": b})
            {"a": a, "b": b}[name].kill()
            _, err = process.communicate()
        transitions = transitions_of(client)
        assert {info["name"] for info in client.scheduler_info(n_workers=-1)["workers"].values()} == {"a", "b"} - {name}
    assert process.returncode == 1, err
    lines += err.splitlines()
    assert sorted(line.split("seed ")[1][0] for line in lines if line.startswith("[")) == list("012345")
    assert [row["status"] for row in table(out)] == ["limit_reached"] * 6
    assert table(out)[:4] == table(by_two)
    finished = [key for key, before, after in transitions if (before, after) == ("processing", "memory")]
    begun = [key for key, before, after in transitions if after == "processing" != before]
    assert len(finished) == len(set(finished)) == 6
    assert begun.count(run) == 2


def test_a_scheduler_that_is_lost_is_one_line_and_what_is_finished_stays(tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind((HOST, 0))
        port = free.getsockname()[1]
    address = f"tcp://{HOST}:{port}"
    worker = dask("worker", address, "--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path))
    out = tmp_path / "out"
    with (
        started(dask("scheduler", "--port", str(port)), quiet=True) as scheduler,
        started(worker, quiet=True),
        started(sweep(out, "--seeds", "0-29", "--scheduler", address)) as process,
    ):
        first = process.stderr.readline()  # type: ignore[union-attr]
        scheduler.kill()
        _, err = process.communicate()
    *others, last = err.splitlines()
    said = "the scheduler was lost; the finished runs are kept, and the same command does the others"
    assert (process.returncode, last) == (2, f"--scheduler: {said}")
    assert all(line.startswith("[") for line in others)
    assert all((out / row["trace"]).exists() for row in table(out))
    assert len(table(out)) == len([first, *others])


def test_a_scheduler_that_is_not_there_is_bad_input(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr("skolem.tools.sweep.pool.CONNECT_S", 0.2)
    args = [str(GREEN), "--world", "symbolic", "--seeds", "0", "-o", str(tmp_path), "--scheduler", f"tcp://{HOST}:9"]
    assert called(monkeypatch, "sweep", *args) == 2
    assert f"no scheduler answers at 'tcp://{HOST}:9'" in capsys.readouterr().err
