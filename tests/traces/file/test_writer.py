import errno
import io
import math
import os
import platform
import re
import signal
import socket
import subprocess
import sys
import zlib
from collections.abc import Callable, Iterator
from contextlib import closing, nullcontext
from pathlib import Path
from typing import Any, NoReturn

import pytest
from kit.places import SCENARIOS, TESTS
from mcap.records import Chunk
from mcap.writer import Writer

from skolem.sim.symbolic.world import SymbolicWorld
from skolem.tools.loop.session import run
from skolem.tools.loop.setup import prepare
from skolem.traces.errors import InputError, InternalError, UnwrittenError
from skolem.traces.file import writer as writer_module
from skolem.traces.file.container import Copy, pieces
from skolem.traces.file.environment import PACKAGES, environment
from skolem.traces.file.reader import Trace
from skolem.traces.file.recover import recover
from skolem.traces.file.writer import CHUNK_BYTES, TraceWriter, partial_of
from skolem.traces.messages import Action, Chain, Perf, RunEnd, TrueState, Verdict

SAMPLE_RUN = TESTS / "kit" / "sample_run.py"
STILL = Verdict(true=False)
TRUE_STATE = TrueState(step=0, world_T_base=(0.0, 0.0, 0.0), objects=(), sha256="00")


def open_writer(path: Path) -> TraceWriter:
    return TraceWriter(path, attachments={}, run={}, env={})


def end_of(path: Path) -> RunEnd:
    return list(Trace(path).of(RunEnd))[-1]


def test_two_processes_with_different_hash_seeds_write_the_same_bytes(tmp_path: Path) -> None:
    written = []
    for hash_seed in ("0", "5"):
        out = tmp_path / f"{hash_seed}.mcap"
        command = [sys.executable, str(SAMPLE_RUN), str(out)]
        subprocess.run(command, check=True, env=os.environ | {"PYTHONHASHSEED": hash_seed})
        written.append(out.read_bytes())
    assert written[0] == written[1]


def test_the_writer_computes_the_content_hash_that_a_reader_computes(
    tmp_path: Path, record_run: Callable[..., str]
) -> None:
    content_hash = record_run(tmp_path / "a.mcap")
    assert content_hash == Trace(tmp_path / "a.mcap").content_hash


def test_wall_times_are_recorded_for_a_profile_only(tmp_path: Path, record_run: Callable[..., str]) -> None:
    plain, profiled = tmp_path / "plain.mcap", tmp_path / "profiled.mcap"
    assert record_run(plain, wall_ms=1.0) == record_run(profiled, wall_ms=2.5, profile=True)
    assert not list(Trace(plain).of(Perf))
    assert [perf.milliseconds for perf in Trace(profiled).of(Perf)] == [{"sim": 2.5}] * 3


def test_an_exception_leaves_a_complete_trace_that_says_why(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"

    def run() -> None:
        with open_writer(path) as writer:
            writer.candidate(0.25, "o1")
            writer.write("/truth/state", TRUE_STATE, 100)
            raise ZeroDivisionError("division by zero")

    with pytest.raises(ZeroDivisionError):
        run()
    end = RunEnd(
        status="error", steps=0, reason="ZeroDivisionError: division by zero", goal_probability=0.25, anchor="o1"
    )
    assert end_of(path) == end
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap"]


def test_ctrl_c_leaves_a_complete_trace_that_says_so(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with pytest.raises(KeyboardInterrupt), open_writer(path):
        signal.raise_signal(signal.SIGINT)
    assert (end_of(path).status, end_of(path).reason) == ("interrupted", "KeyboardInterrupt")


def test_ctrl_c_in_the_middle_of_a_message_or_of_closing_tears_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for method in ("add_message", "finish"):
        original = getattr(Writer, method)

        def interrupted(*args: object, original: Callable[..., None] = original) -> None:
            signal.raise_signal(signal.SIGINT)
            original(*args)

        path = tmp_path / f"{method}.mcap"
        monkeypatch.setattr(Writer, method, interrupted)
        with pytest.raises(KeyboardInterrupt), open_writer(path) as writer:
            writer.write("/truth/state", TRUE_STATE, 100)
        monkeypatch.setattr(Writer, method, original)
        assert next(Trace(path).of(TrueState)) == TRUE_STATE


def test_ctrl_c_while_the_file_is_begun_leaves_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Writer, "register_schema", lambda *_: signal.raise_signal(signal.SIGINT))
    with pytest.raises(KeyboardInterrupt), open_writer(tmp_path / "a.mcap"):
        pytest.fail("the block was entered")
    assert list(tmp_path.iterdir()) == []


def test_a_request_to_end_that_is_made_again_tears_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    handler = signal.signal(signal.SIGALRM, signal.default_int_handler)  # as the command line does
    original = Writer.add_message

    def interrupted(*args: object) -> None:
        signal.raise_signal(signal.SIGALRM)
        original(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(Writer, "add_message", interrupted)
    try:
        with pytest.raises(KeyboardInterrupt), open_writer(tmp_path / "a.mcap") as writer:
            writer.write("/truth/state", TRUE_STATE, 100)
    finally:
        signal.signal(signal.SIGALRM, handler)
    assert next(Trace(tmp_path / "a.mcap").of(TrueState)) == TRUE_STATE


def test_what_a_killed_run_left_is_never_replaced(tmp_path: Path) -> None:
    left = tmp_path / "a.mcap.partial"
    left.write_text("steps")
    with (
        pytest.raises(InputError, match=r"skolem recover .*a\.mcap\.partial -o FILE"),
        open_writer(tmp_path / "a.mcap"),
    ):
        pytest.fail("the block was entered")
    assert left.read_text() == "steps"


def test_of_two_runs_that_write_one_trace_at_once_the_second_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with open_writer(path) as writer:
        with pytest.raises(InputError, match="another run is writing it"), open_writer(path):
            pytest.fail("the block was entered")
        writer.write("/truth/state", TRUE_STATE, 100)
    assert writer.content_hash == Trace(path).content_hash
    with open_writer(path):  # a complete one may be replaced
        pass
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap"]


def test_a_run_that_forgets_its_end_record_gets_one(tmp_path: Path, record_run: Callable[..., str]) -> None:
    path = tmp_path / "a.mcap"
    record_run(path, steps=2, last_words=False)
    assert (end_of(path).status, end_of(path).steps) == ("error", 2)
    assert end_of(path).reason == "closed without an end record"


def test_an_odd_file_name_in_an_error_does_not_spoil_the_end_record(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with pytest.raises(ValueError, match="no file"), open_writer(path):
        raise ValueError("no file \udcff")
    assert end_of(path).reason == "ValueError: no file \\udcff"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (FileNotFoundError(2, "No such file or directory", "/srv/robot/a.urdf"), "No such file or directory"),
        (PermissionError(13, "Permission denied", "/srv/robot/a", None, "/srv/robot/b"), "Permission denied"),
        (ImportError("no name 'x' in 'y' (/srv/robot/lib/y.so)"), "no name 'x' in 'y' (y.so)"),
        (ValueError("0.5 m/s is above 1/3 m/s"), "0.5 m/s is above 1/3 m/s"),
    ],
)
def test_the_end_record_of_a_crash_does_not_say_where_files_lie(tmp_path: Path, error: Exception, said: str) -> None:
    with pytest.raises(type(error)), open_writer(tmp_path / "a.mcap"):
        raise error
    assert end_of(tmp_path / "a.mcap").reason == f"{type(error).__name__}: {said}"


@pytest.mark.parametrize("crashed", [False, True])
def test_a_whole_run_says_neither_where_nor_on_which_machine_it_was(
    crashed: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, setup = tmp_path / "run.mcap", prepare(SCENARIOS / "sim1_green.yaml", seed=0, world="symbolic", profile=True)
    if crashed:

        def fail(self: SymbolicWorld, action: Action) -> NoReturn:
            (tmp_path / "gone" / f"{platform.node()}.urdf").read_bytes()
            raise AssertionError("there is such a file")

        monkeypatch.setattr(SymbolicWorld, "execute", fail)
    with pytest.raises(FileNotFoundError) if crashed else nullcontext():
        run(setup, path)
    assert end_of(path).status == ("error" if crashed else "goal_achieved")
    private = [str(tmp_path), str(Path.cwd()), str(Path.home()), sys.prefix]
    for said in texts_of(path):
        assert not [each for each in private if len(each) > 1 and each in said], said[:200]
        assert not re.search(rf"(?<![\w.]){re.escape(platform.node() or 'localhost')}(?![\w.])", said), said[:200]


def texts_of(path: Path) -> Iterator[str]:
    """Yield everything a trace says: messages, attachments and metadata."""
    trace = Trace(path)
    yield from (recorded.data.decode(errors="replace") for recorded in trace.messages())
    yield from (data.decode() for data in trace.attachments.values())
    yield from (f"{key}={value}" for table in trace.metadata.values() for key, value in table.items())


def test_a_killed_process_leaves_every_closed_step(tmp_path: Path) -> None:
    """SIGKILL cannot be caught: what is lost is at most the step in which it came."""
    out = tmp_path / "a.mcap"
    script = (
        "import runpy, sys, time; from pathlib import Path; from skolem.traces.file.writer import TraceWriter\n"
        f"sample = runpy.run_path({str(SAMPLE_RUN)!r})\n"
        f"with TraceWriter(Path({str(out)!r}), attachments={{'scenario.yaml': b'x'}}, run={{}}, env={{}}) as writer:\n"
        "    writer.write('/run/start', sample['run_start'](), 0)\n"
        "    for step in range(50): sample['record_step'](writer, step)\n"
        "    print('recorded', flush=True); time.sleep(60)\n"
    )
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "recorded\n"
        process.kill()
    assert not out.exists()
    recover(out.with_name("a.mcap.partial"), out)
    assert Trace(out).attachments == {"scenario.yaml": b"x"}
    assert [chain.step for chain in Trace(out).of(Chain)] == list(range(50))


def test_a_finished_chunk_is_on_the_disk_before_the_next_message(tmp_path: Path) -> None:
    """Bytes that do not compress fill a chunk every few messages; each full one can be read while the run goes on."""
    with open_writer(tmp_path / "a.mcap") as writer:
        for k in range(40):
            noise = "".join(f"{zlib.crc32(bytes([k, i % 256, i // 256])):08x}" for i in range(1000))
            writer.write("/truth/state", TRUE_STATE.model_copy(update={"sha256": noise}), k)
        assert recover(writer.partial, tmp_path / "saved.mcap").messages >= 30


def test_time_runs_forward_only(tmp_path: Path) -> None:
    with open_writer(tmp_path / "a.mcap") as writer:
        writer.write("/truth/state", TRUE_STATE, 100)
        with pytest.raises(InternalError, match="tick 99 comes after tick 100"):
            writer.write("/truth/state", TRUE_STATE, 99)


def test_a_time_that_no_trace_can_hold_ends_in_a_closed_trace_with_the_reason(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    writer = open_writer(path)
    writer.candidate(math.nan, None)
    with pytest.raises(InternalError, match="beyond the times that a trace can hold"), writer:
        writer.write("/truth/state", TRUE_STATE, 10**18)
    [end] = Trace(path).of(RunEnd)
    assert (end.status, end.goal_probability) == ("error", 0.0)
    assert "beyond the times" in end.reason
    assert not partial_of(path).exists()


def test_nothing_is_decided_after_the_end_but_the_verdict_may_follow(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    end = RunEnd(status="goal_unachievable", steps=0, reason="no plan", goal_probability=0.0)
    with open_writer(path) as writer:
        writer.write("/run/end", end, 0)
        writer.write("/truth/verdict", STILL, 0)
        with pytest.raises(InternalError, match="the run has ended"):
            writer.write("/run/end", end, 0)
    assert list(Trace(path).of(RunEnd)) == [end]
    assert list(Trace(path).of(Verdict)) == [STILL]


@pytest.mark.parametrize("error", [KeyError(10**5000), ValueError("x" * 10**6), OSError()])
def test_a_trace_is_closed_whatever_is_raised(error: Exception, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with pytest.raises(type(error)), open_writer(path):
        raise error
    [end] = Trace(path).of(RunEnd)
    assert (end.status, end.reason.startswith(type(error).__name__), len(end.reason) < 20_000) == ("error", True, True)


def test_a_trace_whose_end_cannot_be_told_is_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.mcap"
    monkeypatch.setattr(writer_module, "error_text", lambda error: f"{10**5000}")
    with pytest.raises(ValueError, match="integer string conversion"), open_writer(path):
        raise RuntimeError
    assert list(Trace(path).of(RunEnd)) == []


def test_a_link_in_the_place_of_the_partial_file_is_not_followed(tmp_path: Path) -> None:
    for target in ("other", "nowhere"):
        path = tmp_path / f"{target}.mcap"
        (tmp_path / "other").write_text("mine")
        partial_of(path).symlink_to(tmp_path / target)
        with pytest.raises(InputError, match="exists"), open_writer(path):
            pytest.fail("the block was entered")
        assert partial_of(path).is_symlink()
    assert (tmp_path / "other").read_text() == "mine"
    assert not (tmp_path / "nowhere").exists()


def test_a_path_that_cannot_be_written_is_the_users_mistake(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"), open_writer(tmp_path / "file" / "a.mcap"):
        pytest.fail("the block was entered")


@pytest.mark.parametrize("kind", ["pipe", "socket"])
def test_what_is_no_file_is_never_replaced(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with closing(socket.socket(socket.AF_UNIX)) as listening:
        if kind == "socket":
            listening.bind(str(path))
        else:
            os.mkfifo(path)
        before = sorted(tmp_path.iterdir())
        for begun in (open_writer(path), nullcontext()):
            with pytest.raises(InputError, match="is a device, a pipe or a socket; give the name of a file"), begun:
                Copy(path, CHUNK_BYTES)
    assert sorted(tmp_path.iterdir()) == before
    assert not path.is_file()


class FullDisk(io.FileIO):
    """A file that takes so many bytes and no more."""

    def __init__(self, path: Path, room: int) -> None:
        super().__init__(path, "xb")
        self._room = room

    def write(self, data: Any) -> int:
        part = bytes(data)[: self._room]
        self._room -= len(part)
        if data and not part:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return super().write(part)


def test_a_full_disk_is_one_line_and_what_reached_it_can_be_saved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, record_run: Callable[..., str]
) -> None:
    record_run(tmp_path / "whole.mcap", steps=8)
    whole = list(Trace(tmp_path / "whole.mcap").messages())
    size = (tmp_path / "whole.mcap").stat().st_size
    with (tmp_path / "whole.mcap").open("rb") as file:
        first = next(piece.byte + len(piece.data) for piece in pieces(file) if isinstance(piece.record, Chunk))
    for room in (first, first + 1000, first + 2000, size // 2, size - 100, size - 1):
        path = tmp_path / f"{room}.mcap"
        disk = FullDisk(partial_of(path), room)
        monkeypatch.setattr(writer_module, "begin", lambda _, disk=disk: io.BufferedWriter(disk))
        said = f"{partial_of(path)}: cannot be written to its end: No space left on device; `skolem recover "
        with pytest.raises(UnwrittenError, match=f"^{re.escape(said)}[^\n]* -o FILE` saves what reached it$"):
            record_run(path, steps=8)
        assert (disk.closed, path.exists(), partial_of(path).stat().st_size) == (True, False, room)
        found = recover(partial_of(path), path)
        assert list(Trace(path).messages()) == whole[: found.messages]
        assert found.steps >= 1


def test_a_disk_that_is_full_from_the_beginning_is_named_and_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.mcap"
    disk = io.BufferedWriter(FullDisk(partial_of(path), 10))
    monkeypatch.setattr(writer_module, "begin", lambda _: disk)
    with pytest.raises(InputError, match="cannot be written: No space left"):
        with TraceWriter(path, attachments={"a": bytes(100_000)}, run={}, env={}):
            pytest.fail("the block was entered")
    assert list(tmp_path.iterdir()) == []


def test_missing_folders_are_made(tmp_path: Path) -> None:
    with open_writer(tmp_path / "out" / "today" / "a.mcap"):
        pass
    assert end_of(tmp_path / "out" / "today" / "a.mcap").status == "error"


def test_a_step_of_ten_actions_counts_only_those_that_came_back(tmp_path: Path, record_run: Callable[..., str]) -> None:
    record_run(tmp_path / "a.mcap", steps=10, last_words=False)
    assert len(list(Trace(tmp_path / "a.mcap").of(Action))) == end_of(tmp_path / "a.mcap").steps == 10


def test_the_environment_names_versions_and_no_place() -> None:
    found = environment()
    assert {f"version {name}" for name in PACKAGES} <= set(found)
    assert re.fullmatch(r"\d+\.\d+\.\d+", found["python"])
    assert not any("/" in value for value in found.values())
    assert found == environment()
